"""The SQLite file of a ledger: its tables, its format and its errors."""

import os
import secrets
import sqlite3
from collections.abc import Callable, Generator
from contextlib import closing, contextmanager, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any, Final, Literal, Self, TypeVar
from urllib.parse import quote

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.file_systems import network_file_system

_Connection = TypeVar("_Connection", bound=sqlite3.Connection)

LEDGER_FILE: Final = "ledger.sqlite"
"""Name of the file in the directory of a study."""
_FORMAT: Final = 2  # increment it with every incompatible change of the tables
_READABLE: Final = {1: "CREATE TEMP VIEW runs AS SELECT *, NULL AS environment FROM main.runs"}
"""Earlier formats that can be read, each with a statement that adds what it lacks."""
_APPLICATION: Final = 0x6B73776D  # "kswm" identifies ledgers among SQLite files
_HEADER_SIZE: Final = 100  # bytes at the start of a file of SQLite, with its change counter and size
_LONGEST_CPU_TIME: Final = 1e12  # s
_LONGEST_NAME: Final = 300  # characters of a version, a digest of code, an environment
_DAMAGE: Final[tuple[type[Exception], ...]] = (
    ArithmeticError, AttributeError, LookupError, MemoryError, RuntimeError, TypeError, ValueError
)  # fmt: skip
"""Errors that unexpected content raises, such as `UnicodeError` and `RecursionError`."""
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
    with os_errors(path):
        _open(path, partial(sqlite3.connect, path), create=True).close()


def open_database(path: Path, create: bool) -> sqlite3.Connection:
    """Open the file of a ledger and check its format.

    With `create`, a missing file is created. Without, the ledger can only be read, which needs no right to
    write.
    """
    if not create and not path.is_file():
        raise InputError("results", str(path.parent), f"must be a directory with a {LEDGER_FILE} of kswarms")
    with os_errors(path):
        if not create:
            return _open_to_read(path)
        db = _open(path, lambda: sqlite3.connect(path, factory=_Writer), create)
        db.start(path)
        return db


def _open(path: Path, connect: Callable[[], _Connection], create: bool) -> _Connection:
    db = connect()
    try:
        _prepare(db, create)
    except sqlite3.Error as error:
        db.close()
        if isinstance(error, sqlite3.OperationalError):
            raise
        raise InputError("results", str(path), f"must be a ledger of kswarms ({error})") from error
    return db


def _open_to_read(path: Path) -> sqlite3.Connection:
    name = f"file://{quote(os.fsencode(path.absolute()))}"
    if _is_idle_log(path):  # in the other modes, SQLite would create files beside the ledger
        return _open(path, partial(sqlite3.connect, f"{name}?immutable=1", uri=True), create=False)
    try:
        return _open(path, partial(sqlite3.connect, f"{name}?mode=ro", uri=True), create=False)
    except sqlite3.OperationalError:  # for example, a killed process has left half a transaction
        return _open(path, partial(sqlite3.connect, f"{name}?mode=rw", uri=True), create=False)


def _is_idle_log(path: Path) -> bool:
    """Return whether a ledger is in WAL mode and no process has it open."""
    if Path(f"{path}-wal").exists():
        return False
    with path.open("rb") as file:
        return file.read(20)[18:] == b"\2\2"


