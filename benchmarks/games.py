"""Work and CPU time of single games.

A timed game must do the same work as a counted game of the same seed; otherwise `WorkError` is raised.
"""

import time
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Final, NamedTuple

import simpy
from simpy.events import Event

from kswarms.agents.robot.driver import Timer
from kswarms.model.foraging import ForagingModel


class WorkError(RuntimeError):
    """A timed game did not do the counted work."""


class Work(NamedTuple):
    """Work done in a game.

    Attributes
    ----------
    timeouts, events, scheduled : int
        Processed timeouts of robots (legs, turns, flights, fights); all processed events, including waits of
        the motion process; all scheduled events, including those after the end of the game.
    conflicts, pucks : int
        Conflicts and deposited pucks in the measured game.
    """

    timeouts: int
    events: int
    conflicts: int
    scheduled: int
    pucks: int


class Plan(NamedTuple):
    """Arguments of a `ForagingModel`."""

    policies: str
    n: int
    duration: float = 600.0
    side: float = 2.0
    learning: float = 0.0

    def model(self, seed: int) -> ForagingModel:
        """Build a game that records nothing."""
        return ForagingModel(**self._asdict(), seed=seed, record="")

    @property
    def robot_seconds(self) -> float:
        """Robots × seconds of a game, including learning."""
        return self.n * (self.learning + self.duration)


REFERENCE_EVENTS: Final = {
    Plan("avoid,attack", 50): (40465, 40534, 39869, 39990, 40134),
    Plan("attack,attack", 50): (44133, 47150, 45477, 44896, 46571),
    Plan("avoid,attack", 6): (5547, 5605, 5573, 5526, 6248),
    Plan("attack,attack", 6): (10034, 6841, 6652, 9174, 6069),
    Plan("attack,inter-learner", 50, learning=3000.0): (273714, 271397, 266113, 268245, 274317),
}
"""`Work.events` of commit 9f1a721 for the seeds 0 to 4. The bounds refer to a bare loop with as many events,
so that they stay comparable when games change."""


def reference_events(plan: Plan, seed: int, work: Work) -> int:
    """Return the number of events in `REFERENCE_EVENTS`; that of `work` for other games."""
    counts = REFERENCE_EVENTS.get(plan, ())
    return counts[seed] if seed < len(counts) else work.events


def count_work(plan: Plan, seed: int) -> Work:
    """Play a game and count its work.

    Raises
    ------
    WorkError
        If the robots' times do not add up to the duration of the game, or robots or conflicts are missing.
    """
    model = plan.model(seed)
    kinds: Counter[type[Event]] = Counter()
    step = model.env.step

    def counted_step() -> None:
        kinds[type(model.env._queue[0][-1])] += 1  # SimPy has no public access to the next event
        step()

    model.env.step = counted_step  # type: ignore[method-assign]
    model.play()
    work = _work(model, kinds[Timer], kinds.total())
    played = sum(row["t_a_intra"] + row["t_a_inter"] + row["t_p"] for row in model.results())
    measured = plan.n * plan.duration
    if abs(played - measured) > 1e-6 * measured:
        raise WorkError(f"{plan}, seed {seed}: {played} robot-seconds played, not {measured}")
    # Each conflict sets a timeout; at the end of the game, one timeout of each robot may be unprocessed.
    if work.timeouts + plan.n < work.conflicts or min(work.timeouts, work.conflicts) == 0:
        raise WorkError(f"{plan}, seed {seed}: too few events for a game: {work}")
    return work


def time_game(plan: Plan, seed: int, work: Work) -> tuple[float, float]:
    """Return the CPU times (s) of building and of playing a game in one process.

    Raises
    ------
    WorkError
        If the game did not do the work that was counted for this seed.
    """
    start = time.process_time()
    model = plan.model(seed)
    built = time.process_time()
    model.play()
    played = time.process_time()
    # Counting processed events would cost time; SimPy always counts the scheduled ones.
    done = _work(model, work.timeouts, work.events)
    if done != work:
        raise WorkError(f"{plan}, seed {seed}: counted {work}, but timed {done}")
    return built - start, played - built


def _work(model: ForagingModel, timeouts: int, events: int) -> Work:
    rows = model.results()
    conflicts = sum(row["conflicts_intra"] + row["conflicts_inter"] for row in rows)
    return Work(timeouts, events, conflicts, next(model.env._eid), sum(row["pucks"] for row in rows))


def time_bare_loop(processes: int, timeouts: int) -> float:
    """Return the CPU time (s) of a SimPy loop with only timeouts, shared among processes."""
    env = simpy.Environment()

    def wait(times: int) -> Iterable[simpy.Event]:
        for _ in range(times):
            yield env.timeout(1)

    for k in range(processes):
        env.process(wait(timeouts // processes + (k < timeouts % processes)))
    start = time.process_time()
    env.run()
    return time.process_time() - start


def best(repetitions: int, measure: Callable[[], float]) -> float:
    """Return the least of several measurements."""
    return min(measure() for _ in range(repetitions))
