"""A study: a directory of results that keeps every run, can be resumed and has one writer at a time.

The ledger is the source of truth. A session is the use of a `Study` in one ``with`` block. When it ends, the
tables and the manifest are written from the ledger.
"""

import os
import platform
import re
import shutil
from collections.abc import Generator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, closing, suppress
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, Self

from kswarms import __version__
from kswarms.agents.common.atomic_files import TEMPORARY, remove_temporary_files
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.outcome import Outcome, Result, environment
from kswarms.scenarios.runs.run import Run, code_version, describe_curve, expand
from kswarms.scenarios.runs.sweep import sweep
from kswarms.scenarios.signals import deferred_signals
from kswarms.scenarios.study.database import LEDGER_FILE, create_database
from kswarms.scenarios.study.directory import make_directory, write_json
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.lock import LOCK_FILE, directory_lock
from kswarms.scenarios.study.parquet import STUDY_TABLES, export, pack

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


class Study:
    """A directory of results, open for playing; a context manager.

    On exit, also after Ctrl-C, it writes the manifest and the `tables` of all finished runs. Signals that
    arrive while it writes are deferred.

    Parameters
    ----------
    directory : Path
        Created unless it exists.
    command : str
        The command line, for the manifest and the lock.
    allow_mixed : bool
        Whether runs of several environments (versions of Python, numpy and numba, machine) may be mixed.

    Raises
    ------
    InputError
        If the directory is not writable, in use, or has files but no ledger of kswarms.
    OSError
        If writing fails; finished runs are kept.
    """

    def __init__(self, directory: Path, command: str = "", allow_mixed: bool = False) -> None:
        self.directory = directory
        self.tables: list[Path] = []
        self._command = command
        self._allow_mixed = allow_mixed
        self._session: int | None = None

    def __enter__(self) -> Self:
        ledger = self.directory / LEDGER_FILE
        make_directory(self.directory, LEDGER_FILE, _FILES)
        # First the ledger: it tells directories of kswarms from others, also if this process is killed now.
        create_database(ledger)
        with ExitStack() as stack:
            stack.enter_context(directory_lock(self.directory, self._command))
            for path in self.directory.glob(f"{_TEMPORARY_TABLES}*"):
                shutil.rmtree(path, ignore_errors=True)
            remove_temporary_files(self.directory)
            self._ledger = stack.enter_context(Ledger(ledger, create=True))
            self._resources = stack.pop_all()
        self._about = _describe_session(self._command)
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        with self._resources, deferred_signals():
            if self._session is None:  # `plan` was not called, or failed
                return
            if isinstance(error, OSError):
                with suppress(OSError):  # report the first error
                    self._update_session(status=f"stopped: {error}", ended=_now())
                return
            # If a table cannot be written, no present table is replaced.
            with TemporaryDirectory(dir=self.directory, prefix=_TEMPORARY_TABLES) as temporary:
                written = export(self._ledger, Path(temporary))
                self.tables = [path.replace(self.directory / path.name) for path in written]
            self._update_session(status=_status(error), ended=_now())

    def plan(
        self, scenarios: Sequence[Scenario], first_seed: int = 0, records: Sequence[str] = ()
    ) -> list[Run]:
        """Add scenarios to the study; return their unfinished runs.

        Parameters
        ----------
        first_seed : int
            Seed of the first game at each density, ≥ 0.
        records : sequence of str
            Names of tables (`RECORDED_TABLES`). A run without one of them counts as unfinished.

        Raises
        ------
        InputError
            If the directory has runs of another version, of another environment (unless `allow_mixed`), or
            of a different curve of the same name.
        """
        runs = expand(scenarios, first_seed)
        self._ledger.plan(
            {scenario.id: scenario.to_toml() for scenario in scenarios},
            {
                (scenario.id, condition.name): describe_curve(condition, scenario.densities[0])
                for scenario in scenarios
                for condition in scenario.conditions
            },
            runs,
            self._allow_mixed,
        )
        waiting = self._ledger.unfinished(runs, records)
        self._update_session(
            scenarios={each.id: {"densities": each.densities, "seeds": each.seeds} for each in scenarios},
            first_seed=first_seed,
            records=list(records),
            runs={"requested": len(runs), "done before": len(runs) - len(waiting)},
        )
        return waiting

    @property
    def other_origins(self) -> list[str]:
        """Code versions and environments, except the present ones, that played runs of the study."""
        found = (*self._ledger.runs_by_code(), *self._ledger.runs_by_environment())
        return [origin for origin in found if origin not in (code_version(), environment())]

    def play(
        self,
        runs: Sequence[Run],
        jobs: int = 1,
        records: Sequence[str] = (),
        executor: Executor | None = None,
        run_limit: float | None = None,
    ) -> Generator[Result, None, None]:
        """Play runs; store each and then yield it with its outcome or failure, and its CPU time (s).

        Parameters
        ----------
        runs : sequence of Run
            Runs that `plan` returned.
        jobs, executor, run_limit
            As for `kswarms.scenarios.runs.sweep.play_all`.
        records : sequence of str
            Names of the tables to record and store.

        Raises
        ------
        RunError
            If the executor breaks, or a worker has another environment and `allow_mixed` is False.
        """
        with closing(sweep(runs, jobs, ",".join(records), executor, run_limit)) as results:
            for run, result, seconds in results:
                if isinstance(result, Outcome):
                    self._require_environment(result)
                tables = pack(result.records) if isinstance(result, Outcome) else {}
                self._ledger.add(run, result, seconds, tables)
                yield run, result, seconds

    def _require_environment(self, outcome: Outcome) -> None:
        if not self._allow_mixed and outcome.environment != environment():
            workers = f"a worker has {outcome.environment}, this process has {environment()}"
            raise RunError(f"{workers}; use equal versions, or --allow-mixed")

    def _update_session(self, **changes: Any) -> None:
        """Change the description of this session in the ledger, and write the manifest."""
        self._about |= changes
        self._session = self._ledger.write_session(self._session, self._about)
        content = {
            "kswarms": __version__,
            "code": code_version(),
            "entropy": _ENTROPY,
            "environments": self._ledger.runs_by_environment(),
            "scenarios": self._ledger.scenarios(),
            "sessions": self._ledger.sessions(),
        }
        write_json(self.directory / MANIFEST, content)


def _status(error: BaseException | None) -> str:
    """Return the status of a session that ends with this error."""
    if error is None:
        return "done"
    number = str(error) if isinstance(error, KeyboardInterrupt) else ""  # its text names the signal, if any
    return f"stopped: {number or type(error).__name__}"


def _describe_session(command: str) -> dict[str, Any]:
    required = [
        re.split(r"[^\w.-]", text)[0] for text in metadata.requires("kswarms") or () if "extra ==" not in text
    ]
    return {
        "command": command,
        "started": _now(),
        "status": "running, or killed",
        "kswarms": __version__,
        "code": code_version(),
        "python": platform.python_version(),
        "libraries": {name: metadata.version(name) for name in required},
        "machine": {"system": platform.platform(), "processor": platform.machine(), "cpus": os.cpu_count()},
    }


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
