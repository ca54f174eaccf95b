"""The robots of a game: bodies and policies."""

from random import Random

import numpy as np

from kswarms.agents.conformance.trial import try_policy
from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.spec import deal, parse_policies
from kswarms.agents.robot.controller import Controller
from kswarms.agents.robot.host import Host
from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.robot.state import RobotStates
from kswarms.agents.streams import Seeds, Streams
from kswarms.model.description.arena import Arena
from kswarms.model.description.game import Game
from kswarms.model.mesa_base import RobotSpace
from kswarms.model.placement import start_poses


def controller_constants(game: Game) -> Controller:
    """Return the constants of the robots' controller."""
    parameters, body = game.parameters, game.body
    return Controller(
        period=parameters.period,
        turn_step=parameters.turning_rate * parameters.period,
        leg_mean=parameters.leg_mean,
        wander_turn=parameters.wander_turn,
        half=game.side / 2,
        wall_reach=body.radius + body.sensing_scale * parameters.wall_distance,
        wall_half_angle=parameters.wall_half_angle,
        radius=body.radius,
        active_range=body.sensing_scale * parameters.active_range,
        escape_away=parameters.wall_escape == "away",
    )


def place_robots(game: Game, arena: Arena, seed: int, random: Random) -> tuple[RobotSpace, RobotStates]:
    """Place the bodies of all robots, at rest; return Mesa's space and the state arrays.

    Both use the same array of positions. The space has no agents yet. `random` is for Mesa and stays unused.
    """
    half, body, parameters = arena.half, game.body, game.parameters
    positions, headings = start_poses(
        game.size, seed, half, body.radius, parameters.clearance, parameters.wall_clearance
    )
    space = RobotSpace(half, game.size, random)
    swarm_of = np.repeat(np.arange(len(game.swarms)), [swarm.size for swarm in game.swarms])
    states = RobotStates(space.positions, swarm_of, headings)
    states.positions[:] = positions
    return space, states


def make_robots(model: Host, game: Game, seed: int) -> list[Krembot]:
    """Make the robots of all swarms, each with its policy and random streams."""
    step = game.parameters.period * game.body.top_speed
    actions, swarms, gamma = model.actions, len(game.swarms), game.parameters.gamma
    robots: list[Krembot] = []
    seeds = Seeds(seed, game.size)
    for k, swarm in enumerate(game.swarms):
        specs = parse_policies(swarm.policy)
        for spec in specs:
            if spec.runs_user_code:
                try_policy(spec, Setting(k, swarms, actions, Streams(0, 0)))
        # Equal robots share their numbers and names: the objects of many robots exceed the processor's cache.
        strides = step * swarm.drive, step * swarm.drive_action
        kinds = {spec: (str(spec), spec.factory(actions)) for spec in specs}
        for place, spec in enumerate(deal(swarm.policy, swarm.size)):
            number = len(robots)
            streams = Streams(seed, number, seeds)
            name, factory = kinds[spec]
            robot = Krembot(
                model,
                number,
                k,
                factory(Setting(k, swarms, actions, streams, place, gamma)),
                name,
                streams,
                *strides,
                swarms=swarms,
                actions=actions if spec.is_user_defined else None,
            )
            robots.append(robot)
    return robots
