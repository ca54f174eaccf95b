"""Cached machine code that is older than the sources is deleted, wherever numba caches it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_machine_code_older_than_the_sources_is_deleted_on_import(tmp_path: Path) -> None:
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}

    def cached_after_import() -> dict[Path, float]:
        code = "import kswarms.agents.robot.sensing"
        subprocess.run([sys.executable, "-c", code], env=environment, check=True)
        return {path: path.stat().st_mtime for path in tmp_path.rglob("*.nb[ic]")}

    first = cached_after_import()
    assert first
    assert cached_after_import() == first
    for path in first:
        os.utime(path, (1, 1))
    again = cached_after_import()
    assert set(again) == set(first)
    assert min(again.values()) > 1
