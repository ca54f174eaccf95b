"""Where results and report come from: manifest and files of the directory, versions of libraries."""

import hashlib
import json
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from kswarms.agents.common.errors import InputError
from kswarms.analysis.report.page import Part, Tabled
from kswarms.analysis.text_tables import PrintedTable

MANIFEST_FILE: Final = "manifest.json"
_LIBRARIES: Final = ("kswarms", "matplotlib", "networkx", "numpy", "pandas", "pyarrow", "scipy", "seaborn")


def provenance_parts(directory: Path) -> list[Part]:
    """Say what the results are, who wrote them and with what, as far as the directory tells.

    Raises
    ------
    InputError
        The manifest cannot be read.
    """
    files = [_file(path) for path in sorted(directory.glob("*.parquet"))]
    frame = pd.DataFrame(files)
    rows = [[file["file"], str(file["rows"]), str(file["bytes"]), file["sha256"][:16]] for file in files]
    table = PrintedTable(["file", "rows", "bytes", "SHA-256, first 16 digits"], rows, "")
    made_with = ", ".join(f"{name} {version(name)}" for name in _LIBRARIES)
    parts = [
        Part("files", "Files", tables=[Tabled("files", "Files of the results directory", table, frame)]),
        Part("made-with", "This report", [f"Made with {made_with}, Python {platform.python_version()}."]),
    ]
    manifest = directory / MANIFEST_FILE
    if not manifest.is_file():
        text = [f"The directory holds no {MANIFEST_FILE}: versions and commands of the runs are not known."]
        return [*parts, Part("manifest", "Manifest", text)]
    return [*parts, *_manifest_parts(_read(manifest))]


def _file(path: Path) -> dict[str, Any]:
    try:
        rows = pq.read_metadata(path).num_rows
    except (OSError, pa.ArrowException) as error:
        raise InputError("results", str(path), "must be a readable Parquet file") from error
    with path.open("rb") as content:
        digest = hashlib.file_digest(content, "sha256").hexdigest()
    return {"file": path.name, "rows": rows, "bytes": path.stat().st_size, "sha256": digest}


def _read(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError("results", str(path), "must be readable JSON") from error
    if not isinstance(content, dict):
        raise InputError("results", str(path), "must be a JSON object")
    return content


def _manifest_parts(content: dict[str, Any]) -> list[Part]:
    """Return short entries as one text, and each that has lines of its own, as scenarios have, as a part."""
    long = {key: value for key, value in content.items() if isinstance(value, dict | list) and value}
    short = {key: value for key, value in content.items() if key not in long}
    lines = "\n".join(f"{key}: {value}" for key, value in short.items())
    parts = [Part("manifest", f"Manifest ({MANIFEST_FILE})", source=lines)]
    for key, value in long.items():
        parts.append(Part(f"manifest-{key}", f"Manifest: {key}", source=_text(value)))
    return parts


def _text(value: Any) -> str:
    if isinstance(value, dict) and all(isinstance(text, str) for text in value.values()):
        several_lines = any("\n" in text for text in value.values())
        return ("\n\n" if several_lines else "\n").join(
            f"# {key}\n{text.strip()}" if several_lines else f"{key}: {text}" for key, text in value.items()
        )
    return json.dumps(value, indent=2, ensure_ascii=False)
