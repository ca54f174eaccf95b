"""Worlds of other simulators, as near to a game of kswarms as each gets; `benchmarks.peers` runs them.

Run ``python -P benchmarks/peer_worlds.py NAME SECONDS`` where the simulator is installed. It plays for some
CPU time and prints robot-seconds per CPU second. 50 discs of 17 cm drive at 15 cm/s in a square of 2 m, and
turn at random times of 3 s on average.
"""

import math
import random
import sys
import time
from collections.abc import Callable, Iterable
from typing import Any, Final

ROBOTS: Final = 50
RADIUS: Final = 0.085
"""m"""
SPEED: Final = 0.15
"""m/s"""
SIDE: Final = 2.0
"""m"""
REACH: Final = 0.3
"""Distance within which robots notice each other (m)."""
PERIOD: Final = 0.1
"""Control period (s)."""
TURNS: Final = PERIOD / 3.0
"""Probability that a robot turns in a period."""
EVENTS: Final = 40_198 / (50 * 600)
"""Events of a game of kswarms per robot-second: avoid against attack at commit 9f1a721, mean of 5 seeds."""
SECONDS: Final = 60.0
"""Simulated time between two readings of the clock (s)."""
BATCH: Final = 1024
"""Games that VMAS plays at once."""
BATCH_SECONDS: Final = 5.0
"""Simulated time of each of these games between two readings of the clock (s)."""


World = tuple[Callable[[], object], float]
"""A function that plays a part of a game, and the robot-seconds of that part."""


def kswarms() -> World:
    """Play complete games of avoid against attack, 600 s each, their set-up included."""
    from kswarms import ForagingModel

    def play() -> None:
        ForagingModel(n=ROBOTS, policies="avoid,attack", seed=0, record="", duration=600.0).play()

    return play, 600 * ROBOTS


def simpy() -> World:
    """Process timeouts alone."""
    import simpy

    env = simpy.Environment()

    def wait() -> Iterable[simpy.Event]:
        while True:
            yield env.timeout(1.0 / EVENTS)

    for _ in range(ROBOTS):
        env.process(wait())
    return lambda: env.run(until=env.now + SECONDS), SECONDS * ROBOTS


def mesa() -> World:
    """Query the neighbours of each agent and move it in each period, in Mesa's continuous space."""
    from mesa import Model
    from mesa.experimental.continuous_space import ContinuousSpace, ContinuousSpaceAgent

    class Walker(ContinuousSpaceAgent):
        """An agent that moves straight, and turns at random times and at walls."""

        def __init__(self, space: Any, model: Model) -> None:
            super().__init__(space, model)
            self.position = [random.uniform(0, SIDE), random.uniform(0, SIDE)]
            self.heading = 0.0

        def step(self) -> None:
            """Look at the neighbours, then move."""
            self.get_neighbors_in_radius(REACH)
            if random.random() < TURNS:
                self.heading = random.uniform(0, math.tau)
            x, y = self.position
            x += SPEED * PERIOD * math.cos(self.heading)
            y += SPEED * PERIOD * math.sin(self.heading)
            if 0 < x < SIDE and 0 < y < SIDE:
                self.position = [x, y]
            else:
                self.heading = random.uniform(0, math.tau)

    model = Model(seed=0)
    space = ContinuousSpace([[0, SIDE], [0, SIDE]], torus=False, random=model.random, n_agents=ROBOTS)
    for _ in range(ROBOTS):
        Walker(space, model)

    def play() -> None:
        for _ in range(round(SECONDS / PERIOD)):
            model.agents.do("step")

    return play, SECONDS * ROBOTS


def pymunk(substeps: int) -> World:
    """Drive discs with contacts and friction, in sub-steps of the control period."""
    import pymunk

    space = pymunk.Space()
    corners = [(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)]
    for k in range(4):
        space.add(pymunk.Segment(space.static_body, corners[k - 1], corners[k], 0.01))
    bodies = []
    for k in range(ROBOTS):
        body = pymunk.Body(1.0, pymunk.moment_for_circle(1.0, 0, RADIUS))
        body.position = 0.2 + 0.2 * (k % 8), 0.2 + 0.2 * (k // 8)
        disc = pymunk.Circle(body, RADIUS)
        disc.friction = 0.18
        space.add(body, disc)
        bodies.append(body)
    headings = [0.0] * ROBOTS

    def play() -> None:
        for _ in range(round(SECONDS / PERIOD)):
            for k, body in enumerate(bodies):
                if random.random() < TURNS:
                    headings[k] = random.uniform(0, math.tau)
                body.velocity = SPEED * math.cos(headings[k]), SPEED * math.sin(headings[k])
            for _ in range(substeps):
                space.step(PERIOD / substeps)

    return play, SECONDS * ROBOTS


def vmas() -> World:
    """Drive discs with soft contacts in a batch of games."""
    import torch
    from vmas import make_env
    from vmas.simulator.core import Agent, Sphere
    from vmas.simulator.core import World as Space
    from vmas.simulator.scenario import BaseScenario

    class Discs(BaseScenario):
        """Discs without a task."""

        def make_world(self, batch_dim: int, device: Any, **_: Any) -> Any:
            """Return the world."""
            half = SIDE / 2 - RADIUS
            world = Space(batch_dim, device, dt=PERIOD, x_semidim=half, y_semidim=half)
            for k in range(ROBOTS):
                world.add_agent(Agent(f"robot {k}", shape=Sphere(RADIUS), max_speed=SPEED))
            return world

        def reset_world_at(self, env_index: int | None = None) -> None:
            """Place the discs on a grid."""
            for k, agent in enumerate(self.world.agents):
                place = torch.tensor([0.2 * (k % 8) - 0.7, 0.2 * (k // 8) - 0.7])
                agent.set_pos(place, batch_index=env_index)

        def observation(self, agent: Any) -> Any:
            """Return the position."""
            return agent.state.pos

        def reward(self, agent: Any) -> Any:
            """Return 0."""
            return torch.zeros(self.world.batch_dim)

    torch.set_num_threads(1)
    env = make_env(Discs(), num_envs=BATCH, device="cpu", continuous_actions=True, seed=0)
    env.reset()
    forces = [2 * torch.rand(BATCH, 2) - 1 for _ in range(ROBOTS)]

    def play() -> None:
        for _ in range(round(BATCH_SECONDS / PERIOD)):
            for force in forces:
                turning = torch.rand(BATCH) < TURNS
                force[turning] = 2 * torch.rand(int(turning.sum()), 2) - 1
            env.step(forces)

    return play, BATCH * BATCH_SECONDS * ROBOTS


WORLDS: Final[dict[str, Callable[[], World]]] = {
    "kswarms": kswarms,
    "simpy": simpy,
    "mesa": mesa,
    "pymunk, 1 sub-step": lambda: pymunk(1),
    "pymunk, 10 sub-steps": lambda: pymunk(10),
    "vmas": vmas,
}
"""Functions that build a world."""


def throughput(name: str, cpu_seconds: float) -> float:
    """Return the robot-seconds per CPU second of a world that plays for some CPU time, after a warm-up."""
    play, robot_seconds = WORLDS[name]()
    play()
    played, start = 0, time.process_time()
    while played == 0 or time.process_time() < start + cpu_seconds:
        play()
        played += 1
    return played * robot_seconds / (time.process_time() - start)


if __name__ == "__main__":
    print(throughput(sys.argv[1], float(sys.argv[2])))
