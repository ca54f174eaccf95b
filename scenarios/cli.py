"""The command line ``kswarms``: lists, shows and plays scenarios.

What takes long to import is imported by the command that needs it.
"""

import os
import shlex
import sys
import traceback
from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from agents.errors import InputError
from scenarios.catalogue import CATALOGUE, TABLES
from scenarios.choice import chosen, integers, planned, words
from scenarios.description import Scenario, toml_of
from scenarios.runner import RECORDS, RunError, play_all
from scenarios.runs import Run, expand, package_version

INTERRUPTED: Final = 130

# Of a printed table: as wide as it is, for rich would break the cells in a pipe's 80 columns.
_ANY_WIDTH: Final = 1000

app = typer.Typer(
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Competing swarms of foraging robots: play the scenarios of the catalogue and see who wins.",
    epilog="Example: kswarms run fig-6.1a --densities 6,30 --seeds 3",
)


def main() -> None:
    """Run the command line and exit with its status."""
    sys.exit(invoke())


def invoke(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        The words after ``kswarms``; by default those that this process was started with.

    Returns
    -------
    int
        Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted.
    """
    try:
        status: int | None = app(arguments, prog_name="kswarms", standalone_mode=False)
    except InputError as error:
        return _complain(str(error), 2)
    except RunError as error:
        traceback.print_exception(error.__cause__)  # a fault of the program, not of its input
        return _complain(str(error), 1)
    except OSError as error:
        return _complain(str(error), 1)
    except typer.TyperException as error:  # typer's own complaints: an unknown command or option, no number
        return _complain(error.format_message(), error.exit_code)
    if status == INTERRUPTED:
        return _complain("interrupted", status)
    return status or 0


def _complain(message: str, status: int) -> int:
    typer.echo(f"kswarms: {' '.join(message.split())}", err=True)
    return status


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"kswarms {package_version()}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _without_command(
    context: typer.Context,
    _version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command("list", epilog="Example: kswarms list")
def list_scenarios() -> None:
    """List the scenarios of the catalogue, and the tables made of some."""
    titles = {name: scenario.title for name, scenario in CATALOGUE.items()}
    titles |= {name: table.title for name, table in TABLES.items()}
    width = max(map(len, titles))
    for name, title in titles.items():
        typer.echo(f"{name:<{width}}  {title}")


@app.command(epilog="Example: kswarms show fig-6.1c")
def show(
    wanted: Annotated[str, typer.Argument(metavar="ID", help="A scenario or table of the list.")],
) -> None:
    """Print a scenario as TOML, or those that a table is made of."""
    scenarios = chosen([wanted])
    typer.echo(toml_of(scenarios) if wanted in TABLES else scenarios[0].to_toml(), nl=False)


@app.command(epilog="Example: kswarms run fig-6.1a fig-6.1c --densities 6,30,50 --seeds 5")
def run(
    ids: Annotated[
        list[str] | None, typer.Argument(metavar="ID...", help="Scenarios or tables of the list.")
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="All scenarios, each with those --densities that suit it.")
    ] = False,
    densities: Annotated[
        str | None, typer.Option(metavar="N,N,...", help="Robots in all. [default: the scenario's own]")
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(help="Games for each density. [default: the scenario's own]")
    ] = None,
    first_seed: Annotated[int, typer.Option(help="Seed of the first of these games.")] = 0,
    jobs: Annotated[int | None, typer.Option(help="Processes that play. [default: one for each CPU]")] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Where the results go.")] = Path("results"),
    record: Annotated[
        str, typer.Option(metavar="NAME,...", help=f"More tables to write: {', '.join(RECORDS)}.")
    ] = "",
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Write the tables alone.")] = False,
) -> None:
    """Play scenarios, write tables of their results and draw a figure of each."""
    ids = ids or []
    if bool(ids) == everything:
        raise InputError("id", " ".join(ids), "must be one or more of `kswarms list`, or none with --all")
    scenarios, left_out = planned(
        chosen(ids or CATALOGUE), integers("densities", densities), seeds, suitable_only=everything
    )
    if left_out:
        typer.echo(f"kswarms: none of the densities suits {', '.join(left_out)}: left out", err=True)
    if first_seed < 0:
        raise InputError("first_seed", first_seed, "must be at least 0")
    jobs = jobs if jobs is not None else os.cpu_count() or 1
    if jobs < 1:
        raise InputError("jobs", jobs, "must be at least 1")
    names = words(record)
    for name in names:
        if name not in RECORDS:
            raise InputError("record", name, f"must be among {', '.join(RECORDS)}")

    for table in _play(expand(scenarios, first_seed), jobs, ",".join(names), out):
        typer.echo(f"table:  {table}")
    if not no_figures:
        from analysis.figures import draw

        titles = {scenario.id: scenario.title for scenario in scenarios}
        for picture in draw(out, list(titles), titles):
            typer.echo(f"figure: {picture}")
    for table_id in dict.fromkeys(ids):
        if table_id in TABLES:
            _print_table(table_id, out)
    typer.echo(f"next:   {_next_command(scenarios, out)}")


@app.command(epilog="Example: kswarms calibrate --free friction,gamma --densities 16,30,50 --seeds 2")
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
    jobs: Annotated[int | None, typer.Option(help="Processes that play. [default: one for each CPU]")] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="What is kept, and gone on from.")] = Path(
        "calibration"
    ),
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
    jobs = jobs if jobs is not None else os.cpu_count() or 1
    if jobs < 1:
        raise InputError("jobs", jobs, "must be at least 1")
    table = table_6_1()
    target = {
        (opponent, int(n)): float(percent)
        for opponent, column in (("avoid", "fig_6_4a_attack_pct"), ("attack", "fig_6_4b_attack_pct"))
        for n, percent in zip(table["n"], table[column], strict=True)
    }
    trace = calibration.calibrate(
        setup, target, partial(_learned, jobs), out, fresh, report=partial(typer.echo, err=True)
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


def _print_table(table_id: str, out: Path) -> None:
    from rich.console import Console
    from rich.table import Table

    from analysis.results import read_policies
    from analysis.tables import learned, printed

    title, scenarios = TABLES[table_id]
    text = printed(learned(read_policies(out), scenarios))
    table = Table()
    for heading in text.header:
        table.add_column(heading, justify="right")
    for cells in text.rows:
        table.add_row(*cells)
    console = Console(width=_ANY_WIDTH, highlight=False)
    console.print(f"\n{table_id}: {title}", table, text.caption, sep="\n")


def _play(runs: Sequence[Run], jobs: int, record: str, out: Path) -> list[Path]:
    from rich.console import Console
    from rich.progress import track

    from scenarios.tables import prepare, tabulate, write

    prepare(out)
    with closing(play_all(runs, jobs, record)) as played:
        progress = track(played, "playing", total=len(runs), console=Console(stderr=True))
        return write(out, [tabulate(run, outcome) for run, outcome in progress])


def _next_command(played: Sequence[Scenario], out: Path) -> str:
    rest = [scenario_id for scenario_id in CATALOGUE if scenario_id not in {each.id for each in played}]
    if not rest:
        return f"kswarms show {played[0].id}  (what was played)"
    return f"kswarms run {rest[0]} --out {shlex.quote(str(out))}  (`kswarms list` names all)"
