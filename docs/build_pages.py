"""Hook of mkdocs: generate the reference and notebook pages; refuse pages that need the network.

The reference has one page for each package and one for the columns of the tables. The page "What came out"
gets its tables and figures from the files in ``docs/study``. Notebooks are kept as text (jupytext). Each is
executed in its own process, and its page shows the output. If a notebook fails, the build fails.
"""

import base64
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Final

import jupytext
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

from kswarms.agents.common.columns import SCHEMA_VERSION, data_dictionary
from kswarms.analysis.report.published_page import study_page

ROOT: Final = Path(__file__).parent.parent
PACKAGES: Final = ("agents", "model", "scenarios", "analysis")
CELL_TIMEOUT: Final = 300
"""Seconds; a cell needs a few, but the machine may be busy."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages."""
    for package in PACKAGES:
        files.append(File.generated(config, f"reference/{package}.md", content=reference(package)))
    files.append(File.generated(config, "reference/columns.md", content=columns()))
    paths = sorted((ROOT / "docs" / "notebooks").glob("*.py"))
    with ThreadPoolExecutor(max_workers=2) as threads:  # each notebook has its own process
        notebooks = list(threads.map(notebook, paths))
    for path, (page, pictures) in zip(paths, notebooks, strict=True):
        files.append(File.generated(config, f"notebooks/{path.stem}.md", content=page))
        for name, content in pictures.items():
            files.append(File.generated(config, f"notebooks/{name}", content=content))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Add the tables and figures of the published study to its page."""
    if page.file.src_uri != "what_came_out.md":
        return markdown
    return f"{markdown}\n{study_page(ROOT / 'docs' / 'study', 'study')}"


def on_post_page(output: str, **_: Any) -> str:
    """Refuse a page that would load something from another host."""
    outside = re.search(r'<(?:script|img|iframe|link)[^>]+(?:src|href)="(?:https?:)?//[^"]+', output)
    if outside:
        raise PluginError(f"a page loads from another host: {outside.group()}")
    return output


def reference(package: str) -> str:
    """Return the page of a package: its docstring, then each public module."""
    names = []
    for path in sorted((ROOT / package).rglob("*.py")):
        parts = ("kswarms", *path.relative_to(ROOT).with_suffix("").parts)
        if path.name == "__init__.py":
            parts = parts[:-1]
        if not any(part.startswith("_") for part in parts):
            names.append(".".join(parts))
    return "\n\n".join([f"# kswarms.{package}", *(f"::: {name}" for name in names)])


def columns() -> str:
    """Return the page of the columns of all tables."""
    return f"""# Columns of the tables

Tables in a results directory are Parquet files. Robots are numbered from 0, S1's first. Swarms are numbered
from 1. The metadata of each file holds the version of its columns as `kswarms_schema`, now {SCHEMA_VERSION}.
Files of kswarms 0.1.0 hold no version.

The fields of a [grid](../scenarios.md#a-grid-of-values) are further columns of `runs.parquet` and
`policies.parquet`, after `n` and `seed`. They are named by the field, for example `side`. If a column has
that name already, they begin with `grid.`, for example `grid.duration`.

A table that is read is checked: numbers are finite and at most 2⁵³ in magnitude, texts are one line of at
most 10,000 characters, no value is missing unless it is allowed, and the values of the key identify a row.
Integers may be stored as reals, and texts as categories.

{data_dictionary()}"""


def notebook(path: Path) -> tuple[str, dict[str, bytes]]:
    """Execute a notebook; return its page, and its pictures by name."""
    content = jupytext.read(path)
    where = {"metadata": {"path": path.parent}}  # the working directory, as in Jupyter
    quiet = ["--log-level=ERROR"]  # else it warns that its local port is not encrypted
    client = NotebookClient(content, timeout=CELL_TIMEOUT, resources=where, extra_arguments=quiet)
    try:
        client.execute()
    except CellExecutionError as error:
        raise PluginError(f"{path.name} fails: {error.ename}: {error.evalue}") from None
    parts: list[str] = []
    pictures: dict[str, bytes] = {}
    for cell in content.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        parts += [_format_output(output, path.stem, pictures) for output in cell.outputs]
    parts.append(f"*The executed notebook `docs/notebooks/{path.name}`; jupytext opens it in Jupyter.*")
    return "\n\n".join(parts), pictures


def _format_output(output: Any, stem: str, pictures: dict[str, bytes]) -> str:
    if output.output_type == "stream":
        return f"```text\n{output.text}\n```"
    data = output.data
    if "image/png" in data:
        name = f"{stem}-{len(pictures) + 1}.png"
        pictures[name] = base64.b64decode(data["image/png"])
        return f"![Output of the cell]({name})"
    if "text/html" in data:
        # Drop the style of pandas, so that the theme's style applies.
        return re.sub(r'(?s)<style.*?</style>| border="1" class="dataframe"', "", data["text/html"])
    return f"```text\n{data['text/plain']}\n```"
