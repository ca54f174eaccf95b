"""``calibrate``: fit the free parameters."""

from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from kswarms.scenarios.catalogue.selecting import integers, words
from kswarms.scenarios.cli.options import Jobs, directory, processes
from kswarms.scenarios.cli.progress import tracked
from kswarms.scenarios.runs.run import Run


def calibrate(
    free: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Parameters to fit, two at least, of those of docs/calibration.md. [default: all]",
        ),
    ] = None,
    densities: Annotated[
        str | None,
        typer.Option(
            metavar="N,N,...", help="Rows of Table 6.1 to fit: 6,10,16,20,26,30,36,40,46,50. [default: all]"
        ),
    ] = None,
    seeds: Annotated[int, typer.Option(help="Games for each cell of the table and point, at least 1.")] = 4,
    generations: Annotated[int, typer.Option(help="Generations of the search, at least 1.")] = 25,
    population: Annotated[
        int, typer.Option(help="Points in a generation, at least 4; 0: as many as is usual.")
    ] = 0,
    validation_seeds: Annotated[
        int, typer.Option(help="Games for each cell in the validation, at least 5.")
    ] = 20,
    jobs: Jobs = None,
    out: Annotated[
        Path, typer.Option(parser=directory, metavar="DIR", help="What is kept, and gone on from.")
    ] = Path("calibration"),
    fresh: Annotated[bool, typer.Option("--fresh", help="Forget what DIR holds.")] = False,
) -> None:
    """Fit the free parameters to Table 6.1; called again after an interruption, go on."""
    from kswarms.analysis.results.published import table_6_1
    from kswarms.scenarios.calibration import fit as calibration

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
    from kswarms.scenarios.runs.sweep import play_all

    with closing(play_all(runs, jobs)) as played:
        for run, outcome in tracked(played, "learning", len(runs)):
            yield run, outcome.policies[0]["attack_share"]
