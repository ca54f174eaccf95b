"""The SQLite file of a ledger: its tables, its form, and errors as those of any other file."""

import json
import sqlite3
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, Self

from kswarms.agents.common.errors import InputError

FILE: Final = "ledger.sqlite"
"""Name of the file in the directory of a study."""

_FORMAT: Final = 1  # raise it with every change of these tables or of the columns of results
_APPLICATION: Final = 0x6B73776D  # "kswm": by it a ledger is told from other SQLite files
_TABLES: Final = """
CREATE TABLE games (id INTEGER PRIMARY KEY, description TEXT NOT NULL UNIQUE);
CREATE TABLE runs (
    run TEXT PRIMARY KEY, game INTEGER NOT NULL REFERENCES games, seed INTEGER NOT NULL,
    version TEXT NOT NULL, status TEXT NOT NULL DEFAULT 'missing', code TEXT, seconds REAL,
    swarms TEXT, policies TEXT, error TEXT, traceback TEXT, replay TEXT
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
    """The open file of a ledger.

    Parameters
    ----------
    path : Path
        The file.
    new : bool
        Whether to make it if there is none.

    Raises
    ------
    InputError
        If there is no ledger of this form.
    OSError
        From every method: if the file cannot be read or written; what was committed stays.
    """

    def __init__(self, path: Path, new: bool = False) -> None:
        self.path = path
        if not new and not path.is_file():
            raise InputError("results", str(path.parent), f"must be a directory with a {FILE} of kswarms")
        with _as_os_error(path):
            self._db = sqlite3.connect(path)
            try:
                self._open(new)
            except sqlite3.Error as error:
                self._db.close()
                if isinstance(error, sqlite3.OperationalError):
                    raise
                reason = f"must be a ledger of kswarms ({error})"
                raise InputError("results", str(path), reason) from error

    def _open(self, new: bool) -> None:
        application, form = (
            self._db.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")
        )
        empty = not self._db.execute("SELECT 1 FROM sqlite_master").fetchone()
        if not (empty and new) and (application, form) != (_APPLICATION, _FORMAT):
            raise sqlite3.DatabaseError(
                f"form {form} where {_FORMAT} is known" if application else "it is not"
            )
        if new:
            self._db.execute("PRAGMA journal_mode = WAL")
            self._db.execute("PRAGMA synchronous = NORMAL")
        if empty:
            self._db.executescript(
                f"BEGIN; {_TABLES} PRAGMA application_id = {_APPLICATION};"
                f" PRAGMA user_version = {_FORMAT}; COMMIT;"
            )

    def close(self) -> None:
        """Close the file."""
        self._db.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    @contextmanager
    def _transaction(self) -> Generator[None, None, None]:
        with _as_os_error(self.path), self._db:
            yield

    def query(self, sql: str, *values: object) -> Iterator[Any]:
        """Yield the rows that an SQL query finds."""
        with _as_os_error(self.path):
            for row in self._db.execute(sql, values):  # noqa: UP028  # `yield from` closes it, maybe too late
                yield row

    def _parsed(self, text: str) -> Any:
        try:
            return json.loads(text)
        except ValueError as error:
            raise OSError(f"{self.path}: is damaged ({error})") from error


@contextmanager
def _as_os_error(path: Path) -> Generator[None, None, None]:
    try:
        yield
    except sqlite3.Error as error:
        raise OSError(f"{path}: {error}") from error
