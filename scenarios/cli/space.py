"""Disk space of recorded trajectories, estimated before they are recorded."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.printing import format_size
from kswarms.scenarios.runs.run import Run, expected_duration
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger

_TABLE: Final = "trajectory"
_LEDGER_ROW: Final = 28.0
"""Size of a row of the table in the ledger (bytes), measured; as the next two."""
_LEDGER_RUN: Final = 2000.0
"""Size of a run in the ledger in addition to its rows (bytes)."""
_PARQUET_ROW: Final = 30.0
"""Size of a row in the Parquet file (bytes)."""


class Size(NamedTuple):
    """Estimated size of the trajectories of runs."""

    rows: int
    ledger: float
    """Size in the ledger (bytes)."""
    parquet: float
    """Size of the Parquet file (bytes)."""


def trajectory_size(runs: Sequence[Run]) -> Size:
    """Estimate the size of the trajectories of runs: a row for each robot and sample."""
    rows = 0
    for run in runs:
        game = run.game
        duration = game.learning + expected_duration(run.n, game.duration, game.puck_limit)
        rows += run.n * (int(duration / game.sample_period) + 1)
    return Size(rows, rows * _LEDGER_ROW + len(runs) * _LEDGER_RUN, rows * _PARQUET_ROW)


def describe_trajectories(out: Path, runs: Sequence[Run], records: Sequence[str]) -> str:
    """Return the estimated size of the trajectories that are still to be recorded in a directory.

    `InputError` if the disk has less free space.
    """
    if (out / LEDGER_FILE).is_file():
        with Ledger(out / LEDGER_FILE) as ledger:
            runs = ledger.unfinished(runs, records)
    size = trajectory_size(runs)
    present = out / f"{_TABLE}.parquet"  # it is replaced when the new file is complete
    needed = size.ledger + size.parquet + (present.stat().st_size if present.is_file() else 0)
    disk = next(path for path in (out, *out.absolute().parents) if path.is_dir())
    free = shutil.disk_usage(disk).free
    if runs and needed > free:
        rule = f"needs about {format_size(needed)}, and the disk of {out} has {format_size(free)} free: play"
        raise InputError("record", _TABLE, f"{rule} fewer runs, or with a longer sample_period")
    places = f"{format_size(size.ledger)} in {LEDGER_FILE}, {format_size(size.parquet)} in {present.name}"
    return f"{_TABLE}: about {size.rows:,} rows of {len(runs):,} runs, {places} ({format_size(free)} free)"
