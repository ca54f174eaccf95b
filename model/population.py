"""The robots of a game: bodies, policies, and removal of absent robots."""

from collections.abc import Sequence
from random import Random

import numpy as np
from mesa.experimental.continuous_space import ContinuousSpace

from kswarms.agents.policies.interface import Setting
from kswarms.agents.policies.spec import deal, parse_policies
from kswarms.agents.robot.controller import Controller
from kswarms.agents.robot.host import Host
from kswarms.agents.robot.krembot import Krembot
from kswarms.agents.robot.state import RobotStates
from kswarms.agents.streams import Streams
from kswarms.model.description.arena import Arena
from kswarms.model.description.game import Game
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


def place(game: Game, arena: Arena, seed: int, random: Random) -> tuple[ContinuousSpace, RobotStates]:
    """Put the bodies of all robots into the arena, at rest.

    Parameters
    ----------
    game : Game
        What is played.
    arena : Arena
        Where.
    seed : int
        Of the run.
    random : random.Random
        What Mesa's space asks for; nothing here draws from it.

    Returns
    -------
    space : mesa.experimental.continuous_space.ContinuousSpace
        Of the positions, without agents yet.
    states : RobotStates
        The rows of the robots, on the same array of positions.

    Raises
    ------
    InputError
        If the robots find no place.
    """
    half, body, parameters = arena.half, game.body, game.parameters
    positions, headings = start_poses(
        game.size, seed, half, body.radius, parameters.clearance, parameters.wall_clearance
    )
    space = ContinuousSpace([[-half, half], [-half, half]], torus=False, random=random, n_agents=game.size)
    swarm_of = np.repeat(np.arange(len(game.swarms)), [swarm.size for swarm in game.swarms])
    # The space's own array, so that Mesa's view of the positions is the kernel's.
    states = RobotStates(space._agent_positions, swarm_of, headings)
    states.positions[:] = positions
    return space, states


def make_robots(model: Host, game: Game, seed: int) -> list[Krembot]:
    """Make the robots of all swarms, each with its policy and streams.

    Parameters
    ----------
    model : Host
        Which they live in; its states has their rows.
    game : Game
        What is played.
    seed : int
        Of the run.

    Raises
    ------
    InputError
        If a policy cannot be made.
    """
    period, top_speed = game.parameters.period, game.body.top_speed
    actions = game.action_set
    robots: list[Krembot] = []
    for k, swarm in enumerate(game.swarms):
        factories = {spec: spec.factory(actions) for spec in parse_policies(swarm.policy)}
        for rank, spec in enumerate(deal(swarm.policy, swarm.size)):
            index = len(robots)
            streams = Streams(seed, index)
            policy = factories[spec](Setting(k, len(game.swarms), actions, streams, rank))
            robot = Krembot(
                *(model, index, k, policy, str(spec), streams),
                stride_program=period * top_speed * swarm.drive,
                stride_action=period * top_speed * swarm.drive_action,
                swarms=len(game.swarms),
                # The package's own policies choose what they were given.
                actions=actions if spec.is_user_defined else None,
            )
            robots.append(robot)
    return robots


def remove_robots(model: Host, robots: Sequence[Krembot], absent: Sequence[int]) -> list[Krembot]:
    """Take robots out of a game, and return the others, whose rows close their ranks.

    Parameters
    ----------
    model : Host
        Which they live in.
    robots : sequence of Krembot
        All that are there, by number; nobody may be absent yet.
    absent : sequence of int
        Numbers of those who go.
    """
    for number in absent:
        robots[number].finish(int(model.env.now))
        robots[number].remove()
    rest = [robot for robot in robots if robot.number not in absent]
    model.states.keep(np.array([robot.index for robot in rest]), model.space.agent_positions)
    for row, robot in enumerate(rest):
        robot.index = row
    return rest
