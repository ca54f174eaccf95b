"""Candidates of a calibration, and the games that measure their error against Table 6.1."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from kswarms.agents.common.arrays import Floats
from kswarms.agents.learning.selection_rules import UCB
from kswarms.model.description.game import Game, Swarm
from kswarms.model.description.parameters import PRESETS, parse_parameters
from kswarms.scenarios.description.scenario import LEARNING

Candidate = dict[str, float]
"""A value for each free parameter, by name."""
Cell = tuple[str, int]
"""A cell of Table 6.1: the opponent's policy and N."""

START: Final[Candidate] = {
    name: getattr(PRESETS["fitted"], name)
    for name in (
        *("conflict_distance", "front_half_angle", "flight_duration", "fight_duration", "turning_rate"),
        *("flight_range", "active_range", "leg_mean", "wander_turn", "wall_distance"),
        *("station_radius", "base_radius", "base_range", "friction", "push_share"),
    )
} | {"gamma": UCB().gamma}
"""The parameters that can be fitted (section 2.7) and their start values, which are the defaults."""

SPAN: Final = 2.0
"""The search range is from start / `SPAN` to start × `SPAN`, on a logarithmic scale."""
LIMITS: Final = {"base_radius": 0.2, "push_share": 0.5}
"""Upper limits. A base must not touch the wall (m). A start value of 0 requires a linear scale."""


def texts_of(candidate: Candidate) -> tuple[str, str]:
    """Return the text of the parameters and the text of the selection rule."""
    changes = [f"{name}={value}" for name, value in candidate.items() if name != "gamma"]
    return ", ".join(["fitted", *changes]), f"ucb(gamma={candidate.get('gamma', START['gamma'])})"


def learning_game(cell: Cell, candidate: Candidate) -> Game:
    """Return the game in which the robots of a cell learn; its measured game is one period long."""
    opponent, n = cell
    parameters, rule = texts_of(candidate)
    world = parse_parameters(parameters)
    learner = Swarm(policy=f'inter-learner(rule="{rule}")', size=n - n // 2)
    return Game(
        swarms=(Swarm(policy=opponent, size=n // 2), learner),
        parameters=world,
        learning=LEARNING,
        duration=world.period,
    )


def to_candidate(free: Sequence[str], position: Floats) -> Candidate:
    """Return the candidate at a position in the unit cube, with values of four significant digits."""
    candidate = {}
    for name, part in zip(free, position, strict=True):
        low, high = _range_of(name)
        value = low * (high / low) ** part if low > 0 else high * part
        candidate[name] = float(f"{value:.4g}")
    return candidate


def to_position(candidate: Candidate) -> Floats:
    """Return the position of a candidate in the unit cube."""
    position = []
    for name, value in candidate.items():
        low, high = _range_of(name)
        position.append(math.log(value / low, high / low) if low > 0 else value / high)
    return np.array(position)


def _range_of(name: str) -> tuple[float, float]:
    start = START[name]
    limit = LIMITS.get(name, math.inf)
    return start / SPAN, (min(start * SPAN, limit) if start > 0 else limit)
