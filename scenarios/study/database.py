"""The SQLite file of a ledger: its tables, its format and its errors."""

import sqlite3
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import InputError

LEDGER_FILE: Final = "ledger.sqlite"
"""Name of the file in the directory of a study."""
_FORMAT: Final = 2  # increment it with every incompatible change of the tables
_READABLE: Final = {1: "CREATE TEMP VIEW runs AS SELECT *, NULL AS environment FROM main.runs"}
"""Earlier formats that can be read, each with a statement that adds what it lacks."""
_APPLICATION: Final = 0x6B73776D  # "kswm" identifies ledgers among SQLite files
_TABLES: Final = f"""
PRAGMA application_id = {_APPLICATION};
PRAGMA user_version = {_FORMAT};
CREATE TABLE IF NOT EXISTS games (id INTEGER PRIMARY KEY, description TEXT NOT NULL UNIQUE);
CREATE TABLE IF NOT EXISTS runs (
    run TEXT PRIMARY KEY, game INTEGER NOT NULL REFERENCES games, seed INTEGER NOT NULL,
    version TEXT NOT NULL, status TEXT NOT NULL DEFAULT 'missing', code TEXT, environment TEXT, seconds REAL,
    swarms TEXT, policies TEXT, error TEXT, traceback TEXT
);
CREATE TABLE IF NOT EXISTS scenarios (id TEXT PRIMARY KEY, toml TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS curves (
    scenario TEXT, condition TEXT, description TEXT NOT NULL, PRIMARY KEY (scenario, condition)
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS points (
    scenario TEXT, condition TEXT, n INTEGER, seed INTEGER, run TEXT NOT NULL REFERENCES runs,
    PRIMARY KEY (scenario, condition, n, seed)
) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS points_of_run ON points (run);
CREATE TABLE IF NOT EXISTS records (
    run TEXT REFERENCES runs, name TEXT, rows BLOB NOT NULL, PRIMARY KEY (run, name)
);
CREATE TABLE IF NOT EXISTS sessions (id INTEGER PRIMARY KEY, about TEXT NOT NULL);
"""


def create_database(path: Path) -> None:
    """Create the file of a ledger if it is missing or empty, and check its format."""
    open_database(path, create=True).close()


def open_database(path: Path, create: bool) -> sqlite3.Connection:
    """Open the file of a ledger and check its format. With `create`, a missing file is created."""
    if not create and not path.is_file():
        raise InputError("results", str(path.parent), f"must be a directory with a {LEDGER_FILE} of kswarms")
    with os_errors(path):
        db = sqlite3.connect(path)
        try:
            _prepare(db, create)
        except sqlite3.Error as error:
            db.close()
            if isinstance(error, sqlite3.OperationalError):
                raise
            raise InputError("results", str(path), f"must be a ledger of kswarms ({error})") from error
    return db


def _prepare(db: sqlite3.Connection, create: bool) -> None:
    """Check the format of a file. With `create`, an empty file gets the tables."""
    ((application,),) = db.execute("PRAGMA application_id")
    ((form,),) = db.execute("PRAGMA user_version")
    empty = not db.execute("SELECT 1 FROM sqlite_master").fetchone()
    if not (empty and create) and application != _APPLICATION:
        raise sqlite3.DatabaseError("of another program")
    if application and form != _FORMAT:
        if form not in _READABLE:
            raise sqlite3.DatabaseError(f"format {form}, not {_FORMAT}")
        if create:
            reason = f"format {form} of an earlier version can be read, not resumed; use another directory"
            raise sqlite3.DatabaseError(reason)
        db.execute(_READABLE[form])
    if create:
        db.execute("PRAGMA journal_mode = WAL")
        db.execute("PRAGMA synchronous = NORMAL")
    if empty:
        db.executescript(f"BEGIN IMMEDIATE; {_TABLES} COMMIT")


@contextmanager
def os_errors(path: Path) -> Generator[None, None, None]:
    """Re-raise errors of SQLite as `OSError`, like errors of other files."""
    try:
        yield
    except sqlite3.Error as error:
        raise OSError(f"{path}: {error}") from error
