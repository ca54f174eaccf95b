"""Number of CPUs that this process may use, as batch systems and containers limit it."""

import math
import os
from collections.abc import Iterator
from pathlib import Path


def available_cpus(root: Path = Path("/")) -> int:
    """Return the number of CPUs of the affinity mask, or the quota of the control groups if it is lower.

    A fraction of a CPU counts as one. `root` is the root of the file system.
    """
    cpus = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return math.ceil(min([cpus, *_quotas(root)]))


def _quotas(root: Path) -> Iterator[float]:
    """Yield the quotas (CPUs) of the control groups of this process and of their ancestors."""
    try:
        groups = (root / "proc/self/cgroup").read_text().splitlines()
    except (OSError, ValueError):
        return
    mounts = root / "sys/fs/cgroup"
    for group in groups:
        _, controllers, path = group.split(":", 2)
        if controllers and "cpu" not in controllers.split(","):
            continue
        for mount in (mounts / "cpu",) if controllers else (mounts, mounts / "unified"):
            inside = mount / path.lstrip("/")
            folders = (inside, *inside.parents)
            yield from (_quota(folder) for folder in folders if folder.is_relative_to(mount))


def _quota(folder: Path) -> float:
    """Return the quota (CPUs) of a control group of version 2 or 1; infinity if it has none."""
    try:
        if (folder / "cpu.max").exists():
            quota, period = (folder / "cpu.max").read_text().split()
        else:
            quota, period = ((folder / f"cpu.cfs_{name}_us").read_text() for name in ("quota", "period"))
        cpus = int(quota) / int(period)
    except (OSError, ValueError, ZeroDivisionError):  # a quota may be "max"
        return math.inf
    return cpus if cpus > 0 else math.inf
