"""Parts of the report about provenance: files, manifest and versions of libraries."""

import hashlib
import json
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import pandas as pd

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_input_file
from kswarms.agents.common.limits import MAX_JSON_FILE
from kswarms.analysis.report.page import Part
from kswarms.analysis.results.tables import count_rows
from kswarms.analysis.text_tables import TextTable

MANIFEST_FILE: Final = "manifest.json"
_LIBRARIES: Final = ("kswarms", "matplotlib", "networkx", "numpy", "pandas", "pyarrow", "scipy", "seaborn")
_MIXED: Final = (
    "The runs were played by different versions of Python, numpy or numba, or on different machines. "
    "Equal runs may differ in their last digits."
)


def libraries_part() -> Part:
    """Return the part with the versions of Python and the libraries that made the report."""
    made_with = ", ".join(f"{name} {version(name)}" for name in _LIBRARIES)
    return Part("made-with", "This report", [f"Made with {made_with}, Python {platform.python_version()}."])


def directory_parts(directory: Path) -> list[Part]:
    """Return parts for the files of a results directory and its manifest; `InputError` if unreadable."""
    tables = sorted(path for path in directory.glob("*.parquet") if path.is_file())
    described = [_describe(path) for path in tables]
    rows = [[each["file"], str(each["rows"]), str(each["bytes"]), each["sha256"][:16]] for each in described]
    files = Part("files", "Files")
    header = ["file", "rows", "bytes", "SHA-256, first 16 digits"]
    table = TextTable(header, rows, "")
    files.add_table("files", "Files of the results directory", table, pd.DataFrame(described))
    manifest = directory / MANIFEST_FILE
    if not manifest.exists():
        text = f"The directory has no {MANIFEST_FILE}: versions and commands of the runs are unknown."
        return [files, Part("manifest", "Manifest", [text])]
    return [files, *_manifest_parts(_read_manifest(manifest))]


def _describe(path: Path) -> dict[str, Any]:
    rows = count_rows(path)
    with path.open("rb") as content:
        digest = hashlib.file_digest(content, "sha256").hexdigest()
    return {"file": path.name, "rows": rows, "bytes": path.stat().st_size, "sha256": digest}


def _read_manifest(path: Path) -> dict[str, Any]:
    try:  # not `read_json`, which refuses the lone surrogates of a command line that is not UTF-8
        content = json.loads(read_input_file("results", path, MAX_JSON_FILE).decode())
    except RecursionError as error:
        raise InputError("results", str(path), "must be a JSON file (too deep)") from error
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise InputError("results", str(path), f"must be a JSON file ({error})") from error
    if not isinstance(content, dict):
        raise InputError("results", str(path), "must be a JSON object")
    return content


def _manifest_parts(content: dict[str, Any]) -> list[Part]:
    """Return one part with all short entries, and a part for each long entry, such as the scenarios."""
    long = {key: value for key, value in content.items() if isinstance(value, dict | list) and value}
    lines = "\n".join(f"{key}: {value}" for key, value in content.items() if key not in long)
    parts = [Part("manifest", f"Manifest ({MANIFEST_FILE})", preformatted=lines)]
    for key, value in long.items():
        texts = [_MIXED] if key == "environments" and len(value) > 1 else []
        parts.append(Part(f"manifest-{key}", f"Manifest: {key}", texts, preformatted=_entry_text(value)))
    return parts


def _entry_text(value: Any) -> str:
    if not isinstance(value, dict) or not all(isinstance(text, str) for text in value.values()):
        return json.dumps(value, indent=2, ensure_ascii=False)
    if any("\n" in text for text in value.values()):
        return "\n\n".join(f"# {key}\n{text.strip()}" for key, text in value.items())
    return "\n".join(f"{key}: {text}" for key, text in value.items())
