"""The ledger of a study: what was asked for, what came of it, in a SQLite file that survives any death.

A run is a row under its digest, so it is played once whoever asks for it; the curves that it belongs to
are kept apart, one row for each point. Each run is committed by itself, by the one process that writes.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.model.description.game import Game
from kswarms.scenarios.runs.outcome import Failure, Outcome
from kswarms.scenarios.runs.run import Run, code_version, digest
from kswarms.scenarios.study.database import FILE, Database


class Point(NamedTuple):
    """Where a run stands in a figure: its labels in the tables of results."""

    run: str
    scenario: str
    condition: str
    n: int
    seed: int


class Ledger(Database):
    """An open ledger; what it takes and raises is what a `Database` does."""

    # -------------------------------------------------------------------------------------- what is asked for

    def plan(
        self, scenarios: dict[str, str], curves: dict[tuple[str, str], str], runs: Sequence[Run]
    ) -> None:
        """Enter runs that are asked for, and the scenarios that ask.

        Parameters
        ----------
        scenarios : dict of str to str
            TOML of each scenario by its id.
        curves : dict of (scenario, condition) to str
            What each curve is, as `kswarms.scenarios.runs.run.describe_curve` gives it.
        runs : sequence of Run
            What is asked for.

        Raises
        ------
        InputError
            If the ledger has runs of another version, or of a curve that was described otherwise; then
            nothing is entered.
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

    def _refuse_mixtures(self, curves: dict[tuple[str, str], str]) -> None:
        directory = str(self.path.parent)
        for (version,) in self._db.execute("SELECT DISTINCT version FROM runs"):
            if version != __version__:
                raise InputError(
                    "out",
                    directory,
                    f"has runs of kswarms {version}, this is {__version__}; name another",
                )
        known = {
            (scenario, condition): text
            for scenario, condition, text in self._db.execute(
                "SELECT scenario, condition, description FROM curves"
            )
        }
        for (scenario, condition), text in curves.items():
            if known.get((scenario, condition), text) != text:
                curve = f"{scenario} {condition}".strip()
                raise InputError(
                    "out",
                    directory,
                    f"has runs of a {curve} described otherwise; name another, or give it another id",
                )

    def unfinished(self, runs: Iterable[Run], records: Sequence[str]) -> list[Run]:
        """Return the runs that are not done yet, or lack one of the recorded tables asked for."""
        done = {run for (run,) in self.query("SELECT run FROM runs WHERE status = 'done'")}
        for name in records:
            done &= {run for (run,) in self.query("SELECT run FROM records WHERE name = ?", name)}
        return [run for run in runs if run.digest not in done]

    # ------------------------------------------------------------------------------------------ what came out

    def add(
        self, run: Run, result: Outcome | Failure, seconds: float, records: dict[str, bytes], replay: str
    ) -> None:
        """Enter what came out of a run that was planned.

        A run that is done, and was played again for a record, stays done with its results if that fails.

        Parameters
        ----------
        run : Run
            What was played.
        result : Outcome or Failure
            What came out.
        seconds : float
            CPU time (s).
        records : dict of str to bytes
            Recorded tables by name, each packed.
        replay : str
            The command that plays it again.
        """
        told: tuple[str | None, str | None] = (None, None)
        played = (code_version(), seconds)
        with self._transaction():
            if isinstance(result, Failure):
                told = (result.error, result.trace)
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
            self._db.execute(
                "UPDATE runs SET error = ?, traceback = ?, replay = ? WHERE run = ?",
                (*told, replay, run.digest),
            )
            self._db.executemany(
                "INSERT OR REPLACE INTO records VALUES (?, ?, ?)",
                ((run.digest, name, rows) for name, rows in records.items()),
            )

    def results(self, name: str) -> Iterator[tuple[Point, list[dict[str, Any]]]]:
        """Yield the rows of ``swarms`` or ``policies`` of each point that is done, in their order."""
        for *point, rows in self.query(
            f"SELECT run, scenario, condition, n, points.seed, {name} FROM points JOIN runs USING (run)"
            f" WHERE status = 'done' AND {name} != '[]' ORDER BY scenario, condition, n, points.seed"
        ):
            yield Point(*point), self._parsed(rows)

    def records(self, name: str) -> Iterator[tuple[str, bytes]]:
        """Yield a recorded table, packed, of every run that is done and has it, in the order of digests."""
        yield from self.query(
            "SELECT run, rows FROM records JOIN runs USING (run)"
            " WHERE name = ? AND status = 'done' ORDER BY run",
            name,
        )

    # --------------------------------------------------------------------------------------------- looking in

    def run(self, name: str) -> Run:
        """Return the run of a digest.

        Raises
        ------
        InputError
            If there is none, or playing it now would be playing something else.
        """
        row = next(
            self.query("SELECT description, seed FROM games JOIN runs ON game = id WHERE run = ?", name),
            None,
        )
        if row is None:
            raise InputError(
                "run", name, f"must be a run of {self.path.parent}: see the column run of its tables"
            )
        labels = tuple(self.query("SELECT scenario, condition FROM points WHERE run = ?", name))
        run = Run(name, Game(**self._parsed(row[0])), row[1], labels)
        if digest(run.game, run.seed) != name:
            raise InputError(
                "run", name, "is of another version of kswarms, or what its game loads has changed"
            )
        return run

    def outcome(self, name: str) -> tuple[list[dict[str, Any]], list[dict[str, Any]]] | None:
        """Return the rows of swarms and of policies of a run, or None if it is not done."""
        row = next(
            self.query("SELECT swarms, policies FROM runs WHERE run = ? AND status = 'done'", name), None
        )
        return (self._parsed(row[0]), self._parsed(row[1])) if row else None

    # ----------------------------------------------------------------------------------------------- sessions

    def begin_session(self, about: dict[str, Any]) -> int:
        """Enter a session, and return its number."""
        with self._transaction():
            number = self._db.execute(
                "INSERT INTO sessions (about) VALUES (?)", (json.dumps(about),)
            ).lastrowid
        assert number is not None
        return number

    def update_session(self, number: int, **changes: Any) -> None:
        """Add to what is known of a session."""
        ((about,),) = self.query("SELECT about FROM sessions WHERE id = ?", number)
        with self._transaction():
            self._db.execute(
                "UPDATE sessions SET about = ? WHERE id = ?",
                (json.dumps(self._parsed(about) | changes), number),
            )

    def sessions(self) -> list[dict[str, Any]]:
        """Return what is known of every session, the first first."""
        return [self._parsed(about) for (about,) in self.query("SELECT about FROM sessions ORDER BY id")]

    def scenarios(self) -> dict[str, str]:
        """Return the TOML of each scenario, as it was asked for last, by its id."""
        return dict(self.query("SELECT id, toml FROM scenarios ORDER BY id"))


def find_run(directory: Path, name: str) -> Run:
    """Return the run of a digest from the ledger of a directory of results.

    Parameters
    ----------
    directory : Path
        What ``kswarms run --out`` wrote.
    name : str
        The digest, as the column ``run`` of the tables has it.

    Raises
    ------
    InputError
        If there is no ledger, no such run in it, or playing it now would be playing something else.
    """
    with Ledger(directory / FILE) as ledger:
        return ledger.run(name)
