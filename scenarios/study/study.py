"""A study: a directory that keeps what was played, goes on where it was, and has one user at a time.

The ledger is what counts; the tables and the manifest are made of it, whole, whenever a session ends.
"""

import fcntl
import os
import platform
import re
import shlex
import shutil
import socket
import time
from collections.abc import Generator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, closing, contextmanager, suppress
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Final, Self, TextIO

from kswarms import __version__
from kswarms.agents.common.atomic_files import UNFINISHED, remove_unfinished
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.description.toml_files import make_directory, write_json
from kswarms.scenarios.runs.outcome import Failure, Outcome, Result
from kswarms.scenarios.runs.run import Run, code_version, describe_curve, expand
from kswarms.scenarios.runs.sweep import sweep
from kswarms.scenarios.study.database import FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.summary import codes

MANIFEST: Final = "manifest.json"
"""Name of the file that says how the results came about."""
LOCK: Final = "lock"
"""Name of the file whose lock a study holds."""

_PATIENCE: Final = 1.0
"""For how long those who only ask for the holder of a study are waited for (s) …"""
_PAUSE: Final = 0.005
"""… between two looks (s)."""

_TABLES: Final = f"{UNFINISHED}tables-"
"""How the directory begins that tables are written to before they are whole."""

_ENTROPY: Final = "numpy PCG64(SeedSequence(seed, spawn_key=(robot, purpose))), and nothing else"


