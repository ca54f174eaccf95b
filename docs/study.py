"""Publish a study: ``python docs/study.py results/all`` after ``kswarms run --all --out results/all``.

It writes the files in ``docs/study``, from which the page "What came out" is built, and the text between the
marks in the README and in the page of findings.
"""

import json
import re
import sys
from collections.abc import Callable
from datetime import datetime
from itertools import groupby
from pathlib import Path
from textwrap import fill
from typing import Any, Final

from kswarms.analysis.report.published_files import Published, publish
from kswarms.analysis.report.published_page import error_rows
from kswarms.analysis.results.runs import read_results
from kswarms.analysis.tables.findings import count_verdicts, findings_markdown
from kswarms.analysis.text_tables import span
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.outputs import MANIFEST

ROOT: Final = Path(__file__).parent.parent
FOLDER: Final = ROOT / "docs" / "study"
_WIDTH: Final = 125
"""Length of the lines of the README."""


def describe(results: Path) -> dict[str, Any]:
    """Return how a study was played, from its ledger and its manifest.

    Times are in seconds. ``wall_seconds`` is the sum over the sessions, and None if one of them was killed.
    """
    manifest = json.loads((results / MANIFEST).read_text(encoding="utf-8"))
    sessions = manifest["sessions"]
    with Ledger(results / LEDGER_FILE) as ledger:
        runs, seconds = ledger.runs_by_status()["done"]
        code = ledger.runs_by_code()
    ended = all("ended" in session for session in sessions)
    lengths = [_time(session["ended"]) - _time(session["started"]) for session in sessions] if ended else []
    return {
        "runs": runs,
        "first_seed": min(session.get("first_seed", 0) for session in sessions),
        "cpu_seconds": round(seconds),
        "wall_seconds": round(sum(length.total_seconds() for length in lengths)) if ended else None,
        "started": sessions[0]["started"],
        "cpus": max(session["machine"]["cpus"] for session in sessions),
        "code": list(code),
        "environments": list(manifest["environments"]),
        "commands": [_without_folders(session["command"]) for session in sessions],
    }


def claims(study: Published) -> str:
    """Return what the README says of a study, in Markdown."""
    verdicts = count_verdicts(study.findings).replace("Of", "of", 1)
    seeds = study.findings["seeds"]
    items = [
        f"- **The findings of chapter 6**: {verdicts} at {span(seeds.min(), seeds.max())} seeds "
        "([Findings](docs/findings.md#the-findings-of-the-thesis))."
    ]
    rows = error_rows(study)
    if rows:
        items.append(
            "- **The shares of robots that learned** an action are compared with the tables of the thesis. "
            "These are the mean absolute errors, in percentage points:"
        )
        items += [_table_claim(name, list(group)) for name, group in groupby(rows, key=lambda row: row[0])]
    if len(study.argos):
        fits = [f"{study.argos[name].sum()} of {len(study.argos)}" for name in ("score_fits", "share_fits")]
        items.append(
            f"- **The same games in the simulator ARGoS 3**: {fits[0]} scores and {fits[1]} shares of time "
            "in conflict agree ([Fidelity](docs/fidelity.md))."
        )
    return "\n".join(fill(item, _WIDTH, subsequent_indent="  ", break_on_hyphens=False) for item in items)


TEXTS: Final[dict[str, tuple[str, Callable[[Published], str]]]] = {
    "README.md": ("claims of the study", claims),
    "docs/findings.md": ("verdicts of the study", lambda study: findings_markdown(study.findings)),
}
"""Name of the mark, and the text after it, by file."""


def update(text: str, mark: str, content: str) -> str:
    """Return a text with `content` between ``<!-- mark -->`` and ``<!-- end -->``."""
    between = re.compile(rf"(?<=<!-- {mark} -->\n).*?(?=\n<!-- end -->)", re.DOTALL)
    if len(between.findall(text)) != 1:
        raise ValueError(f"the mark {mark!r} must be there once")
    return between.sub(lambda _: content, text)


def main(results: Path) -> None:
    """Write the files and the texts of a study."""
    titles = {name: scenario.title for name, scenario in CATALOGUE.items()}
    publish(read_results(results), FOLDER, titles, TABLES, describe(results))
    study = Published.read(FOLDER)
    for name, (mark, make) in TEXTS.items():
        path = ROOT / name
        path.write_text(update(path.read_text(encoding="utf-8"), mark, make(study)), encoding="utf-8")


def _table_claim(table: str, rows: list[tuple[str, str, int, float]]) -> str:
    """Return an item with the errors of a table: of all its cells, and of each of its columns."""
    *columns, (_, _, _, total) = rows
    by_column = ", ".join(f"{curve} {error:.1f}" for _, curve, _, error in columns)
    return f"  - Table {table.removeprefix('table-')}: {total:.1f}" + (f" ({by_column})" if columns else "")


def _without_folders(command: str) -> str:
    """Return a command line without the folder in which the results were."""
    return re.sub(r"(--out[ =])\S*/", r"\1", command)


def _time(text: str) -> datetime:
    return datetime.fromisoformat(text)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
