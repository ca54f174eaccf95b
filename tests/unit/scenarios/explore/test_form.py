"""The controls of the page as data: from scenarios and games to forms and back."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.editing import with_learning
from kswarms.agents.user_code.syntax import parse_call
from kswarms.model.description.parameters import PRESETS
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.explore.form import (
    Form,
    SwarmForm,
    learning_of,
    with_parameter,
)

PAIR = (SwarmForm("avoid"), SwarmForm("attack"))


@pytest.mark.parametrize("scenario", CATALOGUE.values(), ids=CATALOGUE)
def test_the_form_of_a_curve_and_that_of_its_game_both_give_the_game(scenario: Scenario) -> None:
    for condition in scenario.conditions:
        n = scenario.densities[0]
        game = condition.game(n)
        assert Form.of_condition(condition, n, 3).game() == game
        assert Form.of_game(game, 3).game() == game


def test_a_form_may_say_what_is_not_allowed_until_a_game_is_made_of_it() -> None:
    form = Form(PAIR)
    for field, value in (("seed", -1), ("seed", 1.5), ("n", 7), ("layout", "round"), ("duration", -1.0)):
        with pytest.raises(InputError, match=field):
            form._replace(**{field: value}).game()
    for field, other in (("policy", "atack"), ("share", 0), ("drive", 0.0)):
        with pytest.raises(InputError, match=field):
            form.with_swarm(1, **{field: other}).game()
    assert form.with_swarm(1, policy="mixed").game().swarms[1].policy == "mixed"


def test_a_parameter_is_named_only_where_the_preset_has_another_value() -> None:
    changed = with_parameter("fitted, preempt=true", "friction", 0.3)
    assert changed == "fitted, friction=0.3, preempt=True"
    assert with_parameter(changed, "friction", PRESETS["fitted"].friction) == "fitted, preempt=True"
    with pytest.raises(InputError, match="friction"):
        with_parameter("fitted", "friction", -1.0)


@pytest.mark.parametrize(
    ("policies", "seen"),
    [
        (["avoid", "inter-learner"], ("wlu", "ucb", 0.125, 0.1211)),
        (["learner(reward='wlu(delta=0.2, b=1.1)', rule='greedy')"], ("wlu", "greedy", 0.2, None)),
        (["avoid+intra-learner(reward='single-swarm')"], ("single-swarm", "ucb", None, 0.1211)),
        (["learner(reward='wlu(delta={1: 0.1, 3: 0.2})')"], ("wlu", "ucb", None, 0.1211)),
        (["learner(reward='mine.py:Own')"], ("mine.py:Own", "ucb", None, 0.1211)),
        (["learner(rule=", "learner"], ("wlu", "ucb", 0.125, 0.1211)),
        (["avoid", "mixed"], None),
    ],
)
def test_the_controls_of_learning_show_the_first_learner(
    policies: list[str], seen: tuple[object, ...] | None
) -> None:
    assert learning_of(policies) == seen


def test_learning_is_changed_in_the_text_of_the_policy() -> None:
    text = with_learning("inter-learner(otherwise='fight')", "reward", delta=0.2)
    assert parse_call("policy", text).arguments == {"otherwise": "fight", "reward": "wlu(delta=0.2)"}
    text = with_learning(text, "reward", delta=0.02)
    assert parse_call("policy", text).arguments["reward"] == "wlu(delta=0.02)"
    text = with_learning(text, "rule", "greedy")
    assert parse_call("policy", text).arguments["rule"] == "greedy"
    assert with_learning(text, "reward", "individual").count("individual") == 1


def test_only_learners_are_changed() -> None:
    assert with_learning("mixed", "reward", delta=0.2) == "mixed"
    changed = with_learning("avoid+learner", "rule", gamma=0.5)
    assert changed == "avoid+learner(rule='ucb(gamma=0.5)')"
