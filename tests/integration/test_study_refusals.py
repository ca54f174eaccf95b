"""A study refuses directories in use or with other content, and runs that must not be mixed."""

import fcntl
import json
import os
import shutil
import sqlite3
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.condition import Condition, SwarmRule
from kswarms.scenarios.study import lock
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.lock import LOCK_FILE, lock_holder
from kswarms.scenarios.study.study import Study
from kswarms.scenarios.watch.recorded_run import recorded_run
from tests.helpers.tiny_study import RUN, TINY, read_sessions, read_tables

pytestmark = pytest.mark.usefixtures("tiny_file")

RESULTS = Path("results")


def test_a_directory_in_use_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with Study(RESULTS, "kswarms run tiny.toml") as study:
        study.plan([TINY])
        holder = lock_holder(RESULTS)
        assert holder.startswith(f"process {os.getpid()} on ")
        assert holder.endswith("(kswarms run tiny.toml)")
        assert invoke(RUN) == 2
        reason = f"is in use by {holder}; wait, or use another directory"
        assert capsys.readouterr().err == f"kswarms: out='results': {reason}\n"
        assert invoke(["status", "results"]) == 0
        assert f"in use by: {holder}" in capsys.readouterr().out
    assert lock_holder(RESULTS) == ""
    assert invoke([*RUN, "--seeds", "1"]) == 0


def test_a_study_waits_for_a_query_of_the_lock(monkeypatch: pytest.MonkeyPatch) -> None:
    with Study(RESULTS):
        pass
    (RESULTS / LOCK_FILE).write_text("process 1")  # left by a process that was killed
    with (RESULTS / LOCK_FILE).open() as query:
        fcntl.flock(query, fcntl.LOCK_SH)  # as `lock_holder` does
        monkeypatch.setattr(time, "sleep", lambda _: fcntl.flock(query, fcntl.LOCK_UN))
        with Study(RESULTS):
            monkeypatch.setattr(lock, "_TIMEOUT", 0.0)
            with pytest.raises(InputError, match=f"is in use by process {os.getpid()} on"):
                Study(RESULTS).__enter__()
        fcntl.flock(query, fcntl.LOCK_SH)
        with pytest.raises(InputError, match="is in use by another process"):
            Study(RESULTS).__enter__()


@pytest.mark.parametrize("foreign", ["runs.parquet", "policies.parquet"])
def test_tables_without_a_ledger_are_not_replaced(foreign: str) -> None:
    RESULTS.mkdir()
    (RESULTS / foreign).write_text("my jogging diary")
    with pytest.raises(InputError, match=f"or one that kswarms wrote; it has '{foreign}'"):
        Study(RESULTS).__enter__()
    assert (RESULTS / foreign).read_text() == "my jogging diary"
    assert [path.name for path in RESULTS.iterdir()] == [foreign]


def test_another_kind_of_ledger_is_refused_and_unchanged() -> None:
    for name in ("text", "other"):
        Path(name).mkdir()
    Path("text", LEDGER_FILE).write_text("my jogging diary")
    with sqlite3.connect(Path("other", LEDGER_FILE)) as db:
        db.execute("CREATE TABLE jogging (km REAL)")
    db.close()
    shutil.copytree("other", "later")
    with sqlite3.connect(Path("later", LEDGER_FILE)) as db:
        db.executescript("PRAGMA application_id = 1802729325; PRAGMA user_version = 3")
    db.close()
    for name, reason in (
        ("text", "file is not"),
        ("other", "of another program"),
        ("later", "format 3, not 2"),
    ):
        before = Path(name, LEDGER_FILE).read_bytes()
        with pytest.raises(InputError, match=rf"='{name}/{LEDGER_FILE}': must be a ledger of.*\({reason}"):
            Study(Path(name)).__enter__()
        assert Path(name, LEDGER_FILE).read_bytes() == before


def test_a_different_curve_of_the_same_name_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RUN, "--seeds", "2"]) == 0
    before = read_tables("results")
    longer = tuple(condition.replace(duration=3.0) for condition in TINY.conditions)
    # Another density, so that the two curves have no point in common.
    Path("tiny.toml").write_text(TINY.replace(conditions=longer, densities=(8,)).to_toml())
    assert invoke(RUN) == 2
    refusal = "out='results': has runs of a different tiny; use another directory, or another id"
    assert capsys.readouterr().err == f"kswarms: {refusal}\n"
    assert read_tables("results") == before
    assert len(read_sessions()) == 1
    Path("tiny.toml").write_text(TINY.replace(conditions=longer, id="longer", seeds=2).to_toml())
    assert invoke(RUN) == 0
    assert set(pq.read_table("results/runs.parquet")["scenario"].to_pylist()) == {"tiny", "longer"}


def test_a_curve_differs_when_its_file_of_learned_policies_does(tmp_path: Path) -> None:
    arm = {"opponent": 1, "action": "fight", "reward": 1.0, "time": 1.0, "count": 1.0, "q": 0.1}
    file = tmp_path / "learned.json"
    content = {"format": "kswarms-policies-1", "swarm": 2, "robots": [[arm]]}
    file.write_text(json.dumps(content))
    swarms = (SwarmRule(policy="avoid"), SwarmRule(policy=f"learned(file='{file}')"))
    loading = TINY.replace(conditions=(Condition(swarms=swarms, duration=1.0),), seeds=1)
    with Study(RESULTS) as study:
        (run, *_) = study.plan([loading])
    file.write_text(json.dumps(content | {"robots": [[arm | {"action": "flight"}]]}))
    with Study(RESULTS) as study, pytest.raises(InputError, match="has runs of a different tiny"):
        study.plan([loading.replace(densities=(8,))])
    with pytest.raises(InputError, match="loads a file that has changed"):
        recorded_run(RESULTS, run.digest)


def test_runs_of_another_version_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with Study(RESULTS) as study:
        (run, *_) = study.plan([TINY])
    for module in ("runs.run", "study.ledger"):
        monkeypatch.setattr(f"kswarms.scenarios.{module}.__version__", "9.0.0")
    reason = f"has runs of kswarms {__version__}, this is 9.0.0; use another directory"
    with Study(RESULTS) as study, pytest.raises(InputError, match=reason):
        study.plan([TINY])
    with pytest.raises(InputError, match=f"was played by kswarms {__version__}, this is 9.0.0"):
        recorded_run(RESULTS, run.digest)


def test_runs_of_other_code_are_kept_and_reported(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        for module in ("study.ledger", "runs.play", "runs.sweep"):
            patch.setattr(f"kswarms.scenarios.{module}.code_version", lambda: "0.1.0 before")
        assert invoke([*RUN, "--seeds", "1"]) == 0
        assert capsys.readouterr().err == ""
    assert invoke([*RUN, "--seeds", "1"]) == 0
    assert capsys.readouterr().err.startswith("kswarms: results has runs of other code, 0.1.0 before; ")
    assert invoke(["status", "results"]) == 0
    assert "played by: kswarms 0.1.0 before, 4 runs" in capsys.readouterr().out
