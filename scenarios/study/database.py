"""The SQLite file of a ledger: its tables and its format."""

import json
import sqlite3
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, Self

from kswarms.agents.common.errors import InputError

LEDGER_FILE: Final = "ledger.sqlite"
"""Name of the file in the directory of a study."""

_FORMAT: Final = 1  # raise it with every incompatible change of the tables
_APPLICATION: Final = 0x6B73776D  # "kswm" identifies ledgers among SQLite files
_TABLES: Final = """
CREATE TABLE games (id INTEGER PRIMARY KEY, description TEXT NOT NULL UNIQUE);
CREATE TABLE runs (
    run TEXT PRIMARY KEY, game INTEGER NOT NULL REFERENCES games, seed INTEGER NOT NULL,
    version TEXT NOT NULL, status TEXT NOT NULL DEFAULT 'missing', code TEXT, seconds REAL,
    swarms TEXT, policies TEXT, error TEXT, traceback TEXT
);
CREATE TABLE scenarios (id TEXT PRIMARY KEY, toml TEXT NOT NULL);
CREATE TABLE curves (
    scenario TEXT, condition TEXT, description TEXT NOT NULL, PRIMARY KEY (scenario, condition)
) WITHOUT ROWID;
CREATE TABLE points (
    scenario TEXT, condition TEXT, n INTEGER, seed INTEGER, run TEXT NOT NULL REFERENCES runs,
    PRIMARY KEY (scenario, condition, n, seed)
) WITHOUT ROWID;
CREATE INDEX points_of_run ON points (run);
CREATE TABLE records (run TEXT REFERENCES runs, name TEXT, rows BLOB NOT NULL, PRIMARY KEY (run, name));
CREATE TABLE sessions (id INTEGER PRIMARY KEY, about TEXT NOT NULL);
"""


class Database:
    """The open file of a ledger; created unless it exists if `new`. A context manager.

    Raises
    ------
    InputError
        If the file is not a ledger of this format.
    OSError
        From every method: if the file cannot be read or written. Committed data is kept.
    """

    def __init__(self, path: Path, new: bool = False) -> None:
        self.path = path
        if not new and not path.is_file():
            raise InputError(
                "results", str(path.parent), f"must be a directory with a {LEDGER_FILE} of kswarms"
            )
        with self._os_errors():
            self._db = sqlite3.connect(path)
            try:
                self._open(new)
            except sqlite3.OperationalError:
                self._db.close()
                raise
            except sqlite3.Error as error:
                self._db.close()
                reason = f"must be a ledger of kswarms ({error})"
                raise InputError("results", str(path), reason) from error

    def _open(self, new: bool) -> None:
        ((application,),) = self._db.execute("PRAGMA application_id")
        ((form,),) = self._db.execute("PRAGMA user_version")
        empty = not self._db.execute("SELECT 1 FROM sqlite_master").fetchone()
        if not (empty and new) and (application, form) != (_APPLICATION, _FORMAT):
            raise sqlite3.DatabaseError(f"format {form}, not {_FORMAT}" if application else "it is not")
        if new:
            self._db.execute("PRAGMA journal_mode = WAL")
            self._db.execute("PRAGMA synchronous = NORMAL")
        if empty:
            self._db.executescript(
                f"BEGIN; {_TABLES} PRAGMA application_id = {_APPLICATION};"
                f" PRAGMA user_version = {_FORMAT}; COMMIT;"
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._db.close()

    @contextmanager
    def _transaction(self) -> Generator[None, None, None]:
        with self._os_errors(), self._db:
            yield

    def query(self, sql: str, *values: object) -> Iterator[Any]:
        """Yield the rows of an SQL query."""
        with self._os_errors():
            for row in self._db.execute(sql, values):  # noqa: UP028  # `yield from` may close it too late
                yield row

    def _parse_json(self, text: str) -> Any:
        try:
            return json.loads(text)
        except ValueError as error:
            raise OSError(f"{self.path}: is damaged ({error})") from error

    @contextmanager
    def _os_errors(self) -> Generator[None, None, None]:
        """Raise errors of SQLite as `OSError`, like those of any other file."""
        try:
            yield
        except sqlite3.Error as error:
            raise OSError(f"{self.path}: {error}") from error