class Study:
    """A directory of results, open for playing; used in a ``with`` statement.

    When it is left, also by Ctrl-C, the tables and the manifest of all that was played are written.

    Parameters
    ----------
    directory : Path
        Where it is; made if need be.
    command : str
        What was typed, for the manifest and for whoever finds the directory in use.

    Attributes
    ----------
    tables : list of Path
        The tables written when it was left.

    Raises
    ------
    InputError
        If the directory cannot be written to, holds tables that are not of its ledger, or another process
        uses it.
    OSError
        If something cannot be written; what was played before is kept.
    """

    def __init__(self, directory: Path, command: str = "") -> None:
        self.directory = directory
        self.tables: list[Path] = []
        self._command = command
        self._open = ExitStack()
        self._session: int | None = None

    def __enter__(self) -> Self:
        _make(self.directory)
        with self._open as stack:
            stack.enter_context(_locked(self.directory, self._command))
            for left in self.directory.glob(f"{_TABLES}*"):
                shutil.rmtree(left, ignore_errors=True)
            remove_unfinished(self.directory)
            self._ledger = stack.enter_context(Ledger(self.directory / FILE, new=True))
            self._open = stack.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        with self._open:
            if self._session is None:
                return
            if isinstance(error, OSError):
                with suppress(OSError):  # the first error is the one to tell
                    self._end_session(self._session, f"stopped: {error}")
            else:
                self._finish(self._session, "stopped: " + kind.__name__ if kind else "done")

    def plan(
        self, scenarios: Sequence[Scenario], first_seed: int = 0, records: Sequence[str] = ()
    ) -> list[Run]:
        """Enter scenarios, and return those of their runs that are still to be played.

        Parameters
        ----------
        scenarios : sequence of Scenario
            What is asked for.
        first_seed : int
            Seed of the first game at each density.
        records : sequence of str
            Recorded tables that each run is to have.

        Raises
        ------
        InputError
            If the directory has runs of another version, or of a curve that was described otherwise.
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
        )
        waiting = self._ledger.unfinished(runs, records)
        if self._session is None:
            self._session = self._ledger.begin_session(_about(self._command))
        self._ledger.update_session(
            self._session,
            scenarios={
                scenario.id: {"densities": scenario.densities, "seeds": scenario.seeds}
                for scenario in scenarios
            },
            first_seed=first_seed,
            records=list(records),
            runs={"asked for": len(runs), "done before": len(runs) - len(waiting)},
        )
        write_json(self.directory / MANIFEST, self._manifest())
        return waiting

    @property
    def other_code(self) -> list[str]:
        """Versions of other code that has played some of the runs, as a developer changes it."""
        return [code for code in codes(self._ledger) if code != code_version()]

    def play(
        self,
        runs: Sequence[Run],
        jobs: int = 1,
        records: Sequence[str] = (),
        executor: Executor | None = None,
    ) -> Generator[Result, None, None]:
        """Play runs that were planned, and yield each when it is kept.

        Parameters
        ----------
        runs : sequence of Run
            What `plan` returned.
        jobs, executor
            As for `kswarms.scenarios.runs.sweep.sweep`.
        records : sequence of str
            Recorded tables to keep.
        """
        with closing(sweep(runs, jobs, ",".join(records), executor)) as played:
            for run, result, seconds in played:
                self._keep(run, result, seconds)
                yield run, result, seconds

    def _keep(self, run: Run, result: Outcome | Failure, seconds: float) -> None:
        packed = {}
        if isinstance(result, Outcome) and result.records:
            from kswarms.scenarios.study.parquet import pack  # here, since pyarrow takes long to import

            packed = pack(result)
        self._ledger.add(run, result, seconds, packed, replay_command(self.directory, run.digest))

    def _finish(self, session: int, status: str) -> None:
        from kswarms.scenarios.study.parquet import export  # here, since pyarrow takes long to import

        with TemporaryDirectory(dir=self.directory, prefix=_TABLES) as unfinished:
            whole = export(self._ledger, Path(unfinished))
            self.tables = [path.replace(self.directory / path.name) for path in whole]
        self._end_session(session, status)

    def _end_session(self, session: int, status: str) -> None:
        self._ledger.update_session(session, status=status, ended=_now())
        write_json(self.directory / MANIFEST, self._manifest())

    def _manifest(self) -> dict[str, Any]:
        return {
            "kswarms": __version__,
            "code": code_version(),
            "entropy": _ENTROPY,
            "scenarios": self._ledger.scenarios(),
            "sessions": self._ledger.sessions(),
        }


def replay_command(directory: Path, run: str) -> str:
    """Return the command that plays a run of a directory again."""
    return f"kswarms replay {shlex.quote(str(directory))} {run}"


def holder(directory: Path) -> str:
    """Return who plays into a directory now, empty if nobody does."""
    with suppress(OSError), (directory / LOCK).open() as file:
        if not _lock(file, fcntl.LOCK_SH):
            return _user(file)
    return ""


@contextmanager
def _locked(directory: Path, command: str) -> Generator[None, None, None]:
    """Hold the directory. The system lets go of it when this process ends, however it does."""
    with (directory / LOCK).open("a+") as file:
        patience = time.monotonic() + _PATIENCE
        while not _lock(file, fcntl.LOCK_EX):
            # `holder` has the lock for a moment, and shares it; a study does not.
            if not _lock(file, fcntl.LOCK_SH) or time.monotonic() > patience:
                raise InputError(
                    "out", str(directory), f"is in use by {_user(file)}; wait for it, or name another"
                )
            fcntl.flock(file, fcntl.LOCK_UN)
            time.sleep(_PAUSE)
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()} since {_now()} ({command})\n")
        file.flush()
        try:
            yield
        finally:
            file.truncate(0)


def _lock(file: TextIO, kind: int) -> bool:
    """Lock a file, or tell that others have a lock that does not allow it."""
    try:
        fcntl.flock(file, kind | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _user(file: TextIO) -> str:
    """Return who says in a lock file to hold it."""
    file.seek(0)
    return file.read().strip() or "another process"


def _make(directory: Path) -> None:
    """Make the directory, if need be, and make sure that nothing in it would be lost."""
    from kswarms.scenarios.study.parquet import SCHEMAS

    make_directory(directory)
    if not (directory / FILE).exists():
        for name in SCHEMAS:
            if (directory / f"{name}.parquet").exists():
                told = f"has a {name}.parquet but no {FILE}; name another"
                raise InputError("out", str(directory), told)


def _about(command: str) -> dict[str, Any]:
    """Return what is to be known of a session that begins."""
    needed = [
        re.split(r"[^\w.-]", text)[0] for text in metadata.requires("kswarms") or () if "extra ==" not in text
    ]
    return {
        "command": command,
        "started": _now(),
        "status": "running, or killed",
        "kswarms": __version__,
        "code": code_version(),
        "python": platform.python_version(),
        "libraries": {name: metadata.version(name) for name in needed},
        "machine": {"system": platform.platform(), "processor": platform.machine(), "cpus": os.cpu_count()},
    }


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
