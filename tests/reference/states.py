"""Generated states: games and robots in all phases, crowded, touching, at the walls."""

import math
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from kswarms.agents.body import BODIES
from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.common.limits import LONGEST_STEP
from kswarms.agents.robot.state import ACTION, IDLE, Bodies, RobotStates
from kswarms.model.description.arena import Arena
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.presets import PRESETS
from kswarms.model.kernel.arrays import CONFLICT, HOMING, PICK_UP
from kswarms.model.kernel.kernel import Kernel

_TRIES = 200


@dataclass(frozen=True)
class Scene:
    """A game, its arena and a state of its robots."""

    game: Game
    arena: Arena
    states: RobotStates

    def kernel(self) -> Kernel:
        """Return a compiled kernel that moves these robots."""
        return Kernel(self.game, self.arena, self.states)


def unit(angle: float) -> Floats:
    """Return the unit vector of a direction."""
    return np.array((math.cos(angle), math.sin(angle)))


def make_scene(game: Game, positions: ArrayLike, headings: ArrayLike, stride: ArrayLike) -> Scene:
    """Return a scene of robots without decisions, those of S1 first."""
    sizes = [swarm.size for swarm in game.swarms]
    swarm_of = np.repeat(np.arange(len(sizes)), sizes)
    directions = np.full(len(swarm_of), headings, dtype=np.float64)
    states = RobotStates(np.array(positions, dtype=np.float64), swarm_of, directions)
    states.bodies.stride[:] = stride
    states.bodies.phase[:] = ACTION  # has no events
    return Scene(game, game.arena(0), states)


@st.composite
def games(draw: st.DrawFn, largest: int = 60) -> Game:
    """Draw a game: number of swarms, body and the parameters that the kernel reads."""
    k = draw(st.integers(1, 5))
    n = draw(st.integers(k, largest))
    drive_action = draw(st.sampled_from((0.6, 0.4)))
    preset = PRESETS[draw(st.sampled_from(tuple(PRESETS)))]
    return Game(
        swarms=tuple(
            Swarm(policy="avoid", size=size, drive_action=drive_action) for size in apportion(n, [1] * k)
        ),
        body=draw(st.sampled_from(("krembot-sim", "krembot"))),
        side=draw(st.sampled_from((2.0, 2.6))),
        layout=draw(st.sampled_from(("symmetric", "nearer-station") if k <= 2 else ("symmetric",))),
        supply=draw(st.sampled_from((None, 1))),
        parameters=preset.replace(
            station_radius=0.16,
            friction=draw(st.sampled_from((0.0, 0.18, 0.45, 1.5))),
            push_share=draw(st.sampled_from((0.0, 0.3, 1.0))),
            preempt=draw(st.booleans()),
            front_half_angle=draw(st.sampled_from((math.radians(62.5), math.radians(100), math.pi))),
            wall_distance=draw(st.sampled_from((0.06, 0.1))),
        ),
    )


@st.composite
def scenes(draw: st.DrawFn, largest: int = 60) -> Scene:
    """Draw a game and a state of its robots.

    Continuous values come from a numpy generator with a drawn seed. Thus no two distances are equal, and
    rounding has no effect on the result.
    """
    game = draw(games(largest))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n, radius = game.size, game.body.radius
    fastest = game.parameters.period * game.body.top_speed * 0.6
    crowding = draw(st.sampled_from((0.0, 0.5, 0.95)))
    positions = crowd(rng, n, radius, game.side / 2, crowding, gap=2 * fastest)
    scene = make_scene(game, positions, rng.uniform(-math.pi, math.pi, n), 0.0)
    bodies = scene.states.bodies
    bodies.phase[:] = rng.integers(IDLE, ACTION + 1, n)
    bodies.carrying[:] = rng.integers(0, 2, n)
    bodies.opponent[:] = rng.integers(-1, n, n)
    bodies.stride[:] = rng.choice((0.0, 0.5, 1.0), n, p=(0.2, 0.1, 0.7)) * fastest
    bodies.turn_rate[:] = rng.choice((0.0, -0.296, 0.5), n, p=(0.6, 0.2, 0.2))
    bodies.moved_x[:], bodies.moved_y[:] = rng.uniform(-0.7, 0.7, (2, n)) * fastest
    return scene


