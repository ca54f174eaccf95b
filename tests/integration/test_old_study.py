"""A study of kswarms 0.1.0 can be read but not resumed."""

import shutil
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms import __version__
from kswarms.scenarios.cli import invoke

STUDY = Path(__file__).parents[1] / "data" / "study-0.1.0"
OLD = f"0.1.0, this is {__version__}"


@pytest.fixture(autouse=True)
def _old_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(STUDY, "old")


def test_its_status_and_report_can_be_read(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["status", "old"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].split() == ["old", "2", "0", "0", "0.0", "s"]
    assert "played by: kswarms 0.1.0 f9366bb03ec1, 2 runs" in lines
    assert invoke(["report", "old"]) == 0
    assert Path("old/report.html").stat().st_size > 0


def test_its_runs_cannot_be_replayed_and_it_accepts_no_new_runs(capsys: pytest.CaptureFixture[str]) -> None:
    before = {path.name: path.read_bytes() for path in STUDY.iterdir()}
    run = pq.read_table("old/runs.parquet")["run"][0].as_py()
    assert invoke(["replay", "old", run]) == 2
    assert capsys.readouterr().err == f"kswarms: run={run!r}: was played by kswarms {OLD}\n"
    assert invoke(["run", "fig-6.1c", "--densities", "6", "--seeds", "1", "--out", "old"]) == 2
    (refusal,) = capsys.readouterr().err.splitlines()
    assert refusal.startswith("kswarms: results='old/ledger.sqlite': must be a ledger of kswarms (format 1")
    assert refusal.endswith(" can be read, not resumed; use another directory)")
    for name in before.keys() - {"ledger.sqlite"}:
        assert Path("old", name).read_bytes() == before[name]
