"""The default number of worker processes respects the affinity mask and the quotas of control groups."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kswarms.scenarios.cli.cpus import available_cpus

MEMORY = "4:memory:/job\n"


@pytest.fixture(autouse=True)
def affinity(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the affinity mask have eight CPUs."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)))


@pytest.mark.parametrize(
    ("groups", "files", "cpus"),
    [
        ("0::/\n", {}, 8),
        ("0::/\n", {"cpu.max": "max 100000"}, 8),
        ("0::/\n", {"cpu.max": "300000 100000"}, 3),
        ("0::/\n", {"cpu.max": "250000 100000"}, 3),
        ("0::/\n", {"cpu.max": "1000 100000"}, 1),
        ("0::/\n", {"cpu.max": "6400000 100000"}, 8),
        ("0::/user/job\n", {"user/job/cpu.max": "400000 100000", "user/cpu.max": "max 100000"}, 4),
        ("0::/user/job\n", {"user/job/cpu.max": "max 100000", "user/cpu.max": "200000 100000"}, 2),
        ("0::/not/mounted\n", {"cpu.max": "200000 100000"}, 2),
        ("0::/../outside\n", {"cpu.max": "200000 100000"}, 2),
        (f"{MEMORY}0::/job\n", {"unified/job/cpu.max": "500000 100000"}, 5),
        (f"{MEMORY}0::/job\n", {"job/cpu.max": "garbage"}, 8),
        (f"{MEMORY}0::/job\n", {"job/cpu.max": "100000 0"}, 8),
        (
            f"{MEMORY}3:cpu,cpuacct:/job\n0::/\n",
            {"cpu/job/cpu.cfs_quota_us": "600000", "cpu/job/cpu.cfs_period_us": "100000"},
            6,
        ),
        ("3:cpu:/job\n", {"cpu/cpu.cfs_quota_us": "150000\n", "cpu/cpu.cfs_period_us": "100000\n"}, 2),
        ("3:cpu:/job\n", {"cpu/job/cpu.cfs_quota_us": "-1", "cpu/job/cpu.cfs_period_us": "100000"}, 8),
        ("3:cpuset:/job\n", {"cpu/job/cpu.cfs_quota_us": "1", "cpu/job/cpu.cfs_period_us": "1"}, 8),
        ("3:cpu:/a:b\n", {"cpu/a:b/cpu.cfs_quota_us": "4", "cpu/a:b/cpu.cfs_period_us": "1"}, 4),
    ],
)
def test_the_lowest_quota_of_a_group_and_its_ancestors_counts(
    tmp_path: Path, groups: str, files: dict[str, str], cpus: int
) -> None:
    (tmp_path / "proc/self").mkdir(parents=True)
    (tmp_path / "proc/self/cgroup").write_text(groups)
    for name, text in files.items():
        file = tmp_path / "sys/fs/cgroup" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    assert available_cpus(tmp_path) == cpus


def test_a_system_without_control_groups_has_the_cpus_of_the_affinity_mask(tmp_path: Path) -> None:
    assert available_cpus(tmp_path) == 8


def test_the_default_of_jobs_is_the_number_of_available_cpus() -> None:
    code = (
        "import os; os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:1]);"
        "from kswarms.scenarios.cli.options import CPUS; print(CPUS)"
    )
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("1\n", "")
