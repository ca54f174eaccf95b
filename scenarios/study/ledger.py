"""The ledger of a study: the requested runs and their results, in an SQLite file that survives crashes.

A run is a row under its digest, so it is played once, however many curves contain it. Its points in these
curves are rows of another table. Each run is committed on its own, by the one process that writes.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.model.description.game import Game
from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run, code_version, digest
from kswarms.scenarios.study.database import Database

Curve = tuple[str, str]
"""Scenario and condition."""


class Point(NamedTuple):
    """A run as a point of a curve."""

    run: str
    scenario: str
    condition: str
    n: int
    seed: int


class Ledger(Database):
    """An open ledger; its parameters and errors are those of `Database`."""

    # ----------------------------------------------------------------------------------------------- requests

    def plan(self, scenarios: dict[str, str], curves: dict[Curve, str], runs: Sequence[Run]) -> None:
        """Add runs, the TOML of their scenarios by id, and the descriptions of their curves.

        Raises
        ------
        InputError
            If the ledger has runs of another version, or a different curve of the same name; then nothing
            is added.
        """
        with self._transaction():
            self._refuse_mixtures(curves)
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

    def _refuse_mixtures(self, curves: dict[Curve, str]) -> None:
        directory = str(self.path.parent)
        for (version,) in self._db.execute("SELECT DISTINCT version FROM runs"):
            if version != __version__:
                reason = f"has runs of kswarms {version}, this is {__version__}; use another directory"
                raise InputError("out", directory, reason)
        for scenario, condition, text in self._db.execute("SELECT * FROM curves"):
            if curves.get((scenario, condition), text) != text:
                curve = f"{scenario} {condition}".strip()
                reason = f"has runs of a different {curve}; use another directory, or another id"
                raise InputError("out", directory, reason)

    def unfinished(self, runs: Iterable[Run], records: Sequence[str]) -> list[Run]:
        """Return the runs that are not done, or lack one of the recorded tables."""
        done = {run for (run,) in self.query("SELECT run FROM runs WHERE status = 'done'")}
        for name in records:
            done &= {run for (run,) in self.query("SELECT run FROM records WHERE name = ?", name)}
        return [run for run in runs if run.digest not in done]

    # ------------------------------------------------------------------------------------------------ results

    def add(
        self, run: Run, result: Outcome | Failure, seconds: float, records: dict[str, bytes] | None = None
    ) -> None:
        """Store the result of a planned run, its CPU time (s) and its packed records by name.

        A run that is done and fails when it is replayed for a record keeps its status and results.
        """
        error: tuple[str | None, str | None] = (None, None)
        played = (code_version(), seconds)
        with self._transaction():
            if isinstance(result, Failure):
                error = (result.error, result.trace)
                self._db.execute(
                    "UPDATE runs SET status = 'failed', code = ?, seconds = ?"
                    " WHERE run = ? AND status != 'done'",
                    (*played, run.digest),
                )
            else:
                self._db.execute(
                    "UPDATE runs SET status = 'done', code = ?, seconds = ?, swarms = ?, policies = ?"
                    " WHERE run = ?",
                    (*played, json.dumps(result.swarms), json.dumps(result.policies), run.digest),
                )
            self._db.execute("UPDATE runs SET error = ?, traceback = ? WHERE run = ?", (*error, run.digest))
            self._db.executemany(
                "INSERT OR REPLACE INTO records VALUES (?, ?, ?)",
                ((run.digest, name, rows) for name, rows in (records or {}).items()),
            )

    def results(self, name: str) -> Iterator[tuple[Point, list[dict[str, Any]]]]:
        """Yield the rows ``swarms`` or ``policies`` of each finished point, ordered by its columns."""
        for *point, rows in self.query(
            f"SELECT run, scenario, condition, n, points.seed, {name} FROM points JOIN runs USING (run)"
            f" WHERE status = 'done' AND {name} != '[]' ORDER BY scenario, condition, n, points.seed"
        ):
            yield Point(*point), self._parse_json(rows)

    def grid_points(self) -> dict[Curve, dict[str, Any]]:
        """Return the values that a grid sets, by field, of each curve with a grid."""
        points = {}
        for scenario, condition, text in self.query("SELECT * FROM curves ORDER BY scenario, condition"):
            if point := self._parse_json(text)["condition"].get("grid_point"):
                points[scenario, condition] = dict(point)
        return points

    def records(self, name: str) -> Iterator[tuple[str, bytes]]:
        """Yield a recorded table, packed, of each finished run that has it, ordered by digest."""
        yield from self.query(
            "SELECT run, rows FROM records JOIN runs USING (run)"
            " WHERE name = ? AND status = 'done' ORDER BY run",
            name,
        )

    def run(self, name: str) -> Run:
        """Return the run with a digest.

        Raises
        ------
        InputError
            If the ledger does not have it, or replaying it now would play a different game.
        """
        query = "SELECT version, description, seed FROM games JOIN runs ON game = id WHERE run = ?"
        row = next(self.query(query, name), None)
        if row is None:
            reason = f"must be a run of {self.path.parent}: see the column run of its tables"
            raise InputError("run", name, reason)
        version, description, seed = row
        if version != __version__:
            raise InputError("run", name, f"was played by kswarms {version}, this is {__version__}")
        labels = tuple(self.query("SELECT scenario, condition FROM points WHERE run = ?", name))
        run = Run(name, Game(**self._parse_json(description)), seed, labels)
        if digest(run.game, run.seed) != name:
            raise InputError("run", name, "loads a file that has changed since it was played")
        return run

    def outcome(self, name: str) -> tuple[list[dict[str, Any]], list[dict[str, Any]]] | None:
        """Return the rows ``swarms`` and ``policies`` of a run, or None if it is not done."""
        query = self.query("SELECT swarms, policies FROM runs WHERE run = ? AND status = 'done'", name)
        row = next(query, None)
        return (self._parse_json(row[0]), self._parse_json(row[1])) if row else None

    # ----------------------------------------------------------------------------------------------- sessions

    def begin_session(self, about: dict[str, Any]) -> int:
        """Add a session; return its number."""
        with self._transaction():
            cursor = self._db.execute("INSERT INTO sessions (about) VALUES (?)", (json.dumps(about),))
        assert cursor.lastrowid is not None
        return cursor.lastrowid

    def update_session(self, number: int, **changes: Any) -> None:
        """Change the description of a session."""
        ((about,),) = self.query("SELECT about FROM sessions WHERE id = ?", number)
        with self._transaction():
            self._db.execute(
                "UPDATE sessions SET about = ? WHERE id = ?",
                (json.dumps(self._parse_json(about) | changes), number),
            )

    def sessions(self) -> list[dict[str, Any]]:
        """Return the descriptions of all sessions, in order."""
        return [self._parse_json(about) for (about,) in self.query("SELECT about FROM sessions ORDER BY id")]

    def scenarios(self) -> dict[str, str]:
        """Return the latest TOML of each scenario, by id."""
        return dict(self.query("SELECT id, toml FROM scenarios ORDER BY id"))
