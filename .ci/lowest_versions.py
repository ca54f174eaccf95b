"""The lowest versions that pyproject.toml allows."""

import re
import tomllib
from pathlib import Path


def pins(root: Path) -> list[str]:
    """Return the lowest versions of the libraries of kswarms and its extra `all`, as constraints for pip."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    found = (
        re.match(r"([\w-]+)(?:\[\w+\])?>=([\d.]+)", requirement)
        for requirement in [*project["dependencies"], *extras["cluster"], *extras["explore"]]
    )
    return [f"{lower[1]}=={lower[2]}" for lower in found if lower]
