"""What a game costs: CPU time beside a bare SimPy loop, growth, memory, time to a first game, its keeping.

Run as a script it prints one table for each. Nothing depends on how long something takes; but every game that
is timed must have done the work that a counted game of the same seed does, or `WorkError` ends the benchmark.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import pyarrow.parquet as pq
import simpy
from simpy.events import Event, Timeout

from kswarms.model.foraging import ForagingModel
from kswarms.model.game_model import GameModel
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.study.study import Study

MOST_TIMES_BARE: Final = 5.0
LEAST_THROUGHPUT: Final = 80_000
LEAST_LEARNING_THROUGHPUT: Final = 60_000
MOST_GROWTH: Final = 1.5
MOST_MEMORY: Final = 300
MOST_SECONDS_TO_GAME: Final = 5.0
MOST_OVERHEAD: Final = 5.0
CONTEXT: Final = "ARGoS 3 without simulated sensors 8,475; Enki with sensors 53,700"


class WorkError(RuntimeError):
    """A game did not do the work that it is timed for."""


class Work(NamedTuple):
    """What was done in a game.

    Attributes
    ----------
    timeouts : int
        Robots' SimPy timeouts that the clock processed: legs, turns, flights, fights.
    events : int
        All events that it processed: these, and the waits of the motion process.
    scheduled : int
        All events that were scheduled, those after the end of the game included.
    conflicts, pucks : int
        Begun and deposited, by all robots, in the measured game.
    """

    timeouts: int
    events: int
    scheduled: int
    conflicts: int
    pucks: int


class Plan(NamedTuple):
    """A kind of game, as `kswarms.model.foraging.ForagingModel` takes it."""

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
        """Robots × seconds of a game, those of learning included."""
        return self.n * (self.learning + self.duration)


def count_work(plan: Plan, seed: int) -> Work:
    """Play a game and count what the clock processes.

    Raises
    ------
    WorkError
        If the robots' times do not add up to the time played, or nothing happened.
    """
    model = plan.model(seed)
    kinds: Counter[type[Event]] = Counter()
    step = model.env.step

    def counted_step() -> None:
        kinds[type(model.env._queue[0][-1])] += 1
        step()

    model.env.step = counted_step  # type: ignore[method-assign]
    model.play()
    work = _done(model)._replace(timeouts=kinds[Timeout], events=kinds.total())
    played = sum(row["t_a_intra"] + row["t_a_inter"] + row["t_p"] for row in model.results())
    model.forget()
    measured = plan.n * plan.duration
    if abs(played - measured) > 1e-6 * measured:
        raise WorkError(f"{plan}, seed {seed}: {played} robot-seconds played, not {measured}")
    # A conflict sets a timeout at once; at the end of the game each robot's last may still run.
    if work.timeouts + plan.n < work.conflicts or min(work.timeouts, work.conflicts) == 0:
        raise WorkError(f"{plan}, seed {seed}: too little happened for a game: {work}")
    return work


def time_game(plan: Plan, seed: int, work: Work) -> tuple[float, float]:
    """Return the CPU time of building and of playing a game (s), one process, compiled already.

    Raises
    ------
    WorkError
        If it did not do the work that was counted for this seed.
    """
    start = time.process_time()
    model = plan.model(seed)
    built = time.process_time()
    model.play()
    played = time.process_time()
    # Counting what is processed would cost time; what was scheduled says as much, and SimPy counts it anyway.
    done = _done(model)._replace(timeouts=work.timeouts, events=work.events)
    model.forget()
    if done != work:
        raise WorkError(f"{plan}, seed {seed}: counted {work}, but timed {done}")
    return built - start, played - built


def time_bare_loop(processes: int, timeouts: int) -> float:
    """Return the CPU time (s) in which SimPy processes timeouts and nothing else, shared among processes."""
    env = simpy.Environment()

    def wait(times: int) -> Iterable[simpy.Event]:
        for _ in range(times):
            yield env.timeout(1)

    for k in range(processes):
        env.process(wait(timeouts // processes + (k < timeouts % processes)))
    start = time.process_time()
    env.run()
    return time.process_time() - start


def speed(plan: Plan, seeds: Sequence[int], repetitions: int) -> list[str]:
    """Return a line of the table of speeds; the CPU time of a seed is the best of its repetitions."""
    works = [count_work(plan, seed) for seed in seeds]
    games, to_events, to_timeouts = [], [], []
    for seed, work in zip(seeds, works, strict=True):
        game = _best(repetitions, lambda seed=seed, work=work: time_game(plan, seed, work)[1])
        games.append(game)
        to_events.append(game / _best(repetitions, lambda work=work: time_bare_loop(plan.n, work.events)))
        to_timeouts.append(game / _best(repetitions, lambda work=work: time_bare_loop(plan.n, work.timeouts)))
    median = statistics.median(games)
    means = [f"{statistics.mean(work[k] for work in works):,.0f}" for k in (0, 1, 3)]  # not scheduled, pucks
    return [
        *(plan.policies.replace(",", " / "), str(plan.n), *means),
        *(f"{1000 * min(games):.1f}", f"{1000 * median:.1f}", f"{plan.robot_seconds / median:,.0f}"),
        *(f"{statistics.median(to_events):.2f}", f"{statistics.median(to_timeouts):.2f}"),
    ]


def growth(sizes: Sequence[int], duration: float, repetitions: int) -> list[list[str]]:
    """Return the lines of the table of costs at constant density, relative to the first size."""
    lines, first = [], 0.0
    for n in sizes:
        plan = Plan("avoid,attack", n, duration, side=2.0 * (n / sizes[0]) ** 0.5)
        work = count_work(plan, 0)
        times = [time_game(plan, 0, work) for _ in range(repetitions)]
        cost = 1e6 * min(played for _, played in times) / plan.robot_seconds
        first = first or cost
        lines.append(
            [
                *(str(n), f"{plan.side:.1f}", f"{work.events:,}", f"{work.conflicts:,}"),
                *(f"{cost:.2f}", f"{cost / first:.2f}", f"{min(built for built, _ in times):.2f}"),
            ]
        )
    return lines


def peak_memory(code: str) -> float:
    """Return the peak resident memory of a fresh interpreter that runs `code` (MB).

    The kernel's own figure for the address space: ``ru_maxrss`` of a child starts at its parent's peak.
    """
    report = "print([line for line in open('/proc/self/status') if line.startswith('VmHWM')][0].split()[1])"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{report}"], capture_output=True, text=True, check=True
    )
    return float(done.stdout.split()[-1]) * 1024 / 1e6


def seconds_to_game(n: int) -> float:
    """Return how long a new process of the command line takes to play and store one game (s)."""
    with tempfile.TemporaryDirectory() as directory:
        words = f"run fig-6.1c --densities {n} --seeds 1 --jobs 1 --no-figures --out {directory}/results"
        program = "from kswarms.scenarios.cli import main; main()"
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", program, *words.split()], capture_output=True, text=True, check=True
        )
        took = time.perf_counter() - start
    if "runs.parquet" not in done.stdout:
        raise WorkError(f"no table was written: {done.stdout}")
    return took


def overhead(runs: int, jobs: int) -> list[str]:
    """Return a line of the table of what running and storing costs, besides the games of 1 s.

    CPU time of all processes, their start included, less that of the games; and what the process that stores
    has grown by from the first tenth of the runs to the last run.
    """
    swarms = (SwarmRule(policy="avoid"), SwarmRule(policy="attack"))
    tiny = Scenario(
        id="tiny",
        title="Tiny games",
        densities=(2,),
        seeds=runs,
        conditions=(Condition(swarms=swarms, duration=1.0),),
    )
    games, resident = 0.0, []
    before = sum(os.times()[:4])
    with tempfile.TemporaryDirectory() as directory:
        with Study(Path(directory)) as study:
            for done, (_, _, seconds) in enumerate(study.play(study.plan([tiny]), jobs), 1):
                games += seconds
                if done in (runs // 10, runs):
                    resident.append(_resident())
        stored = pq.read_metadata(study.tables[0]).num_rows
    if stored != 2 * runs:
        raise WorkError(f"{stored} rows stored of {runs} runs")
    cost = sum(os.times()[:4]) - before - games
    return [
        str(jobs),
        f"{runs:,}",
        f"{1e3 * games / runs:.2f}",
        f"{1e3 * cost / runs:.2f}",
        f"{resident[1] - resident[0]:.1f}",
    ]


def _resident() -> float:
    """Return the memory that this process holds (MB)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def print_table(title: str, head: Sequence[str], lines: Sequence[Sequence[str]], bound: str) -> None:
    """Print lines of cells under a head, the first column to the left, then what must hold."""
    rows = [head, *lines]
    widths = [max(len(row[k]) for row in rows) for k in range(len(head))]
    print(f"\n{title}")
    for row in rows:
        first, *others = (cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        print("  " + "  ".join([row[0].ljust(len(first)), *others]))
    print(f"  {bound}")


def main(
    seeds: int = 5,
    repetitions: int = 3,
    duration: float = 600.0,
    sizes: Sequence[int] = (50, 200, 800, 3200),
    runs: int = 5000,
) -> None:
    """Measure all and print it.

    Parameters
    ----------
    seeds, repetitions : int
        Games of each kind, and how often each is played.
    duration : float
        Length of a game (s).
    sizes : sequence of int
        Numbers of robots at constant density, the first in the arena of 2 m.
    runs : int
        Tiny games that are kept in a ledger.
    """
    pairs = (("avoid,attack", 50), ("attack,attack", 50), ("avoid,attack", 6), ("attack,attack", 6))
    time_game(Plan("avoid,attack", 6, 10.0), 0, count_work(Plan("avoid,attack", 6, 10.0), 0))  # compiles
    head = [
        *("S1 / S2", "N", "timeouts", "events", "conflicts"),
        *("best ms", "median ms", "robot-s/CPU-s", "× bare loop", "timeouts only"),
    ]
    print_table(
        f"CPU time of a game of {duration:g} s, recording off, {seeds} seeds, best of {repetitions} each",
        head,
        [speed(Plan(policies, n, duration), range(seeds), repetitions) for policies, n in pairs],
        f"bounds, avoid / attack at N = 50: ≤ {MOST_TIMES_BARE:g} × a bare SimPy loop of as many events, "
        f"≥ {LEAST_THROUGHPUT:,} robot-s/CPU-s\n  ({CONTEXT})\n"
        "  timeouts: the robots' legs, turns, flights and fights; events: these and the waits of the motion\n"
        "  process; × bare loop: of as many events, and of as many timeouts as the robots have",
    )
    learning = Plan("attack,inter-learner", 50, duration, learning=5 * duration)
    print_table(
        f"The same with learning for {learning.learning:g} s before it; conflicts are those of the game",
        head,
        [speed(learning, range(seeds), repetitions)],
        f"bounds: ≤ {MOST_TIMES_BARE:g} × a bare SimPy loop, ≥ {LEAST_LEARNING_THROUGHPUT:,} robot-s/CPU-s",
    )
    print_table(
        f"Constant density, avoid / attack, {duration / 6:g} s",
        ["N", "side m", "events", "conflicts", "CPU µs / robot-s", "relative", "building s"],
        growth(sizes, duration / 6, 2),
        f"bound: ≤ {MOST_GROWTH:g} at N = {sizes[-1]}; building is not in it",
    )
    imports = "from kswarms import ForagingModel"
    game = f"{imports}\nForagingModel(n=50, record='', duration={duration}).play()"
    print_table(
        "Peak memory of a new process that plays N = 50, compiled code cached",
        ["", "MB"],
        [[what, f"{peak_memory(code):.0f}"] for what, code in (("imports alone", imports), ("a game", game))],
        f"bound: < {MOST_MEMORY} MB",
    )
    print_table(
        "A second `kswarms run fig-6.1c --densities N --seeds 1 --jobs 1 --no-figures`, from start to exit",
        ["N", "s"],
        [[str(n), f"{min(seconds_to_game(n) for _ in range(2)):.2f}"] for n in (6, 50)],
        f"bound: first finished game within {MOST_SECONDS_TO_GAME:g} s",
    )
    print_table(
        "Games of 1 s and two robots, played by processes and kept in a ledger",
        ["processes", "runs", "CPU ms / game", "CPU ms / run besides", "grown by MB"],
        [overhead(runs, jobs) for jobs in (1, 2)],
        f"bound: ≤ {MOST_OVERHEAD:g} ms besides the game, the start of the processes included",
    )


def _done(model: GameModel) -> Work:
    rows: list[dict[str, Any]] = model.results()
    conflicts = sum(row["conflicts_intra"] + row["conflicts_inter"] for row in rows)
    return Work(0, 0, next(model.env._eid), conflicts, sum(row["pucks"] for row in rows))


def _best(repetitions: int, measure: Callable[[], float]) -> float:
    return min(measure() for _ in range(repetitions))


if __name__ == "__main__":
    main()
