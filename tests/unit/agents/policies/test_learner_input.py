"""Errors of invalid learners: one line with field, value and rule."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.conformance.policies import make_setting
from kswarms.agents.policies.spec import make_policy
from kswarms.model.foraging import ForagingModel

SETTING = make_setting()

# Policy, field, repr of the value, part of the rule.
INVALID = [
    ("lerner", "policy", "'lerner'", "inter-learner"),
    ("", "policy", "''", "at least 1 character"),
    ("learner(", "policy", "'learner('", "name(key=value, …)"),
    ("learner('wlu')", "policy", "\"learner('wlu')\"", "name(key=value, …)"),
    ("learner(about=inter)", "policy", "'learner(about=inter)'", "name(key=value, …)"),
    ("learner(about='others')", "policy.about", "'others'", "inter, intra or both"),
    ("learner(otherwise='hide')", "policy.otherwise", "'hide'", "flight, fight"),
    ("learner(otherwise=['flight'])", "policy.otherwise", "['flight']", "flight, fight"),
    ("learner(otherwise=0)", "policy.otherwise", "0", "flight, fight"),
    ("learner(reward='wul')", "policy.reward", "'wul'", "wlu, individual, single-swarm"),
    ("learner(reward=0.125)", "policy.reward", "0.125", ""),
    ("learner(rule='ucb2')", "policy.rule", "'ucb2'", "ucb, discounted-ucb, greedy"),
    ("learner(rule=None)", "policy.rule", "None", ""),
    ("learner(rule='ucb(gamma=-0.1)')", "policy.rule.gamma", "-0.1", "greater than or equal to 0"),
    ("learner(rule='ucb(gamma=nan)')", "policy.rule", "'ucb(gamma=nan)'", "plain values"),
    ("learner(reward='wlu(delta=-0.1)')", "policy.reward.delta", "-0.1", "greater than or equal to 0"),
    ("learner(reward='wlu(gamma=3)')", "policy.reward.gamma", "3", "delta, b"),
    ("avoid+learner(rule='no')", "policy.rule", "'no'", "ucb"),
]


@pytest.mark.parametrize(("text", "field", "value", "allowed"), INVALID, ids=[row[0] for row in INVALID])
def test_errors_name_field_value_and_rule(
    text: str, field: str, value: str, allowed: str
) -> None:
    with pytest.raises(InputError) as caught:
        ForagingModel(n=4, policies=f"avoid,{text}", duration=1.0)
    error = caught.value
    assert error.field.removeprefix("swarms.1.") == field
    assert repr(error.value) == value
    assert allowed in error.allowed
    assert len(str(error).splitlines()) == 1


@pytest.mark.parametrize("text", ["learner(gamma=0.1)", "avoid(delta=1)", "random(p=0.3)"])
def test_errors_of_unknown_arguments_name_no_internals(text: str) -> None:
    with pytest.raises(InputError) as caught:
        make_policy(text, SETTING)
    for word in ("__init__", "positional", "_fixed()", "FrozenModel"):
        assert word not in str(caught.value)


@pytest.mark.parametrize("name", ["delta", "b"])
@pytest.mark.parametrize("opponent", [3, 0, -1])
def test_an_opponent_outside_the_game_is_refused(name: str, opponent: int) -> None:
    with pytest.raises(InputError) as caught:
        make_policy(f"learner(reward='wlu({name}={{{opponent}: 0.5}})')", SETTING)
    assert caught.value.field.startswith("policy.reward")
    assert str(opponent) in str(caught.value)


@pytest.mark.parametrize(("about", "unknown", "known"), [("inter-learner", 2, 1), ("intra-learner", 1, 2)])
@pytest.mark.parametrize("name", ["delta", "b"])
def test_an_opponent_that_is_not_learned_about_is_refused(
    name: str, about: str, unknown: int, known: int
) -> None:
    make_policy(f"{about}(reward='wlu({name}={{{known}: 0.5}})')", SETTING)
    with pytest.raises(InputError, match=f"names swarm {unknown}, which is not learned about"):
        make_policy(f"{about}(reward='wlu({name}={{{unknown}: 0.5}})')", SETTING)


@pytest.mark.parametrize("text", ["avoid(within=1)", "attack(against='x')", "inter-learner(about='intra')"])
def test_fixed_properties_of_named_policies_are_no_arguments(text: str) -> None:
    with pytest.raises(InputError):
        make_policy(text, SETTING)


def test_an_action_takes_no_arguments() -> None:
    with pytest.raises(InputError) as caught:
        make_policy("flight(duration=1)", SETTING)
    assert "flight" not in caught.value.allowed.split("one of")[-1]


@pytest.mark.parametrize("learning", [-1.0, float("nan"), float("inf"), "long"])
def test_invalid_durations_of_learning_are_refused(learning: float) -> None:
    with pytest.raises(InputError) as caught:
        ForagingModel(n=4, policies="avoid,learner", learning=learning)
    assert caught.value.field == "learning"
    assert repr(caught.value.value) == repr(learning)
