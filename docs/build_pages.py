"""A hook of mkdocs: makes the pages that are not written by hand, and refuses a page that needs the network.

The reference has a page for each package, with every public module that is in it. A notebook, kept as text by
jupytext, is executed in a process of its own, and its page shows what came out; if it fails, the build does.
"""

import base64
import re
from pathlib import Path
from typing import Any, Final

import jupytext
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

ROOT: Final = Path(__file__).parent.parent
PACKAGES: Final = ("agents", "model", "scenarios", "analysis")
SECONDS: Final = 300
"""What a cell may take; it takes a few, but a shared machine may be slow."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made here."""
    for package in PACKAGES:
        files.append(File.generated(config, f"reference/{package}.md", content=reference(package)))
    for path in sorted((ROOT / "docs" / "notebooks").glob("*.py")):
        page, pictures = notebook(path)
        files.append(File.generated(config, f"notebooks/{path.stem}.md", content=page))
        for name, content in pictures.items():
            files.append(File.generated(config, f"notebooks/{name}", content=content))
    return files


def on_post_page(output: str, **_: Any) -> str:
    """Refuse a page that would load something from another host."""
    outside = re.search(r'<(?:script|img|iframe|link)[^>]+(?:src|href)="(?:https?:)?//[^"]+', output)
    if outside:
        raise PluginError(f"a page loads from another host: {outside.group()}")
    return output


def reference(package: str) -> str:
    """Return the page of a package: what it says of itself, then each public module."""
    names = []
    for path in sorted((ROOT / package).rglob("*.py")):
        parts = ("kswarms", *path.relative_to(ROOT).with_suffix("").parts)
        if path.name == "__init__.py":
            parts = parts[:-1]
        if not any(part.startswith("_") for part in parts):
            names.append(".".join(parts))
    return "\n\n".join([f"# kswarms.{package}", *(f"::: {name}" for name in names)])


def notebook(path: Path) -> tuple[str, dict[str, bytes]]:
    """Execute a notebook; return its page, and its pictures by their names."""
    content = jupytext.read(path)
    where = {"metadata": {"path": path.parent}}  # as Jupyter does
    quiet = ["--log-level=ERROR"]  # it warns that its port, which is of this machine alone, is not encrypted
    client = NotebookClient(content, timeout=SECONDS, resources=where, extra_arguments=quiet)
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
        parts += [_shown(output, path.stem, pictures) for output in cell.outputs]
    parts.append(f"*The notebook `docs/notebooks/{path.name}`, as it ran; jupytext opens it in Jupyter.*")
    return "\n\n".join(parts), pictures


def _shown(output: Any, stem: str, pictures: dict[str, bytes]) -> str:
    if output.output_type == "stream":
        return f"```text\n{output.text}\n```"
    data = output.data
    if "image/png" in data:
        name = f"{stem}-{len(pictures) + 1}.png"
        pictures[name] = base64.b64decode(data["image/png"])
        return f"![What the cell drew]({name})"
    if "text/html" in data:
        # Without what pandas says of its look, the theme's own style applies to a table.
        return re.sub(r'(?s)<style.*?</style>| border="1" class="dataframe"', "", data["text/html"])
    return f"```text\n{data['text/plain']}\n```"
