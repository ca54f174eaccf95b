"""One control period in plain numpy, written from the specification (sections 2.2, 2.3), not from the kernel.

It compares all pairs, without neighbour lists or compiled code, and keeps only the state of the robots.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from kswarms.agents.body import SENSORS
from kswarms.agents.common.arrays import Floats, Integers
from kswarms.agents.robot.state import ACTION, HOME, HOME_TURN, HOMING_ERROR, LEG, LEG_OVER, TURN, RobotStates
from kswarms.model.description.arena import Arena
from kswarms.model.description.game import Game
from kswarms.model.kernel.arrays import CONFLICT, DEPOSIT, HOMING, LEG_DUE, PICK_UP, TURN_DUE, WALL
from tests.reference.contacts import Ground, offsets, translate

BEARINGS = 2 * math.pi / SENSORS * np.arange(SENSORS)
"""Directions of the sensors, relative to the heading (rad)."""

EQUALLY_NEAR = 1e-12
"""Maximum difference of equal distances (m): rounding makes one of two touching robots nearer."""


class Event(NamedTuple):
    """A decision that a robot must take; fields that its kind does not use are 0."""

    robot: int
    kind: int
    other: int = 0
    active: int = 0
    vacant: int = 0
    angle: float = 0.0
    rivals: tuple[tuple[int, float], ...] = ()  # all robots ahead that are equally near, with their bearing


@dataclass
class State:
    """State of the robots: arrays of length n, or (n, 2)."""

    positions: Floats
    moved: Floats  # displacement in the last period, without relaxation
    heading: Floats
    stride: Floats
    turn_rate: Floats
    phase: Integers
    carrying: Integers
    opponent: Integers
    swarm: Integers

    @classmethod
    def of(cls, states: RobotStates) -> Self:
        """Copy the state arrays."""
        names = ("heading", "stride", "turn_rate", "phase", "carrying", "opponent", "swarm")
        moved = np.column_stack((states.bodies.moved_x, states.bodies.moved_y))
        return cls(states.positions.copy(), moved, *(getattr(states.bodies, name).copy() for name in names))


class ReferenceKernel:
    """Plain counterpart of the compiled `Kernel`; each call gets the state of the robots."""

    def __init__(self, game: Game, arena: Arena) -> None:
        parameters, body = game.parameters, game.body
        self.parameters, self.arena, self.radius = parameters, arena, body.radius
        scale = body.radius / 0.085
        self.conflict_reach = 2 * body.radius + scale * parameters.conflict_distance
        self.wall_reach = body.radius + scale * parameters.wall_distance
        self.base_range = scale * parameters.base_range
        self.flight_range = scale * parameters.flight_range
        self.active_range = scale * parameters.active_range
        self.ground = Ground(body.radius, arena.half, parameters.friction, parameters.push_share)
        self.supply = [game.supply or -1] * len(arena.stations)
        self.stage = 0

    def advance(self, state: State, tick: int, until: int) -> tuple[int, list[Event]]:
        """Advance to the next decision, at most to the start of period `until`; writes `state`.

        If the pick-ups and deposits of a period are done, its percepts follow in any case.
        """
        while tick < until or self.stage == 1:
            if self.stage < 2:
                look = (self.find_pucks, self.perceive)[self.stage]
                self.stage += 1
                events = look(state)
                if events:
                    return tick, events
            else:
                self.move(state)
                self.stage = 0
                tick += 1
        return tick, []

    def find_pucks(self, state: State) -> list[Event]:
        """Return the robots that can pick up or deposit a puck."""
        events = []
        for robot, place in enumerate(state.positions):
            if state.carrying[robot]:
                base = self.arena.bases[state.swarm[robot]]
                if math.dist(place, base) < self.parameters.base_radius:
                    events.append(Event(robot, DEPOSIT))
                continue
            for station, middle in enumerate(self.arena.stations):
                near = math.dist(place, middle) < self.parameters.station_radius
                if near and self.supply[station] != 0:
                    events.append(Event(robot, PICK_UP, other=station))
                    break
        return events

    def perceive(self, state: State) -> list[Event]:
        """Return the decisions due, at most one event per robot."""
        dx, dy, distance = offsets(state.positions)
        bearing = wrap(np.arctan2(dy, dx) - state.heading[:, None])
        found = (self._perceive_one(state, i, distance[i], bearing[i]) for i in range(len(distance)))
        return [event for event in found if event is not None]

    def _perceive_one(self, state: State, robot: int, distance: Floats, bearing: Floats) -> Event | None:
        phase = state.phase[robot]
        ahead = (distance <= self.conflict_reach) & (np.abs(bearing) <= self.parameters.front_half_angle)
        if ahead.any():
            nearest = int(np.argmin(np.where(ahead, distance, np.inf)))
            changed = self.parameters.preempt and nearest != state.opponent[robot]
            if phase != ACTION or changed:
                free = self.sense(state, robot, distance, bearing)
                cut = np.minimum(free, self.flight_range)
                active = int((free <= self.active_range).sum())
                vacant = sum(1 << s for s in range(SENSORS) if cut[s] == cut.max())
                equal = np.flatnonzero(ahead & (distance <= distance[nearest] + EQUALLY_NEAR))
                rivals = tuple((int(other), float(bearing[other])) for other in equal)
                return Event(robot, CONFLICT, nearest, active, vacant, float(bearing[nearest]), rivals)
        if phase in (ACTION, TURN, HOME_TURN):
            return None
        place, heading = state.positions[robot], state.heading[robot]
        base = self.arena.bases[state.swarm[robot]]
        if state.carrying[robot] and math.dist(place, base) <= self.base_range:
            error = float(wrap(np.arctan2(base[1] - place[1], base[0] - place[0]) - heading))
            if phase != HOME or abs(error) > HOMING_ERROR:
                return Event(robot, HOMING, angle=error)
            return None
        if self.meets_wall(place, heading):
            return Event(robot, WALL)
        if phase == LEG_OVER:
            return Event(robot, TURN_DUE)
        return None if phase == LEG else Event(robot, LEG_DUE)

    def sense(self, state: State, robot: int, distance: Floats, bearing: Floats) -> Floats:
        """Return the free distance of each of a robot's sensors, without a limit of range."""
        free = np.empty(SENSORS)
        for s, direction in enumerate(BEARINGS):
            wall, _ = self._wall_along(state.positions[robot], state.heading[robot] + direction)
            in_sector = np.abs(wrap(bearing - direction)) <= math.pi / SENSORS
            nearest = np.min(distance[in_sector], initial=np.inf)
            free[s] = min(wall - self.radius, nearest - 2 * self.radius)
        return free

    def meets_wall(self, place: Floats, heading: float) -> bool:
        """Return whether a robot heads for a wall that one of its rays meets within the wall distance."""
        side = self.parameters.wall_half_angle
        for direction in (heading, heading - side, heading + side):
            distance, outwards = self._wall_along(place, direction)
            if distance < self.wall_reach and math.cos(heading - outwards) > 0:
                return True
        return False

    def _wall_along(self, place: Floats, direction: float) -> tuple[float, float]:
        """Return the length of a ray from `place` to a wall, and the outward direction of that wall."""
        hits = []
        for outwards in (0.0, math.pi / 2, math.pi, -math.pi / 2):
            towards = math.cos(direction - outwards)
            if towards > 0:
                gap = self.arena.half - place[0] * math.cos(outwards) - place[1] * math.sin(outwards)
                hits.append((gap / towards, outwards))
        return min(hits)

    def move(self, state: State) -> None:
        """Turn and move all robots."""
        turning = state.turn_rate != 0
        state.heading[turning] = wrap(state.heading + state.turn_rate)[turning]
        forward = np.column_stack((np.cos(state.heading), np.sin(state.heading)))
        translate(state.positions, state.moved, state.stride[:, None] * forward, self.ground)


def wrap(angle: Floats) -> Floats:
    """Return the same directions in (−π, π]."""
    return math.pi - np.mod(math.pi - angle, 2 * math.pi)
