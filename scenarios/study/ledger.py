"""The ledger of a study: the requested runs and their results, in an SQLite file that survives crashes.

The digest of a run is its primary key. A run that several curves contain is stored and played once; its
points in the curves are rows of another table. Only one process writes. Each result is a transaction.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any, Final, NamedTuple, Self

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.model.description.game import Game
from kswarms.scenarios.runs.outcome import Failure, Outcome, environment
from kswarms.scenarios.runs.run import Run, code_version, digest
from kswarms.scenarios.study.database import damage_errors, open_database, os_errors
from kswarms.scenarios.study.mixtures import Contents, Curve, refuse_mixtures

_MERGE: Final = (
    ("INSERT OR REPLACE INTO scenarios VALUES (?, ?)", "SELECT id, toml FROM scenarios"),
    ("INSERT OR IGNORE INTO curves VALUES (?, ?, ?)", "SELECT scenario, condition, description FROM curves"),
    ("INSERT OR IGNORE INTO games (description) VALUES (?)", "SELECT description FROM games"),
    (
        "INSERT INTO runs SELECT ?, id, ?, ?, ?, ?, ?, ?, ?, ?, ?, ? FROM games WHERE description = ?"
        " ON CONFLICT (run) DO UPDATE SET status = excluded.status, code = excluded.code,"
        " environment = excluded.environment, seconds = excluded.seconds, swarms = excluded.swarms,"
        " policies = excluded.policies, error = excluded.error, traceback = excluded.traceback"
        " WHERE runs.status != 'done' AND excluded.status != 'missing'",
        "SELECT run, seed, version, status, code, environment, seconds, swarms, policies, error, traceback,"
        " description FROM runs JOIN games ON game = id",
    ),
    (
        "INSERT OR IGNORE INTO points VALUES (?, ?, ?, ?, ?)",
        "SELECT scenario, condition, n, seed, run FROM points",
    ),
    ("INSERT OR IGNORE INTO records VALUES (?, ?, ?)", "SELECT run, name, rows FROM records"),
    (
        "INSERT INTO sessions (about) SELECT ?1 WHERE ?1 NOT IN (SELECT about FROM sessions)",
        "SELECT about FROM sessions ORDER BY id",
    ),
)
"""Statements that merge a ledger: each inserts the rows that the other selects."""


class Point(NamedTuple):
    """A run as a point of a curve."""

    run: str
    scenario: str
    condition: str
    n: int
    seed: int


class Ledger:
    """An open ledger, a context manager. With `create`, a missing file is created.

    A file that is not a ledger of this format raises an `InputError`. Every method raises an `OSError` if the
    file cannot be read or written; committed data is kept.
    """

    def __init__(self, path: Path, create: bool = False) -> None:
        self.path = path
        self._db = open_database(path, create)  # `with self._db` is a transaction

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._db.close()

    def _query(self, sql: str, *values: object) -> Iterator[Any]:
        with os_errors(self.path):
            for row in self._db.execute(sql, values):  # noqa: UP028  # `yield from` may close it too late
                yield row

    def _parse_json(self, text: str) -> Any:
        with damage_errors(self.path):
            return json.loads(text)

    def plan(
        self,
        scenarios: dict[str, str],
        curves: dict[Curve, str],
        runs: Sequence[Run],
        allow_mixed: bool = False,
    ) -> None:
        """Add runs, the TOML of their scenarios by id, and the descriptions of their curves.

        If the ledger has runs of another version, of another environment (unless `allow_mixed`), or a
        different curve of the same name, an `InputError` is raised and nothing is added.
        """
        added = Contents({__version__}, {environment()}, curves)
        with os_errors(self.path), self._db:
            refuse_mixtures(str(self.path.parent), self.contents(), added, "this is", allow_mixed)
            self._db.executemany("INSERT OR REPLACE INTO scenarios VALUES (?, ?)", scenarios.items())
            self._db.executemany(
                "INSERT OR REPLACE INTO curves VALUES (?, ?, ?)",
                ((*curve, text) for curve, text in curves.items()),
            )
            games = {run.game: run.game.model_dump_json() for run in runs}
            self._db.executemany(
                "INSERT OR IGNORE INTO games (description) VALUES (?)", ((text,) for text in games.values())
            )
            self._db.executemany(
                "INSERT OR IGNORE INTO runs (run, game, seed, version)"
                " SELECT ?, id, ?, ? FROM games WHERE description = ?",
                ((run.digest, run.seed, __version__, games[run.game]) for run in runs),
            )
            self._db.executemany(
                "INSERT OR REPLACE INTO points VALUES (?, ?, ?, ?, ?)",
                ((*label, run.n, run.seed, run.digest) for run in runs for label in run.labels),
            )

    def contents(self) -> Contents:
        """Return the versions, environments and curves of the runs."""
        versions = {version for (version,) in self._query("SELECT DISTINCT version FROM runs")}
        curves = {(name, condition): text for name, condition, text in self._query("SELECT * FROM curves")}
        return Contents(versions, set(self.runs_by_environment()), curves)

    def unfinished(self, runs: Iterable[Run], records: Sequence[str]) -> list[Run]:
        """Return the runs that are not done, or lack one of the recorded tables."""
        done = {run for (run,) in self._query("SELECT run FROM runs WHERE status = 'done'")}
        for name in records:
            done &= {run for (run,) in self._query("SELECT run FROM records WHERE name = ?", name)}
        return [run for run in runs if run.digest not in done]

    def add(self, run: Run, result: Outcome | Failure, seconds: float, records: dict[str, bytes]) -> None:
        """Store the result of a planned run, its CPU time (s) and its packed records by name.

        If a finished run is replayed to record a table and fails, it keeps its status and results.
        """
        with os_errors(self.path), self._db:
            if isinstance(result, Failure):
                self._db.execute(
                    "UPDATE runs SET error = ?, traceback = ? WHERE run = ?",
                    (result.error, result.trace, run.digest),
                )
                self._db.execute(
                    "UPDATE runs SET status = 'failed', code = ?, seconds = ?"
                    " WHERE run = ? AND status != 'done'",
                    (code_version(), seconds, run.digest),
                )
            else:
                rows = (json.dumps(result.swarms), json.dumps(result.policies))
                self._db.execute(
                    "UPDATE runs SET status = 'done', code = ?, environment = ?, seconds = ?, swarms = ?,"
                    " policies = ?, error = NULL, traceback = NULL WHERE run = ?",
                    (code_version(), result.environment, seconds, *rows, run.digest),
                )
            self._db.executemany(
                "INSERT OR REPLACE INTO records VALUES (?, ?, ?)",
                ((run.digest, name, table) for name, table in records.items()),
            )

    def check(self) -> None:
        """Read the whole file; raise an `OSError` if it is damaged."""
        for found in ("quick_check(1)", "foreign_key_check"):
            for row in self._query(f"PRAGMA {found}"):
                if row != ("ok",):
                    raise OSError(f"{self.path}: is damaged ({' '.join(map(str, row))})")

    def result_digests(self) -> Iterator[tuple[str, bytes]]:
        """Yield each finished run with a hash of its results."""
        for run, *rows in self._query("SELECT run, swarms, policies FROM runs WHERE status = 'done'"):
            yield run, sha256(repr(rows).encode()).digest()

    def merge(self, others: Iterable[Self]) -> None:
        """Add the content of other ledgers of this format; finished runs are kept. Nothing is checked."""
        with os_errors(self.path), self._db:
            for other in others:
                for insert, select in _MERGE:
                    self._db.executemany(insert, other._query(select))

    def results(self, name: str) -> Iterator[tuple[Point, list[dict[str, Any]]]]:
        """Yield the finished points with rows ``swarms`` or ``policies``, ordered by curve, `n` and seed."""
        for *point, rows in self._query(
            f"SELECT run, scenario, condition, n, points.seed, {name} FROM points JOIN runs USING (run)"
            " WHERE status = 'done' ORDER BY scenario, condition, n, points.seed"
        ):
            yield Point(*point), self._parse_json(rows)

    def grid_points(self) -> dict[Curve, dict[str, Any]]:
        """Return, for each curve of a grid, the values that the grid sets, by field."""
        points = {}
        with damage_errors(self.path):
            for *curve, text in self._query("SELECT * FROM curves ORDER BY scenario, condition"):
                if point := self._parse_json(text)["condition"].get("grid_point"):
                    points[tuple(curve)] = dict(point)
        return points

    def records(self, name: str) -> Iterator[tuple[str, bytes]]:
        """Yield digest and packed table of each finished run that recorded this table, ordered by digest."""
        return self._query(
            "SELECT run, rows FROM records JOIN runs USING (run)"
            " WHERE name = ? AND status = 'done' ORDER BY run",
            name,
        )

    def run(self, run_digest: str) -> Run:
        """Return a run; raise an `InputError` if it is missing, or if its version or files have changed."""
        query = "SELECT version, description, seed FROM games JOIN runs ON game = id WHERE run = ?"
        row = next(self._query(query, run_digest), None) if run_digest.isascii() else None
        if row is None:
            rule = f"must be a run of {self.path.parent}: see the column run of its tables"
            raise InputError("run", run_digest, rule)
        version, description, seed = row
        if version != __version__:
            raise InputError("run", run_digest, f"was played by kswarms {version}, this is {__version__}")
        labels = tuple(self._query("SELECT scenario, condition FROM points WHERE run = ?", run_digest))
        with damage_errors(self.path):
            game = Game(**self._parse_json(description))
            run = Run(run_digest, game, seed, (labels[0], *labels[1:]))
        if digest(run.game, run.seed) != run_digest:
            raise InputError("run", run_digest, "loads a file that has changed since it was played")
        return run

    def outcome(self, run_digest: str) -> tuple[list[dict[str, Any]], list[dict[str, Any]]] | None:
        """Return the rows ``swarms`` and ``policies`` of a run, or None if it is not done."""
        query = "SELECT swarms, policies FROM runs WHERE run = ? AND status = 'done'"
        row = next(self._query(query, run_digest), None)
        return (self._parse_json(row[0]), self._parse_json(row[1])) if row else None

    def origin(self, run_digest: str) -> str:
        """Return code and environment that played a run, as far as they are known."""
        query = "SELECT code, environment FROM runs WHERE run = ?"
        return ", ".join(text for row in self._query(query, run_digest) for text in row if text)

    def write_session(self, number: int | None, about: dict[str, Any]) -> int | None:
        """Write the description of a session, a new one if `number` is None; return its number."""
        with os_errors(self.path), self._db:
            row = (number, json.dumps(about))
            return self._db.execute("INSERT OR REPLACE INTO sessions VALUES (?, ?)", row).lastrowid

    def sessions(self) -> list[dict[str, Any]]:
        """Return the descriptions of all sessions, in order."""
        texts = [text for (text,) in self._query("SELECT about FROM sessions ORDER BY id")]
        with damage_errors(self.path):
            return [{"started": "", **self._parse_json(text)} for text in texts]

    def scenarios(self) -> dict[str, str]:
        """Return the latest TOML of each scenario, by id."""
        return dict(self._query("SELECT id, toml FROM scenarios ORDER BY id"))

    def points_by_scenario(self) -> dict[str, dict[str, tuple[int, float]]]:
        """Return the number of points and the CPU time of their runs (s), by scenario and status."""
        counts: dict[str, dict[str, tuple[int, float]]] = {}
        for scenario, status, points, seconds in self._query(
            "SELECT scenario, status, COUNT(*), TOTAL(seconds) FROM points JOIN runs USING (run)"
            " GROUP BY scenario, status ORDER BY scenario"
        ):
            counts.setdefault(scenario, {})[status] = (points, seconds)
        return counts

    def runs_by_status(self) -> dict[str, tuple[int, float]]:
        """Return the number of runs and their CPU time (s), by status."""
        rows = self._query("SELECT status, COUNT(*), TOTAL(seconds) FROM runs GROUP BY status")
        return {status: (runs, seconds) for status, runs, seconds in rows}

    def runs_by_code(self) -> dict[str, int]:
        """Return the number of runs, by the version of the code that played them."""
        return dict(self._query("SELECT code, COUNT(*) FROM runs WHERE code NOT NULL GROUP BY code"))

    def runs_by_environment(self) -> dict[str, int]:
        """Return the number of finished runs, by the environment that played them."""
        return dict(
            self._query(
                "SELECT environment, COUNT(*) FROM runs WHERE status = 'done' AND environment NOT NULL"
                " GROUP BY environment"
            )
        )

    def failed_runs(self) -> Iterator[tuple[Point, str, str]]:
        """Yield the runs whose last attempt failed: a point of each, its error and traceback."""
        for *point, error, trace in self._query(
            "SELECT run, MIN(scenario), condition, n, points.seed, error, COALESCE(traceback, '')"
            " FROM points JOIN runs USING (run) WHERE error NOT NULL"
            " GROUP BY run ORDER BY MIN(scenario), condition, n, points.seed"
        ):
            yield Point(*point), error, trace
