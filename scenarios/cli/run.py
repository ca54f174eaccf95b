"""``run``: play scenarios, write tables of their results, draw them."""

import shlex
from collections.abc import Sequence
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Annotated, Final

import typer

from kswarms.agents.common.columns import RECORDED_TABLES
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selecting import chosen, integers, planned, words
from kswarms.scenarios.cli.options import Jobs, check_seed, directory, processes
from kswarms.scenarios.cli.options import ids as ids_to_complete
from kswarms.scenarios.cli.printing import print_table
from kswarms.scenarios.cli.progress import KINDS, check_kind, told
from kswarms.scenarios.description.scenario import Scenario

_NEXT: Final = {
    "report": "all results in one HTML file",
    "status": "what failed, and how to see it fail again",
}
"""What the commands are for that a run names in the end."""


def run(
    context: typer.Context,
    ids: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ID",
            help="Scenarios or tables of the list, or files of your own: my.toml.",
            autocompletion=ids_to_complete,
        ),
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="All scenarios, each with those --densities that suit it.")
    ] = False,
    densities: Annotated[
        str | None,
        typer.Option(
            metavar="N,N,...", help="Robots in all, as the shares of its swarms allow. [default: its own]"
        ),
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(help="Games for each density, at least 1. [default: its own]")
    ] = None,
    first_seed: Annotated[int, typer.Option(help="Seed of the first of these games, at least 0.")] = 0,
    jobs: Jobs = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Play on the Dask cluster of this scheduler, as tcp://host:8786."
        ),
    ] = None,
    out: Annotated[
        Path,
        typer.Option(parser=directory, metavar="DIR", help="Where the results go, and are gone on from."),
    ] = Path("results"),
    record: Annotated[
        str, typer.Option(metavar="NAME,...", help=f"More tables to write: {', '.join(RECORDED_TABLES)}.")
    ] = "",
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Write the tables alone.")] = False,
    progress: Annotated[
        str, typer.Option(metavar="KIND", help=f"How to tell how far it is: {', '.join(KINDS)}.")
    ] = "bar",
    quiet: Annotated[bool, typer.Option("--quiet", help="Print what goes wrong alone.")] = False,
) -> int:
    """Play scenarios, write tables of their results and draw a figure of each.

    Called again, after whatever end, it goes on: what DIR has is not played again.
    """
    ids = ids or []
    if bool(ids) == everything:
        raise InputError("id", " ".join(ids), "must be one or more of `kswarms list`, or none with --all")
    scenarios, left_out = planned(
        chosen(ids or CATALOGUE), integers("densities", densities), seeds, suitable_only=everything
    )
    check_seed("first_seed", first_seed)
    workers = processes(jobs)
    records = words(record)
    for name in records:
        if name not in RECORDED_TABLES:
            raise InputError("record", name, f"must be among {', '.join(RECORDED_TABLES)}")
    kind = "none" if quiet else check_kind(progress)
    if left_out:
        typer.echo(f"kswarms: none of the densities suits {', '.join(left_out)}: left out", err=True)

    tables, failed = _play(
        scenarios, first_seed, workers, scheduler, records, out, kind, shlex.join(context.obj)
    )
    lines = [f"table:  {table}" for table in tables]
    if tables and not no_figures:
        from kswarms.analysis.figures.over_n import draw

        titles = {scenario.id: scenario.title for scenario in scenarios}
        lines += [f"figure: {picture}" for picture in draw(out, list(titles), titles)]
    if not quiet:
        for line in lines:
            typer.echo(line)
        for table_id in dict.fromkeys(ids):
            if table_id in TABLES and tables:
                _print_table(table_id, out)
        then = "status" if failed else "report"
        typer.echo(f"next:   kswarms {then} {shlex.quote(str(out))}  ({_NEXT[then]})")
    return 1 if failed else 0


def _play(
    scenarios: Sequence[Scenario],
    first_seed: int,
    jobs: int,
    scheduler: str | None,
    records: Sequence[str],
    out: Path,
    progress: str,
    command: str,
) -> tuple[list[Path], int]:
    """Play what is not played yet; return the tables written and how many runs failed."""
    from kswarms.scenarios.study.study import Study

    failed = 0
    with ExitStack() as stack:
        executor = None
        if scheduler is not None:
            from kswarms.scenarios.runs.dask import dask_executor

            executor, jobs = stack.enter_context(dask_executor(scheduler))
        study = stack.enter_context(Study(out, command))
        runs = study.plan(scenarios, first_seed, records)
        for code in study.other_code:
            typer.echo(
                f"kswarms: {out} keeps runs of other code, {code}; to play them anew, name another --out",
                err=True,
            )
        try:
            with closing(study.play(runs, jobs, records, executor)) as played:
                for count in told(played, runs, progress):
                    failed = count.failed
        except KeyboardInterrupt:
            typer.echo(f"kswarms: {out} keeps what was played; the same command goes on", err=True)
            raise
    if failed:
        typer.echo(
            f"kswarms: {failed} of {len(runs)} runs failed; see `kswarms status {shlex.quote(str(out))}`",
            err=True,
        )
    return study.tables, failed


def _print_table(table_id: str, out: Path) -> None:
    from kswarms.analysis.results.runs import read_policies
    from kswarms.analysis.tables.learned import learned, printed

    title, scenarios = TABLES[table_id]
    text = printed(learned(read_policies(out), scenarios))
    print_table(f"{table_id}: {title}", text.header, text.rows, text.caption)
