"""``run``: play scenarios, write tables of their results and draw figures."""

import re
import shlex
from pathlib import Path
from typing import Annotated

import typer

from kswarms.agents.common.columns import RECORDED_TABLES
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.quoting import for_shell
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selection import select_scenarios, with_densities_and_seeds
from kswarms.scenarios.cli.options import (
    CPUS,
    AllowMixed,
    FirstSeed,
    Jobs,
    Progress,
    RunLimit,
    complete_ids,
    parse_path,
)
from kswarms.scenarios.cli.printing import print_line, print_table, warn
from kswarms.scenarios.description.text import parse_integers, split_words
from kswarms.scenarios.runs.run import Order, expand, select_shard


def run(
    context: typer.Context,
    ids: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ID",
            help="Scenarios or tables of `kswarms list`, or my.toml.",
            autocompletion=complete_ids,
        ),
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Play all scenarios, each at the --densities that it allows.")
    ] = False,
    densities: Annotated[
        str | None,
        typer.Option(
            metavar="N,N,...",
            help="Numbers of robots, multiples of the sum of the shares. [default: the scenario's]",
        ),
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(help="Games for each density. [default: the scenario's]")
    ] = None,
    first_seed: FirstSeed = 0,
    jobs: Jobs = CPUS,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS", help="Dask scheduler that plays the runs, for example tcp://host:8786."
        ),
    ] = None,
    out: Annotated[
        Path,
        typer.Option(
            parser=parse_path, metavar="DIR", help="Results directory; a study in it is resumed."
        ),
    ] = Path("results"),
    run_limit: RunLimit = None,
    record: Annotated[
        str, typer.Option(metavar="NAME,...", help=f"Additional tables: {', '.join(RECORDED_TABLES)}.")
    ] = "",
    order: Annotated[
        Order, typer.Option(help="Play the longest runs first, or all runs of the first seed.")
    ] = "longest",
    shard: Annotated[
        str, typer.Option(metavar="K/M", help="Play part K of M parts, each into its own DIR: see `merge`.")
    ] = "1/1",
    allow_mixed: AllowMixed = False,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Do not draw figures.")] = False,
    progress: Progress = "bar",
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> int:
    """Play scenarios, write tables of their results and draw a figure of each.

    The same command resumes an interrupted study: it plays only the runs that DIR lacks.

    Example: kswarms run fig-6.1a fig-6.1c --densities 6,30,50 --seeds 5
    """
    ids = ids or []
    if bool(ids) == everything:
        raise InputError("id", " ".join(ids), "must be one or more of `kswarms list`, or none with --all")
    scenarios, left_out = with_densities_and_seeds(
        select_scenarios(ids or CATALOGUE),
        parse_integers("densities", densities),
        seeds,
        suitable_only=everything,
    )
    records = split_words(record)
    for name in records:
        if name not in RECORDED_TABLES:
            raise InputError("record", name, f"must be among {', '.join(RECORDED_TABLES)}")
    if run_limit is not None and scheduler is not None:
        raise InputError("run_limit", run_limit, "must not be given with --scheduler")
    if left_out:
        warn(f"left out, since no density suits them: {', '.join(left_out)}")

    from kswarms.scenarios.cli.playing import Plan, play_study
    from kswarms.scenarios.cli.space import describe_trajectories

    part = _parse_shard(shard)
    plan = Plan(
        scenarios, first_seed, part, records, order, jobs, scheduler, run_limit, allow_mixed
    )
    if "trajectory" in records:
        runs = select_shard(expand(scenarios, first_seed), *part)
        size = describe_trajectories(out, runs, records)
        if not quiet:
            warn(size)
    command = shlex.join(context.obj)
    tables, failed = play_study(out, plan, command, "none" if quiet else progress)
    lines = [f"table:  {table}" for table in tables]
    if tables and not no_figures:
        from kswarms.analysis.figures.over_n import write_figures

        titles = {scenario.id: scenario.title for scenario in scenarios}
        lines += [f"figure: {path}" for path in write_figures(out, out / "figures", list(titles), titles)]
    if not quiet:
        for line in lines:
            print_line(line)
        for table_id in dict.fromkeys(ids):
            if table_id in TABLES and tables:
                _print_table(table_id, out)
        directory = for_shell(str(out))
        if failed:
            print_line(f"next:   kswarms status {directory}  (failed runs, and how to replay them)")
        else:
            print_line(f"next:   kswarms report {directory}  (all results in one HTML file)")
    return 1 if failed else 0


def _parse_shard(text: str) -> tuple[int, int]:
    """Return number of a part and number of parts."""
    if match := re.fullmatch(r"(\d{1,6})/(\d{1,6})", text, re.ASCII):
        part, parts = int(match[1]), int(match[2])
        if 1 <= part <= parts:
            return part, parts
    raise InputError("shard", text, "must be K/M, part K of M parts, such as 3/16")


def _print_table(table_id: str, out: Path) -> None:
    from kswarms.analysis.measures.learned import learned_shares
    from kswarms.analysis.results.runs import read_policies
    from kswarms.analysis.tables.learned import learned_table

    title, scenarios = TABLES[table_id]
    text = learned_table(learned_shares(read_policies(out), scenarios))
    print_table(f"{table_id}: {title}", text.header, text.rows, text.caption)
