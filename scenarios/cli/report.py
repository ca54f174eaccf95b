"""``report``: one HTML file about a results directory."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, TypeVar

import typer

from kswarms.agents.common.atomic_files import check_output
from kswarms.agents.common.errors import InputError
from kswarms.model.description.arena import Arena
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.cli.options import parse_path
from kswarms.scenarios.cli.printing import print_line
from kswarms.scenarios.cli.progress import track

_Step = TypeVar("_Step")


def report(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="Results directory of `kswarms run`.")],
    out: Annotated[
        Path | None,
        typer.Option(parser=parse_path, metavar="FILE", help="The report. [default: DIR/report.html]"),
    ] = None,
    files: Annotated[
        Path | None,
        typer.Option(
            parser=parse_path,
            metavar="DIR",
            help="Also write figures (PNG, SVG) and tables (CSV, Markdown, HTML).",
        ),
    ] = None,
    findings: Annotated[
        Path | None,
        typer.Option(
            parser=parse_path,
            metavar="TOML",
            help="User-defined findings to judge besides those of the thesis.",
        ),
    ] = None,
) -> None:
    """Write figures, tables and verdicts of all results into one HTML file, readable offline.

    Example: kswarms report results --out report.html
    """
    from kswarms.analysis.findings import FINDINGS, read_findings
    from kswarms.analysis.report import PlannedScenario, build_report, check_folder

    path = out or directory / "report.html"
    if out is not None or directory.is_dir():
        check_output(path, "out")
    if files is not None:
        check_folder(files)
    own = read_findings(findings) if findings is not None else ()
    for finding in own:
        if finding.id in {each.id for each in FINDINGS}:
            raise InputError("findings.id", finding.id, "must differ from those of the thesis")
    plan = {
        name: PlannedScenario(each.title, tuple(c.name for c in each.conditions), each.densities, each.seeds)
        for name, each in CATALOGUE.items()
    }
    built = build_report(
        directory, plan, TABLES, findings=(*FINDINGS, *own), arena_of=_arena, progress=_progress
    )
    if files is not None:
        print_line(f"files:  {files} ({built.write_files(files)} files)")
    built.write_page(path)
    print_line(f"report: {path} ({path.stat().st_size / 1e6:.1f} MB)")


def _arena(scenario: str, condition: str, n: int, seed: int) -> Arena | None:
    """Return the arena of a game of the catalogue, None for other games."""
    try:
        return CATALOGUE[scenario].game(condition, n).arena(seed)
    except (KeyError, InputError):
        return None


def _progress(steps: Sequence[_Step]) -> Iterable[_Step]:
    return track(steps, "reporting", len(steps))
