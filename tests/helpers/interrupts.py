"""End of processes that a test starts."""

import time
from contextlib import suppress
from pathlib import Path


def wait_for_end_of_group(group: int) -> None:
    """Wait until no process of a process group runs; fail after some seconds."""
    deadline = time.monotonic() + 10
    while any(_runs(stat, group) for stat in Path("/proc").glob("[0-9]*/stat")):
        assert time.monotonic() < deadline, "processes are left"
        time.sleep(0.05)


def _runs(stat: Path, group: int) -> bool:
    with suppress(OSError):
        state, _parent, its_group = stat.read_text().rpartition(")")[2].split()[:3]
        return int(its_group) == group and state != "Z"
    return False
