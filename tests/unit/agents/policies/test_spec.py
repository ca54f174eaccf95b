"""Policies as texts, classes, factories and lists."""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from kswarms.agents.actions import Action
from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance.policies import TWO_ACTIONS, make_setting
from kswarms.agents.learning.rewards import WLU
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.spec import deal, make_policy, parse_policies
from kswarms.agents.user_code.loading import load_class


class Patient:
    """A policy at the top level of a module."""

    def __init__(self, setting: Setting, patience: int = 1) -> None:
        self.actions, self.patience = setting.actions, patience

    def choose(self, opponent: int) -> Action:
        return self.actions[0]


def test_a_text_is_parsed_once_and_printed_as_written() -> None:
    text = "avoid + inter-learner( rule='greedy' )"
    specs = parse_policies(text)
    assert parse_policies(text) is specs
    assert [str(spec) for spec in specs] == ["avoid", "inter-learner( rule='greedy' )"]
    assert (specs[1].name, specs[1].arguments) == ("inter-learner", {"rule": "greedy"})


def test_robots_of_a_policy_share_reward_and_rule_but_no_bandit() -> None:
    factory = parse_policies("learner(reward='wlu(delta=0.2)')")[0].factory(TWO_ACTIONS)
    one, other = (factory(make_setting(robot=robot)) for robot in (0, 1))
    assert isinstance(one, Learner)
    assert isinstance(other, Learner)
    assert one.reward is other.reward
    assert one.rule is other.rule
    assert one.bandits[0] is not other.bandits[0]


def test_a_class_and_a_partial_have_the_text_that_loads_them() -> None:
    name = f"{__name__}:Patient"
    for given, text in ((Patient, name), (partial(Patient, patience=2), f"{name}(patience=2)")):
        (spec,) = parse_policies(given)
        assert spec.text == str(spec) == text
        assert vars(spec.build(make_setting())) == vars(given(make_setting()))
        assert spec.is_user_defined


def test_a_class_of_a_script_is_named_by_its_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("class Mine:\n    def __init__(self, setting): pass\n    choose = None\n")
    kind = load_class("policy", "mine.py:Mine")
    assert parse_policies(kind)[0].text == "mine.py:Mine"
    assert [path.name for path in parse_policies(kind)[0].files()] == ["mine.py"]
    monkeypatch.delattr(sys.modules[kind.__module__], "__file__")  # as in a notebook
    assert parse_policies(kind)[0].call is None


@pytest.mark.parametrize(
    "given", [lambda where: Patient(where), partial(Learner, reward=WLU(delta=0.2)), partial(Patient, 1)]
)
def test_a_factory_without_a_text_plays_but_has_none(given: Callable[[Setting], Patient]) -> None:
    (spec,) = parse_policies(given)
    for ask in (lambda: spec.text, spec.files, lambda: spec.with_arguments(patience=3)):
        with pytest.raises(InputError, match="cannot be imported by other processes: define the class"):
            ask()
    assert spec.name == str(spec)


def test_local_classes_can_be_built() -> None:
    class Local(Patient):
        pass

    (spec,) = parse_policies(Local)
    assert isinstance(spec.build(make_setting()), Local)
    assert str(spec).endswith("Local")


def test_a_list_is_dealt_out_like_a_text_with_plus() -> None:
    dealt = deal(["mixed", Patient], 4)
    assert [spec.name.split(":")[-1] for spec in dealt] == ["avoid", "avoid", "aggressive", "Patient"]


@pytest.mark.parametrize("given", [1, [], None, ["avoid", 2]])
def test_other_objects_are_refused(given: object) -> None:
    with pytest.raises(InputError, match="must be a text, a class, a callable, or a list of these"):
        parse_policies(given)  # type: ignore[arg-type]


def test_literal_arguments_are_not_shared_between_robots(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code = "class Mine:\n    def __init__(self, setting, met): self.met = met\n    choose = __init__\n"
    Path("mine.py").write_text(code)
    one, other = (make_policy("mine.py:Mine(met=[])", make_setting()) for _ in range(2))
    assert vars(one) == vars(other) == {"met": []}
    assert vars(one)["met"] is not vars(other)["met"]


def test_only_learners_have_a_reward() -> None:
    (learner,) = parse_policies("inter-learner(otherwise='fight')")
    assert str(learner.learner_part("reward")) == "wlu"
    assert parse_policies("avoid")[0].learner_part("reward") is None
