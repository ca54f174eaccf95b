"""Benchmarks of games: CPU time beside a bare SimPy loop, growth with N, memory, start-up, storage.

As a script it prints a table of each. It does not judge the times.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import pyarrow.parquet as pq

from benchmarks.games import Plan, WorkError, best, count_work, time_bare_loop, time_game
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.study.study import Study

MAX_TIMES_BARE: Final = 5.0  # times the CPU time of a bare SimPy loop
MIN_THROUGHPUT: Final = 80_000  # robot-seconds per CPU second
MIN_LEARNING_THROUGHPUT: Final = 60_000  # the same, for learners
MAX_GROWTH: Final = 1.5  # of the cost at the largest N, relative to the smallest
MAX_MEMORY: Final = 300  # MB
MAX_SECONDS_TO_GAME: Final = 5.0
MAX_OVERHEAD: Final = 5.0  # CPU time per run, apart from its game (ms)
OTHER_SIMULATORS: Final = "ARGoS 3 without simulated sensors 8,475; Enki with sensors 53,700"

_COUNTS: Final = ["S1 / S2", "N", "timeouts", "events", "conflicts"]
_TIMES: Final = ["best ms", "median ms", "robot-s/CPU-s", "× bare loop", "timeouts only"]


def speed(plan: Plan, seeds: Sequence[int], repetitions: int) -> list[str]:
    """Return a row of the table of speeds; the CPU time of a seed is the best of its repetitions."""
    works = [count_work(plan, seed) for seed in seeds]
    games, to_events, to_timeouts = [], [], []
    for seed, work in zip(seeds, works, strict=True):
        game = best(repetitions, lambda seed=seed, work=work: time_game(plan, seed, work)[1])
        games.append(game)
        to_events.append(game / best(repetitions, lambda work=work: time_bare_loop(plan.n, work.events)))
        to_timeouts.append(game / best(repetitions, lambda work=work: time_bare_loop(plan.n, work.timeouts)))
    median = statistics.median(games)
    timeouts, events, conflicts, *_ = (
        f"{statistics.mean(column):,.0f}" for column in zip(*works, strict=True)
    )
    return [
        plan.policies.replace(",", " / "),
        str(plan.n),
        timeouts,
        events,
        conflicts,
        f"{1000 * min(games):.1f}",
        f"{1000 * median:.1f}",
        f"{plan.robot_seconds / median:,.0f}",
        f"{statistics.median(to_events):.2f}",
        f"{statistics.median(to_timeouts):.2f}",
    ]


def growth(sizes: Sequence[int], duration: float, repetitions: int) -> list[list[str]]:
    """Return the rows of the table of costs at constant density, relative to the first size."""
    rows, first = [], 0.0
    for n in sizes:
        plan = Plan("avoid,attack", n, duration, side=2.0 * (n / sizes[0]) ** 0.5)
        work = count_work(plan, 0)
        times = [time_game(plan, 0, work) for _ in range(repetitions)]
        cost = 1e6 * min(played for _, played in times) / plan.robot_seconds
        first = first or cost
        building = min(built for built, _ in times)
        row = [str(n), f"{plan.side:.1f}", f"{work.events:,}", f"{work.conflicts:,}"]
        rows.append([*row, f"{cost:.2f}", f"{cost / first:.2f}", f"{building:.2f}"])
    return rows


def peak_memory(code: str) -> float:
    """Return the peak resident memory (MB) of a new interpreter that runs `code`.

    It reads ``VmHWM`` of the new process; ``ru_maxrss`` of a child starts at the peak of its parent.
    """
    report = "print([line for line in open('/proc/self/status') if line.startswith('VmHWM')][0].split()[1])"
    return float(_run_python(f"{code}\n{report}").split()[-1]) * 1024 / 1e6


def seconds_to_game(n: int) -> float:
    """Return the time (s) that a new process of the command line takes to play and store one game."""
    with tempfile.TemporaryDirectory() as directory:
        words = f"run fig-6.1c --densities {n} --seeds 1 --jobs 1 --no-figures --out {directory}/results"
        start = time.perf_counter()
        output = _run_python("from kswarms.scenarios.cli import main; main()", *words.split())
        seconds = time.perf_counter() - start
    if "runs.parquet" not in output:
        raise WorkError(f"no table was written: {output}")
    return seconds


def _run_python(code: str, *arguments: str) -> str:
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def overhead(runs: int, jobs: int) -> list[str]:
    """Return a row of the table of overhead: the cost of a study besides its games of 1 s.

    The cost is the CPU time of all processes, including their start, less that of the games. Memory is the
    growth of the storing process between the first tenth of the runs and the last run.
    """
    swarms = (SwarmRule(policy="avoid"), SwarmRule(policy="attack"))
    condition = Condition(swarms=swarms, duration=1.0)
    tiny = Scenario(id="tiny", title="Tiny games", densities=(2,), seeds=runs, conditions=(condition,))
    games, resident = 0.0, []
    before = sum(os.times()[:4])
    with tempfile.TemporaryDirectory() as directory:
        with Study(Path(directory)) as study:
            for done, (_, _, seconds) in enumerate(study.play(study.plan([tiny]), jobs), 1):
                games += seconds
                if done in (runs // 10, runs):
                    resident.append(_resident_memory())
        stored = pq.read_metadata(study.tables[0]).num_rows
    if stored != 2 * runs:
        raise WorkError(f"{stored} rows stored of {runs} runs")
    cost = sum(os.times()[:4]) - before - games
    milliseconds = [f"{1e3 * games / runs:.2f}", f"{1e3 * cost / runs:.2f}"]
    return [str(jobs), f"{runs:,}", *milliseconds, f"{resident[1] - resident[0]:.1f}"]


def _resident_memory() -> float:
    """Return the resident memory of this process (MB)."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def print_table(title: str, header: Sequence[str], rows: Sequence[Sequence[str]], bound: str) -> None:
    """Print a table, its first column aligned left, and the bounds below it."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    print(f"\n{title}")
    for first, *others in (header, *rows):
        cells = (cell.rjust(width) for cell, width in zip(others, widths[1:], strict=True))
        print("  " + "  ".join([first.ljust(widths[0]), *cells]))
    print(f"  {bound}")


def main(
    seeds: int = 5,
    repetitions: int = 3,
    duration: float = 600.0,
    sizes: Sequence[int] = (50, 200, 800, 3200),
    runs: int = 5000,
) -> None:
    """Run all benchmarks and print their tables.

    Parameters
    ----------
    seeds, repetitions : int
        Games of each kind, and repetitions of each game.
    duration : float
        Length of a game (s).
    sizes : sequence of int
        Numbers of robots at constant density; the first is in an arena of 2 m.
    runs : int
        Number of tiny games in the study.
    """
    warm_up = Plan("avoid,attack", 6, 10.0)
    time_game(warm_up, 0, count_work(warm_up, 0))  # compiles the kernels
    kinds = (("avoid,attack", 50), ("attack,attack", 50), ("avoid,attack", 6), ("attack,attack", 6))
    print_table(
        f"CPU time of a game of {duration:g} s, recording off, {seeds} seeds, best of {repetitions} each",
        [*_COUNTS, *_TIMES],
        [speed(Plan(policies, n, duration), range(seeds), repetitions) for policies, n in kinds],
        f"bounds, avoid / attack at N = 50: ≤ {MAX_TIMES_BARE:g} × a bare SimPy loop with as many events, "
        f"≥ {MIN_THROUGHPUT:,} robot-s/CPU-s\n  ({OTHER_SIMULATORS})\n"
        "  timeouts: legs, turns, flights and fights of robots; events: timeouts and waits of the motion\n"
        "  process; × bare loop: relative to a loop with as many events, or as many timeouts",
    )
    learning = Plan("attack,inter-learner", 50, duration, learning=5 * duration)
    print_table(
        f"The same after learning for {learning.learning:g} s; conflicts are those of the measured game",
        [*_COUNTS, *_TIMES],
        [speed(learning, range(seeds), repetitions)],
        f"bounds: ≤ {MAX_TIMES_BARE:g} × a bare SimPy loop, ≥ {MIN_LEARNING_THROUGHPUT:,} robot-s/CPU-s",
    )
    print_table(
        f"Constant density, avoid / attack, {duration / 6:g} s",
        ["N", "side m", "events", "conflicts", "CPU µs / robot-s", "relative", "building s"],
        growth(sizes, duration / 6, 2),
        f"bound: ≤ {MAX_GROWTH:g} at N = {sizes[-1]}, without building",
    )
    imports = "from kswarms import ForagingModel"
    game = f"{imports}\nForagingModel(n=50, record='', seed=0, duration={duration}).play()"
    print_table(
        "Peak memory of a new process that plays N = 50, compiled code cached",
        ["", "MB"],
        [[name, f"{peak_memory(code):.0f}"] for name, code in (("imports only", imports), ("a game", game))],
        f"bound: < {MAX_MEMORY} MB",
    )
    print_table(
        "A second `kswarms run fig-6.1c --densities N --seeds 1 --jobs 1 --no-figures`, from start to exit",
        ["N", "s"],
        [[str(n), f"{best(2, lambda n=n: seconds_to_game(n)):.2f}"] for n in (6, 50)],
        f"bound: first finished game within {MAX_SECONDS_TO_GAME:g} s",
    )
    print_table(
        "Games of 1 s and two robots, played by worker processes and stored in a study",
        ["processes", "runs", "CPU ms / game", "other CPU ms / run", "growth MB"],
        [overhead(runs, jobs) for jobs in (1, 2)],
        f"bound: ≤ {MAX_OVERHEAD:g} ms besides the game, including the start of the processes",
    )


if __name__ == "__main__":
    main()
