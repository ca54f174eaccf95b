"""Merging of studies, such as the shards of one sweep."""

from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from pathlib import Path

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.lock import lock_holder
from kswarms.scenarios.study.mixtures import Contents, refuse_mixtures
from kswarms.scenarios.study.parquet import check_tables
from kswarms.scenarios.study.study import Study


def merge_studies(
    out: Path, directories: Sequence[Path], command: str = "", allow_mixed: bool = False
) -> list[Path]:
    """Add the runs of studies to a study, new or existing; return the paths of its tables.

    A finished run is kept, whatever the other studies have of it. The tables are those of a study that played
    all runs, byte for byte.

    Parameters
    ----------
    out : Path
        Directory of the study that gets the runs.
    directories : sequence of Path
        Directories of the other studies, which are only read.
    command : str
        The command line, for the manifest and the lock.
    allow_mixed : bool
        Whether runs of several environments may be mixed.

    Raises
    ------
    InputError
        If a directory has no ledger of this version, or is in use; if the runs must not be mixed; or if two
        studies have different results of a run. Nothing is written then.
    OSError
        If a ledger is damaged (nothing is written), or writing fails.
    """
    with ExitStack() as stack:
        parts = [stack.enter_context(_open_part(directory)) for directory in directories]
        for directory in directories:
            if directory.resolve() == out.resolve():
                raise InputError("dir", str(directory), "must be another directory than OUT")
        held = [stack.enter_context(_open_part(out))] if (out / LEDGER_FILE).exists() else []
        _refuse_conflicts([*held, *parts], allow_mixed)
        for ledger in held:
            ledger.close()
        study = stack.enter_context(Study(out, command, allow_mixed))
        study.merge(parts)
    return study.tables


def _open_part(directory: Path) -> Ledger:
    """Open a ledger to read it, and check all of its content."""
    if holder := lock_holder(directory):
        raise InputError("dir", str(directory), f"is in use by {holder}; wait until it ends")
    ledger = Ledger(directory / LEDGER_FILE)
    try:
        ledger.check()
        check_tables(ledger)
    except BaseException:
        ledger.close()
        raise
    return ledger


def _refuse_conflicts(ledgers: Iterable[Ledger], allow_mixed: bool) -> None:
    """Raise an `InputError` if the runs must not be mixed, or a run has different results."""
    held = Contents({__version__}, set(), {})
    results: dict[str, tuple[bytes, Path]] = {}
    for ledger in ledgers:
        directory, added = ledger.path.parent, ledger.contents()
        refuse_mixtures(str(directory), added, held, "others have", allow_mixed)
        held = Contents(held.versions, held.environments | added.environments, held.curves | added.curves)
        for run, result in ledger.result_digests():
            other, first = results.setdefault(run, (result, directory))
            if other != result:
                raise InputError("run", run, f"has different results in {first} and {directory}")
