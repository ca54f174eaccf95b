"""A study: a directory of results that keeps every run, can be resumed and has one writer at a time.

The ledger is the source of truth. A session is the use of a `Study` in one ``with`` block. When it ends, the
tables and the manifest are written from the ledger.
"""

import os
import platform
import re
from collections.abc import Generator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, closing, suppress
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any, Self

from kswarms import __version__
from kswarms.agents.common.input_files import to_path
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.outcome import Outcome, Result, environment
from kswarms.scenarios.runs.run import Order, Run, code_version, describe_curve, expand, select_shard
from kswarms.scenarios.runs.sweep import sweep
from kswarms.scenarios.signals import deferred_signals
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.outputs import locked_directory, write_manifest, write_tables
from kswarms.scenarios.study.parquet import pack


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
        self.directory = to_path("out", directory)
        self.tables: list[Path] = []
        self._command = command
        self._allow_mixed = allow_mixed
        self._session: int | None = None

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stack.enter_context(locked_directory(self.directory, self._command, create=True))
            self._ledger = stack.enter_context(Ledger(self.directory / LEDGER_FILE, create=True))
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
            self.tables = write_tables(self._ledger, self.directory)
            self._update_session(status=_status(error), ended=_now())

    def plan(
        self,
        scenarios: Sequence[Scenario],
        first_seed: int = 0,
        records: Sequence[str] = (),
        shard: tuple[int, int] = (1, 1),
    ) -> list[Run]:
        """Add scenarios to the study; return their unfinished runs.

        Parameters
        ----------
        first_seed : int
            Seed of the first game at each density, ≥ 0.
        records : sequence of str
            Names of tables (`RECORDED_TABLES`). A run without one of them counts as unfinished.
        shard : tuple of int
            Number of the part to play, from 1, and number of parts (see `select_shard`).

        Raises
        ------
        InputError
            If the directory has runs of another version, of another environment (unless `allow_mixed`), or
            of a different curve of the same name.
        """
        runs = select_shard(expand(scenarios, first_seed), *shard)
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
            shard="{}/{}".format(*shard),
            records=list(records),
            runs={"requested": len(runs), "done before": len(runs) - len(waiting)},
        )
        return waiting

    def merge(self, others: Sequence[Ledger]) -> None:
        """Add the content of other ledgers, which `kswarms.scenarios.study.merge` has checked."""
        self._ledger.merge(others)
        self._update_session(merged=[str(other.path.parent) for other in others])

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
        order: Order = "longest",
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
        order : {'longest', 'seeds'}
            Whether the longest runs are played first, or all runs of the first seed.

        Raises
        ------
        RunError
            If the executor breaks, or a worker has another environment and `allow_mixed` is False.
        """
        text = ",".join(records)
        with closing(sweep(runs, jobs, text, executor, run_limit, order)) as results:
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
        write_manifest(self._ledger, self.directory)


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
