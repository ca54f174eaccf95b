"""Files that are written from the ledger of a study: its tables and its manifest."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from kswarms import __version__
from kswarms.agents.common.atomic_files import TEMPORARY, remove_temporary_files
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.runs.run import code_version
from kswarms.scenarios.signals import deferred_signals
from kswarms.scenarios.study.database import LEDGER_FILE, create_database
from kswarms.scenarios.study.directory import make_directory, write_json
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.lock import LOCK_FILE, directory_lock
from kswarms.scenarios.study.parquet import STUDY_TABLES, export

MANIFEST: Final = "manifest.json"
"""Name of the file that describes the origin of the results."""
_TEMPORARY_TABLES: Final = f"{TEMPORARY}tables-"
"""Prefix of the temporary directory of the tables."""
_FILES: Final = (
    LOCK_FILE,
    MANIFEST,
    *(f"{name}.parquet" for name in STUDY_TABLES),
    *(f"{LEDGER_FILE}-{kind}" for kind in ("journal", "wal", "shm")),
)
_ENTROPY: Final = "numpy PCG64(SeedSequence(seed, spawn_key=(robot, purpose))), and nothing else"


@contextmanager
def locked_directory(directory: Path, command: str, create: bool) -> Iterator[None]:
    """Check the directory of a study, lock it and remove temporary files of killed processes.

    With `create`, a missing directory and a missing ledger are created.
    """
    ledger = directory / LEDGER_FILE
    if not create and not ledger.is_file():
        raise InputError("results", str(directory), f"must be a directory with a {LEDGER_FILE} of kswarms")
    make_directory(directory, LEDGER_FILE, _FILES)
    if create:
        # First the ledger: it tells directories of kswarms from others, also if this process is killed now.
        create_database(ledger)
    with directory_lock(directory, command):
        for path in directory.glob(f"{_TEMPORARY_TABLES}*"):
            shutil.rmtree(path, ignore_errors=True)
        remove_temporary_files(directory)
        yield


def write_tables(ledger: Ledger, directory: Path) -> list[Path]:
    """Write the tables of all finished runs; return their paths.

    If one of them cannot be written, or a signal arrives, no present table is replaced.
    """
    with TemporaryDirectory(dir=directory, prefix=_TEMPORARY_TABLES) as temporary:
        written = export(ledger, Path(temporary))
        with deferred_signals():
            return [path.replace(directory / path.name) for path in written]


def write_manifest(ledger: Ledger, directory: Path) -> None:
    """Write the manifest: the scenarios, the sessions, and the versions that played the runs."""
    sessions = ledger.sessions()
    last = sessions[-1] if sessions else {}
    content = {
        "kswarms": last.get("kswarms", __version__),
        "code": last.get("code", code_version()),
        "entropy": _ENTROPY,
        "environments": ledger.runs_by_environment(),
        "scenarios": ledger.scenarios(),
        "sessions": sessions,
    }
    write_json(directory / MANIFEST, content)


def export_study(directory: Path, command: str) -> list[Path]:
    """Write the tables and the manifest of a study from its ledger; return the paths of the tables.

    Parameters
    ----------
    command : str
        The command line, for the lock.

    Raises
    ------
    InputError
        If the directory has no ledger of kswarms, is not writable or in use.
    OSError
        If the ledger is damaged, or writing fails; no present table is replaced.
    """
    with locked_directory(directory, command, create=False), Ledger(directory / LEDGER_FILE) as ledger:
        tables = write_tables(ledger, directory)
        write_manifest(ledger, directory)
    return tables
