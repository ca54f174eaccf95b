"""Forms: values of controls from scenarios and games, and back."""

from typing import Any

import pytest

from kswarms.agents.actions import AWAY, TOWARDS, Action
from kswarms.agents.body import Body
from kswarms.agents.common.errors import InputError
from kswarms.model.description.presets import PRESETS
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.explore.form import Form, learning_of, with_parameter

GO, ON = Action(name="go", direction=AWAY, duration=2.0), Action(name="on", direction=TOWARDS, duration=1.0)


@pytest.mark.parametrize("scenario", CATALOGUE.values(), ids=CATALOGUE)
def test_the_forms_of_a_condition_and_of_its_game_give_the_game(scenario: Scenario) -> None:
    for condition in scenario.conditions:
        n = scenario.densities[0]
        game = condition.game(n)
        assert Form.of_condition(condition, n, 3).game() == game
        assert Form.of_game(game, 3).game() == game


@pytest.mark.parametrize(
    "changes",
    [
        {"side": 3.0},
        {"stations": ((0.0, 0.5),), "bases": ((-0.7, 0.0), (0.7, 0.0))},
        {"body": Body(radius=0.06, sensor_range=0.5, top_speed=0.25)},
        {"actions": (GO, ON)},
        {"absent": (3,), "absent_from": "game"},
    ],
)
def test_a_form_has_every_field_of_a_game(changes: dict[str, Any]) -> None:
    game = CATALOGUE["fig-6.1c"].game("", 6).replace(**changes)
    assert Form.of_game(game, 0).game() == game


def test_a_form_can_hold_invalid_values_until_its_game_is_built() -> None:
    form = Form.of_condition(CATALOGUE["fig-6.1c"].conditions[0], 20, 0)
    for field, value in (("seed", -1), ("seed", 1.5), ("n", 7), ("layout", "round"), ("duration", -1.0)):
        with pytest.raises(InputError, match=field):
            form.replace(**{field: value}).game()
    for field, other in (("policy", "atack"), ("share", 0), ("drive", 0.0)):
        with pytest.raises(InputError, match=field):
            form.replace_swarm(1, **{field: other}).game()
    assert form.replace_swarm(1, policy="mixed").game().swarms[1].policy == "mixed"


def test_a_text_names_only_parameters_that_differ_from_the_preset() -> None:
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
    assert learning_of(policies, "fitted") == seen
