"""``run``: play scenarios, write tables of their results, draw them."""

import shlex
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Annotated, Final

import typer

from agents.errors import InputError
from scenarios.catalogue import CATALOGUE, TABLES
from scenarios.choice import chosen, integers, planned, words
from scenarios.cli.options import Jobs, processes
from scenarios.description import Scenario
from scenarios.runner import RECORDS, play_all
from scenarios.runs import Run, expand

# Of a printed table: as wide as it is, for rich would break the cells in a pipe's 80 columns.
_ANY_WIDTH: Final = 1000


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
    jobs: Jobs = None,
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
    workers = processes(jobs)
    names = words(record)
    for name in names:
        if name not in RECORDS:
            raise InputError("record", name, f"must be among {', '.join(RECORDS)}")

    for table in _play(expand(scenarios, first_seed), workers, ",".join(names), out):
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
