"""Benchmarks of games: CPU time beside a bare SimPy loop, growth with N, memory, start-up, storage.

As a script it prints a table of each. It does not judge the times.
"""

import os
import random
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import pyarrow.parquet as pq

from benchmarks.games import (
    Plan,
    WorkError,
    best,
    count_work,
    reference_events,
    time_bare_loop,
    time_game,
)
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.play import attempt
from kswarms.scenarios.runs.run import code_version, expand
from kswarms.scenarios.study.study import Study

MAX_TIMES_BARE: Final = 2.8  # times the CPU time of a bare SimPy loop
MAX_LEARNING_TIMES_BARE: Final = 3.3  # the same, for learners
AIM: Final = 400_000  # robot-seconds per CPU second
LEARNING_AIM: Final = 300_000  # the same, for learners
MAX_CATALOGUE: Final = 1.3  # CPU time of all runs of the catalogue (h)
MAX_GROWTH: Final = 1.5  # of the cost at N = 20,000, relative to the smallest
GROWTH_AIM: Final = 1.6  # the same at N = 100,000
MAX_BUILDING: Final = 6.0  # CPU time of building a game of N = 100,000 (s)
MAX_ROBOT_MEMORY: Final = 7.0  # kB
MAX_MEMORY: Final = 300  # MB
MAX_SECONDS_TO_GAME: Final = 5.0
MAX_OVERHEAD: Final = 5.0  # CPU time per run, apart from its game (ms)
OTHER_SIMULATORS: Final = "ARGoS 3 without simulated sensors 8,475; Enki with sensors 53,700"

_COUNTS: Final = ["S1 / S2", "N", "timeouts", "events", "conflicts"]
_TIMES: Final = ["best ms", "median ms", "robot-s/CPU-s", "× bare loop", "own events"]


def speed(plan: Plan, seeds: Sequence[int], repetitions: int) -> list[str]:
    """Return a row of the table of speeds; the CPU time of a seed is the best of its repetitions."""
    works = [count_work(plan, seed) for seed in seeds]
    games, to_reference, to_own = [], [], []
    for seed, work in zip(seeds, works, strict=True):
        game = best(repetitions, lambda seed=seed, work=work: time_game(plan, seed, work)[1])
        games.append(game)
        events = reference_events(plan, seed, work)
        to_reference.append(game / best(repetitions, lambda events=events: time_bare_loop(plan.n, events)))
        to_own.append(to_reference[-1] * events / work.events)
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
        f"{statistics.median(to_reference):.2f}",
        f"{statistics.median(to_own):.2f}",
    ]


def growth(sizes: Sequence[int], duration: float, robot_seconds: float) -> list[list[str]]:
    """Return the rows of the table of costs at constant density, relative to the first size.

    Each game is repeated until it has at least `robot_seconds`; the fastest counts.
    """
    rows, first = [], 0.0
    for n in sizes:
        plan = Plan("avoid,attack", n, duration, side=2.0 * (n / sizes[0]) ** 0.5)
        work = count_work(plan, 0)
        repetitions = 1 + int(robot_seconds / plan.robot_seconds)
        times = [time_game(plan, 0, work) for _ in range(repetitions)]
        cost = 1e6 * min(played for _, played in times) / plan.robot_seconds
        first = first or cost
        building = min(built for built, _ in times)
        row = [f"{n:,}", f"{plan.side:.1f}", f"{work.events:,}", f"{work.conflicts:,}"]
        rows.append([*row, f"{cost:.2f}", f"{cost / first:.2f}", f"{building:.2f}"])
    return rows


def catalogue_hours(size: int) -> list[str]:
    """Return a row: runs of the catalogue, played runs, CPU time of all (h), its standard error.

    The played runs are drawn with probabilities in proportion to the estimates of `Run.effort`, so the mean
    ratio of CPU time to estimate, times the sum of the estimates, is the CPU time of all runs.
    """
    runs = expand(CATALOGUE.values())
    efforts = [run.effort for run in runs]
    ratios = []
    for run in random.Random(0).choices(runs, efforts, k=size):
        result, seconds = attempt(run, "", code_version())
        if isinstance(result, Failure):
            raise WorkError(f"{run}: {result.error}")
        ratios.append(seconds / run.effort)
    hours = sum(efforts) / 3600
    error = statistics.stdev(ratios) / size**0.5
    return [f"{len(runs):,}", str(size), f"{hours * statistics.mean(ratios):.2f}", f"{hours * error:.2f}"]


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
    sizes: Sequence[int] = (50, 200, 800, 3200, 20_000, 100_000),
    sample: int = 60,
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
    sample : int
        Runs of the catalogue that are played.
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
        f"bounds, avoid / attack at N = 50: ≤ {MAX_TIMES_BARE:g} × a bare SimPy loop, "
        f"aim ≥ {AIM:,} robot-s/CPU-s\n  ({OTHER_SIMULATORS})\n"
        "  timeouts: legs, turns, flights and fights of robots; events: timeouts and waits of the motion\n"
        "  process; × bare loop: with as many events as the same games had at commit 9f1a721, or have now",
    )
    learning = Plan("attack,inter-learner", 50, duration, learning=5 * duration)
    print_table(
        f"The same after learning for {learning.learning:g} s; conflicts are those of the measured game",
        [*_COUNTS, *_TIMES],
        [speed(learning, range(seeds), repetitions)],
        f"bounds: ≤ {MAX_LEARNING_TIMES_BARE:g} × a bare SimPy loop, aim ≥ {LEARNING_AIM:,} robot-s/CPU-s",
    )
    print_table(
        "CPU time of all runs of the catalogue, by a sample in proportion to the estimated times",
        ["runs", "played", "CPU h", "standard error"],
        [catalogue_hours(sample)],
        f"bound: ≤ {MAX_CATALOGUE:g} h",
    )
    print_table(
        f"Constant density, avoid / attack, {duration / 20:g} s",
        ["N", "side m", "events", "conflicts", "CPU µs / robot-s", "relative", "building s"],
        growth(sizes, duration / 20, 100 * duration),
        f"bounds: ≤ {MAX_GROWTH:g} at N = 20,000, aim ≤ {GROWTH_AIM:g} at N = 100,000, without building; "
        f"building N = 100,000 ≤ {MAX_BUILDING:g} s",
    )
    imports = "from kswarms import ForagingModel"
    game = f"{imports}\nForagingModel(n={{}}, side={{}}, record='', seed=0, duration={{}}).play()"
    codes = (imports, game.format(50, 2.0, duration), game.format(20_000, 40.0, duration / 20))
    base, *others = map(peak_memory, codes)
    print_table(
        "Peak memory of a new process, compiled code cached",
        ["", "MB", "kB / robot"],
        [
            ["imports only", f"{base:.0f}", ""],
            ["a game of N = 50", f"{others[0]:.0f}", ""],
            ["a game of N = 20,000", f"{others[1]:.0f}", f"{(others[1] - base) / 20:.1f}"],
        ],
        f"bounds: < {MAX_MEMORY} MB at N = 50, ≤ {MAX_ROBOT_MEMORY:g} kB per robot",
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