class _Writer(sqlite3.Connection):
    """Connection that writes. Before each transaction it checks that nobody else has changed the file."""

    _file = -1

    def start(self, path: Path) -> None:
        """Choose the journal, and watch the file from now on."""
        # WAL needs memory that all processes share. Network file systems do not have it.
        wanted = "DELETE" if network_file_system(path.parent) else "WAL"
        ((mode,),) = self.execute(f"PRAGMA journal_mode = {wanted}")
        self.execute(f"PRAGMA synchronous = {'NORMAL' if mode == 'wal' else 'FULL'}")
        self._path, self._loss = path, ""
        # To close a file releases the locks of SQLite on it, so this one is closed last.
        self._file = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        self._header = os.pread(self._file, _HEADER_SIZE, 0)

    def __enter__(self) -> Self:
        if not self._loss and not self._is_own_file():
            self._loss = f"was deleted, replaced or overwritten; {self._rescue()}"
        if self._loss:
            raise OSError(f"{self._path}: {self._loss}")
        return super().__enter__()

    def __exit__(self, *error: Any) -> Literal[False]:
        result = super().__exit__(*error)
        self._header = os.pread(self._file, _HEADER_SIZE, 0)
        return result

    def close(self) -> None:
        """Close the file, and leave no journal beside it, so that it can be read without a right to write."""
        if self._file < 0:  # `start` failed
            super().close()
            return
        overwritten = self._is_in_place() and not self._is_own_file()
        journal = [Path(f"{self._path}-{kind}") for kind in ("wal", "shm")]
        with suppress(sqlite3.Error, OSError):
            if overwritten:  # the journal must not be written into a file of others
                os.truncate(journal[0], 0)
            elif self._is_in_place():
                self.execute("PRAGMA busy_timeout = 0")
                self.execute("PRAGMA journal_mode = DELETE")  # fails if somebody reads
        super().close()
        if overwritten:
            for path in journal:
                path.unlink(missing_ok=True)
        os.close(self._file)
        self._file = -1

    def _is_own_file(self) -> bool:
        return self._is_in_place() and os.pread(self._file, _HEADER_SIZE, 0) == self._header

    def _is_in_place(self) -> bool:
        try:
            return os.path.samestat(self._path.lstat(), os.fstat(self._file))
        except OSError:
            return False

    def _rescue(self) -> str:
        """Copy the ledger if its file is no longer in its place; return what became of the runs."""
        copy = self._path.with_name(f"rescued-{secrets.token_hex(4)}.sqlite")
        try:
            if self._is_in_place():  # the content is that of another program
                return "its runs are lost, tables of earlier sessions are kept"
            with closing(sqlite3.connect(copy)) as target:
                self.backup(target)
                target.execute("PRAGMA journal_mode = DELETE")
        except sqlite3.Error:
            return "its runs are lost"
        return f"its runs are in {copy.name}: rename it to {self._path.name} to resume"


def _prepare(db: sqlite3.Connection, create: bool) -> None:
    """Check the format of a file. With `create`, an empty file gets the tables."""
    db.execute("PRAGMA trusted_schema = OFF")  # the schema may be that of others
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
    _check_schema(db)
    if empty:
        db.executescript(f"BEGIN IMMEDIATE; {_TABLES} COMMIT")
    else:
        _check_types(db)


def _check_schema(db: sqlite3.Connection) -> None:
    for (name,) in db.execute(
        "SELECT name FROM main.sqlite_master WHERE type NOT IN ('table', 'index') OR sql LIKE '%VIRTUAL%'"
    ):
        raise sqlite3.DatabaseError(f"with {name!r:.60}, which is no table of a ledger")


def _check_types(db: sqlite3.Connection) -> None:
    """Refuse values that do not have the type of their column. SQLite stores any type in any column."""
    for table, tests in _type_tests().items():
        present = {column for _, column, *_ in db.execute(f"PRAGMA main.table_info({table})")}
        if not present:
            raise sqlite3.DatabaseError(f"the table {table} is missing")
        condition = " AND ".join(test for column, test in tests.items() if column in present)
        if db.execute(f"SELECT 1 FROM main.{table} WHERE NOT ({condition})").fetchone():
            raise sqlite3.DatabaseError(f"a value of the table {table} has a wrong type or length")


@cache
def _type_tests() -> dict[str, dict[str, str]]:
    """Return an SQL expression for each column of each table, which is true for values of its type."""
    tests: dict[str, dict[str, str]] = {}
    with closing(sqlite3.connect(":memory:")) as model:
        model.executescript(_TABLES)
        for table, column, kind, required, key in model.execute(
            "SELECT t.name, c.name, c.type, c.'notnull', c.pk FROM sqlite_master t"
            " JOIN pragma_table_info(t.name) c WHERE t.type = 'table'"
        ):
            test = f"typeof({column}) = '{kind.lower()}'"
            if kind == "REAL":
                test += f" AND abs({column}) < {_LONGEST_CPU_TIME}"
            if column in ("version", "code", "environment"):
                test += f" AND length({column}) <= {_LONGEST_NAME}"
            if not (required or key):
                test = f"({column} IS NULL OR {test})"
            tests.setdefault(table, {})[column] = test
    return tests


@contextmanager
def damage_errors(path: Path, *more: type[Exception]) -> Generator[None, None, None]:
    """Re-raise errors that unexpected content of a ledger causes as `OSError`, and those of `more` kinds."""
    try:
        yield
    except (*_DAMAGE, *more) as error:
        is_input_error = isinstance(error, InputError)
        if is_input_error and InputError not in more:
            raise
        reason = str(error) if is_input_error else repr(error)[:200]
        raise OSError(f"{path}: is damaged ({reason})") from error


@contextmanager
def os_errors(path: Path) -> Generator[None, None, None]:
    """Re-raise errors of SQLite as `OSError`, like errors of other files."""
    try:
        yield
    except sqlite3.Error as error:
        raise OSError(f"{path}: {error}") from error
