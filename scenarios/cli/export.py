"""``export`` and ``merge``: tables of a study from its ledger, and one study of several."""

import shlex
from pathlib import Path
from typing import Annotated

import typer

from kswarms.agents.common.quoting import for_shell
from kswarms.scenarios.cli.options import AllowMixed, parse_path
from kswarms.scenarios.cli.printing import print_line


def export(
    context: typer.Context,
    directory: Annotated[
        Path, typer.Argument(parser=parse_path, metavar="DIR", help="Results directory of `kswarms run`.")
    ],
) -> None:
    """Write the tables and the manifest of the finished runs of a study, without playing.

    Use it after a study was killed, or if its tables were lost.

    Example: kswarms export results
    """
    from kswarms.scenarios.study.outputs import export_study

    for table in export_study(directory, shlex.join(context.obj)):
        print_line(f"table:  {table}")


def merge(
    context: typer.Context,
    out: Annotated[
        Path, typer.Argument(parser=parse_path, metavar="OUT", help="Results directory that gets all runs.")
    ],
    directories: Annotated[
        list[Path],
        typer.Argument(parser=parse_path, metavar="DIR...", help="Results directories; they are only read."),
    ],
    allow_mixed: AllowMixed = False,
) -> None:
    """Merge studies, such as the shards of a sweep, into a new or existing study, and write its tables.

    Example: kswarms merge results shard-1 shard-2 shard-3
    """
    from kswarms.scenarios.study.merge import merge_studies

    for table in merge_studies(out, directories, shlex.join(context.obj), allow_mixed):
        print_line(f"table:  {table}")
    print_line(f"next:   kswarms report {for_shell(str(out))}  (all results in one HTML file)")
