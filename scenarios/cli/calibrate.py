"""``calibrate``: fit the free parameters."""

from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from scenarios.choice import integers, words
from scenarios.cli.options import Jobs, directory, processes
from scenarios.runner import play_all
from scenarios.runs import Run


def calibrate(
    free: Annotated[
        str | None, typer.Option(metavar="NAME,...", help="Parameters to fit, two at least. [default: all]")
    ] = None,
    densities: Annotated[
        str | None, typer.Option(metavar="N,N,...", help="Rows of Table 6.1 to fit. [default: all]")
    ] = None,
    seeds: Annotated[int, typer.Option(help="Games for each cell of the table and point.")] = 4,
    generations: Annotated[int, typer.Option(help="Generations of the search.")] = 25,
    population: Annotated[int, typer.Option(help="Points in a generation; 0: as many as is usual.")] = 0,
    validation_seeds: Annotated[int, typer.Option(help="Games for each cell in the validation.")] = 20,
    jobs: Jobs = None,
    out: Annotated[
        Path, typer.Option(parser=directory, metavar="DIR", help="What is kept, and gone on from.")
    ] = Path("calibration"),
    fresh: Annotated[bool, typer.Option("--fresh", help="Forget what DIR holds.")] = False,
) -> None:
    """Fit the free parameters to Table 6.1; called again after an interruption, go on."""
    from analysis.published import table_6_1
    from scenarios import calibration

    asked: dict[str, Any] = {"seeds": seeds, "generations": generations, "population": population}
    if free is not None:
        asked["free"] = words(free)
    if densities is not None:
        asked["densities"] = integers("densities", densities)
    setup = calibration.Setup(**asked, validation_seeds=validation_seeds)
    workers = processes(jobs)
    table = table_6_1()
    target = {
        (opponent, int(n)): float(percent)
        for opponent, column in (("avoid", "fig_6_4a_attack_pct"), ("attack", "fig_6_4b_attack_pct"))
        for n, percent in zip(table["n"], table[column], strict=True)
    }
    trace = calibration.calibrate(
        setup, target, partial(_learned, workers), out, fresh, report=partial(typer.echo, err=True)
    )
    for line in calibration.summary(trace):
        typer.echo(line)
    typer.echo(f"trace:      {out / calibration.TRACE}")


def _learned(jobs: int, runs: Sequence[Run]) -> Generator[tuple[Run, float], None, None]:
    """Play runs with one learning swarm and yield each with the share of it that learned to attack."""
    from rich.console import Console
    from rich.progress import track

    console = Console(stderr=True)
    with closing(play_all(runs, jobs)) as played:
        for run, outcome in track(played, "learning", total=len(runs), console=console, transient=True):
            yield run, outcome.policies[0]["attack_share"]