@st.composite
def crowded_games(draw: st.DrawFn) -> Game:
    """Draw a game whose robots cover 62 to 70 % of the arena, drive fast and shove.

    The walls take a margin of half a radius; 70 % of the rest is the largest cover that a game allows.
    """
    body = BODIES[draw(st.sampled_from(("krembot", "krembot-sim")))]
    n, cover = draw(st.integers(20, 150)), draw(st.floats(0.62, 0.699))
    side = math.sqrt(n * math.pi * body.radius**2 / cover) + body.radius / 2
    period = draw(st.sampled_from((0.05, 0.1)))
    fastest = min(1.0, LONGEST_STEP * body.radius / (period * body.top_speed))
    drive = fastest * draw(st.sampled_from((1.0, 0.7)))
    sizes = apportion(n, [1] * draw(st.integers(1, 3)))
    policy = st.sampled_from(("mixed", "aggressive", "attack", "avoid"))
    return Game(
        swarms=tuple(
            Swarm(policy=draw(policy), size=size, drive=drive, drive_action=fastest) for size in sizes
        ),
        body=body,
        side=side,
        duration=8.0,
        parameters=PRESETS[draw(st.sampled_from(tuple(PRESETS)))].replace(
            period=period,
            conflict_distance=draw(st.sampled_from((0.5, 0.1))),
            fight_duration=draw(st.sampled_from((10.0, 1.0))),
            leg_mean=draw(st.sampled_from((100.0, 6.7))),
            station_radius=0.07 * side,
            base_radius=0.07 * side,
            friction=draw(st.sampled_from((0.0, 0.18, 1.0, 1.5))),
            push_share=draw(st.sampled_from((1.0, 0.7))),
            clearance=0.0,
            wall_clearance=0.0,
        ),
    )


def crowd(
    rng: np.random.Generator, n: int, radius: float, half: float, crowding: float, gap: float
) -> Floats:
    """Place bodies one by one, each with probability `crowding` within `gap` (m) of an earlier one."""
    limit = half - radius
    positions = np.empty((n, 2))
    for robot in range(n):
        for _ in range(_TRIES):
            place = rng.uniform(-limit, limit, 2)
            if robot > 0 and rng.random() < crowding:
                angle = rng.uniform(-math.pi, math.pi)
                reach = 2 * radius + rng.uniform(0, gap)
                beside = positions[rng.integers(robot)]
                place = np.clip(beside + reach * unit(angle), -limit, limit)
            if (np.hypot(*(positions[:robot] - place).T) >= 2 * radius).all():
                break
        else:
            return crowd(rng, n, radius, half, crowding / 2, gap)
        positions[robot] = place
    return positions


def clone(scene: Scene, order: Integers | None = None) -> Scene:
    """Copy a scene with its robots in another order: robot k of the copy is robot ``order[k]``."""
    order = np.arange(len(scene.states.positions)) if order is None else order
    bodies = Bodies._make(array[order] for array in scene.states.bodies)
    new_number = np.append(np.argsort(order), -1)  # −1, no opponent, stays −1
    states = RobotStates(scene.states.positions[order], bodies.swarm, bodies.heading)
    for new, old in zip(states.bodies, bodies, strict=True):
        new[:] = old
    states.bodies.opponent[:] = new_number[bodies.opponent]
    return replace(scene, states=states)


def mirrored(scene: Scene) -> Scene:
    """Mirror a scene at the y-axis."""
    image = clone(scene)
    bodies = image.states.bodies
    image.states.positions[:, 0] *= -1
    bodies.heading[:] = np.where(bodies.heading > 0, math.pi, -math.pi) - bodies.heading
    bodies.forward_x[:] *= -1
    bodies.moved_x[:] *= -1
    bodies.turn_rate[:] *= -1
    flip = np.array((-1.0, 1.0))
    arena = replace(scene.arena, stations=scene.arena.stations * flip, bases=scene.arena.bases * flip)
    return replace(image, arena=arena)


def game_of(n: int, friction: float = 0.18, push_share: float = 0.0) -> Game:
    parameters = PRESETS["fitted"].replace(friction=friction, push_share=push_share)
    return Game(swarms=(Swarm(policy="avoid", size=n),), parameters=parameters)


def play_period(scene: Scene) -> dict[tuple[int, int], tuple[int, int, int, float]]:
    """Play one period without decisions; return its events by (robot, kind)."""
    kernel, events = scene.kernel(), {}
    while size := kernel.advance(0, 1)[1]:
        for robot, kind, other, active, vacant, angle in kernel.events[:size].tolist():
            events[robot, kind] = (
                other if kind in (CONFLICT, PICK_UP) else 0,
                active if kind == CONFLICT else 0,
                vacant if kind == CONFLICT else 0,
                angle if kind in (CONFLICT, HOMING) else 0.0,
            )
    return events


def crowded(scene: Scene) -> Scene:
    """Play two periods, after which many bodies touch; afterwards, robots have no events.

    (Rounding would decide which of two touching robots is the nearest.)
    """
    for _ in range(2):
        play_period(scene)
    scene.states.bodies.phase[:] = ACTION
    return replace(scene, game=scene.game.replace(parameters=scene.game.parameters.replace(preempt=False)))
