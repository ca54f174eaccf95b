"""``calibrate``: fit the free parameters."""

from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from kswarms.scenarios.cli.options import CPUS, Jobs, parse_path
from kswarms.scenarios.cli.printing import print_line
from kswarms.scenarios.cli.progress import play_tracked
from kswarms.scenarios.description.text import parse_integers, split_words
from kswarms.scenarios.runs.run import Run


def calibrate(
    free: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...", help="At least two parameters of docs/calibration.md. [default: all]"
        ),
    ] = None,
    densities: Annotated[
        str | None,
        typer.Option(
            metavar="N,N,...", help="Rows of Table 6.1 to fit: 6,10,16,20,26,30,36,40,46,50. [default: all]"
        ),
    ] = None,
    seeds: Annotated[
        int, typer.Option(help="Games for each point and cell of the table, at least 1.")
    ] = 4,
    generations: Annotated[int, typer.Option(help="Generations of the search, at least 1.")] = 25,
    population: Annotated[
        int, typer.Option(help="Points (sets of values) in a generation, at least 4; 0: CMA-ES default.")
    ] = 0,
    validation_seeds: Annotated[
        int, typer.Option(help="Games for each cell in the validation, at least 6.")
    ] = 20,
    jobs: Jobs = CPUS,
    out: Annotated[
        Path,
        typer.Option(parser=parse_path, metavar="DIR", help="Output directory; a fit in it is resumed."),
    ] = Path("calibration"),
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Delete the fit in DIR and start a new one.")
    ] = False,
) -> None:
    """Fit the free parameters to Table 6.1. The same command resumes an interrupted fit.

    Example: kswarms calibrate --free friction,gamma --densities 16,30,50 --seeds 2
    """
    from kswarms.analysis.results.published import table_6_1
    from kswarms.analysis.statistics.intervals import bootstrap_interval
    from kswarms.scenarios.calibration import fit

    options: dict[str, Any] = {"seeds": seeds, "generations": generations, "population": population}
    if free is not None:
        options["free"] = split_words(free)
    if densities is not None:
        options["densities"] = parse_integers("densities", densities)
    setup = fit.Setup(**options, validation_seeds=validation_seeds)
    table = table_6_1()
    target = {
        (opponent, int(n)): float(percent)
        for opponent, column in (("avoid", "fig_6_4a_attack_pct"), ("attack", "fig_6_4b_attack_pct"))
        for n, percent in zip(table["n"], table[column], strict=True)
    }
    report = partial(typer.echo, err=True)
    trace = fit.calibrate(setup, target, partial(_play, jobs), bootstrap_interval, out, fresh, report)
    for line in fit.summary(trace):
        print_line(line)
    print_line(f"trace:      {out / fit.TRACE}")


def _play(jobs: int, runs: Sequence[Run]) -> Generator[tuple[Run, float], None, None]:
    """Play runs with one learning swarm; yield each with the share of its robots that learned to attack."""
    with closing(play_tracked(runs, jobs, "", "learning")) as played:
        for run, outcome in played:
            yield run, outcome.policies[0]["attack_share"]
