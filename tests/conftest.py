"""Shared by all tests: a hypothesis profile, games with given poses."""

import math
import signal
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from hypothesis import settings

from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.presets import PRESETS
from kswarms.model.game_model import GameModel

# The first example of a test may compile the kernel, which takes longer than any useful deadline.
settings.register_profile("kswarms", deadline=None)
settings.load_profile("kswarms")

# Tests send these signals. A background job of a shell and `nohup` ignore them, and so do their children.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# Assertions in helper modules show their values, as in tests.
pytest.register_assert_rewrite("tests.helpers", "tests.reference", "tests.baseline")

FIRST = (
    *("tests/outcomes/test_learning.py", "tests/outcomes/test_argos.py", "tests/baseline/test_baseline.py"),
    *("tests/integration/test_explore_browser.py", "tests/integration/test_cluster.py"),
    *("tests/integration/test_report.py", "tests/outcomes/test_fairness.py"),
    *("tests/integration/test_runner.py", "tests/integration/test_documentation.py"),
)
"""Files that take longest. They run first: if a process started one of them last, the others would wait."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the tests of the longest files first."""
    place = {name: k for k, name in enumerate(FIRST)}
    items.sort(key=lambda item: place.get(item.nodeid.partition("::")[0], len(place)))


Pose = tuple[float, float, float]
Scene = Callable[..., GameModel]


@pytest.fixture
def scene() -> Scene:
    """Return a builder of games with given poses of all robots."""

    def build(
        *swarms: Sequence[Pose],
        policies: str = "",
        preset: str = "fitted",
        changes: dict[str, Any] | None = None,
        drives: tuple[float, float] = (0.6, 0.6),
        seed: int = 0,
        record: str = "",
        **rest: Any,
    ) -> GameModel:
        """Build a game from the poses (m, m, rad) of each swarm; `changes` are changes of the preset.

        Policies are separated by commas, avoid by default. All robots have the same drives in states P and A.
        """
        names = policies.split(",") if policies else ["avoid"] * len(swarms)
        game = Game(
            swarms=tuple(
                Swarm(policy=name, size=len(poses), drive=drives[0], drive_action=drives[1])
                for name, poses in zip(names, swarms, strict=True)
            ),
            parameters=PRESETS[preset].replace(**(changes or {})),
            **{"duration": 60.0, **rest},
        )
        model = GameModel(game, seed=seed, record=record)
        for robot, (x, y, heading) in zip(model.robots, [p for poses in swarms for p in poses], strict=True):
            model.states.positions[robot.index] = x, y
            row, bodies = robot.index, model.states.bodies
            bodies.heading[row] = heading
            bodies.forward_x[row], bodies.forward_y[row] = math.cos(heading), math.sin(heading)
        return model

    return build
