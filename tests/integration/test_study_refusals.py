"""What a study refuses: a directory in use or of something else, and runs that do not mix."""

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
from tests.helpers.tiny_study import RUN, TINY, contents, sessions

pytestmark = pytest.mark.usefixtures("with_a_file_of_scenarios")

# ------------------------------------------------------------------------------------------ who may play here


def test_two_sweeps_on_one_directory_do_not_meet(capsys: pytest.CaptureFixture[str]) -> None:
    with Study(Path("results"), "kswarms run tiny.toml") as study:
        study.plan([TINY])
        user = lock_holder(Path("results"))
        assert user.startswith(f"process {os.getpid()} on ")
        assert invoke(RUN) == 2
        refusal = capsys.readouterr().err
        assert refusal == f"kswarms: out='results': is in use by {user}; wait, or use another directory\n"
        assert "(kswarms run tiny.toml)" in refusal
        assert invoke(["status", "results"]) == 0
        assert f"in use by: {user}" in capsys.readouterr().out
    assert lock_holder(Path("results")) == ""
    assert invoke(RUN) == 0


def test_a_holder_query_does_not_refuse_a_study(monkeypatch: pytest.MonkeyPatch) -> None:
    with Study(Path("results")):
        pass
    Path("results", LOCK_FILE).write_text("process 1")  # left by a process that was killed
    with Path("results", LOCK_FILE).open() as query:
        fcntl.flock(query, fcntl.LOCK_SH)  # as `lock_holder` does
        monkeypatch.setattr(time, "sleep", lambda _: fcntl.flock(query, fcntl.LOCK_UN))
        with Study(Path("results")):
            monkeypatch.setattr(lock, "_TIMEOUT", 0.0)
            with pytest.raises(InputError, match=f"is in use by process {os.getpid()} on"):
                Study(Path("results")).__enter__()
        fcntl.flock(query, fcntl.LOCK_SH)
        with pytest.raises(InputError, match="is in use by another process"):
            Study(Path("results")).__enter__()


@pytest.mark.parametrize("foreign", ["runs.parquet", "policies.parquet"])
def test_tables_without_their_ledger_are_not_replaced(
    foreign: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("results").mkdir()
    Path("results", foreign).write_text("my jogging diary")
    assert invoke(RUN) == 2
    assert capsys.readouterr().err == (
        f"kswarms: out='results': has a {foreign} but no ledger.sqlite; use another directory\n"
    )
    assert Path("results", foreign).read_text() == "my jogging diary"
    assert [path.name for path in Path("results").iterdir()] == [foreign]


def test_a_ledger_of_something_else_is_refused_and_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    Path("text").mkdir()
    Path("text", LEDGER_FILE).write_text("my jogging diary")
    Path("other").mkdir()
    with sqlite3.connect(Path("other", LEDGER_FILE)) as db:
        db.execute("CREATE TABLE jogging (km REAL)")
    db.close()
    shutil.copytree("other", "later")
    with sqlite3.connect(Path("later", LEDGER_FILE)) as db:
        db.executescript("PRAGMA application_id = 1803772781; PRAGMA user_version = 2")
    db.close()
    for name, reason in (("text", "file is not"), ("other", "it is not"), ("later", "format 2, not 1")):
        before = Path(name, LEDGER_FILE).read_bytes()
        assert invoke([*RUN, "--out", name]) == 2
        assert f"='{name}/{LEDGER_FILE}': must be a ledger of kswarms ({reason}" in capsys.readouterr().err
        assert Path(name, LEDGER_FILE).read_bytes() == before


# ------------------------------------------------------------------------------------------ what does not mix


def test_a_curve_described_otherwise_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RUN, "--seeds", "2"]) == 0
    before = contents("results")
    longer = tuple(condition.replace(duration=3.0) for condition in TINY.conditions)
    # Other densities, so that no point of the curve is there already.
    Path("tiny.toml").write_text(TINY.replace(conditions=longer, densities=(8,)).to_toml())
    assert invoke(RUN) == 2
    refusal = "out='results': has runs of a different tiny; use another directory, or another id"
    assert capsys.readouterr().err == f"kswarms: {refusal}\n"
    assert contents("results") == before
    assert len(sessions("results")) == 1
    Path("tiny.toml").write_text(TINY.replace(conditions=longer, id="longer").to_toml())
    assert invoke(RUN) == 0
    assert set(pq.read_table("results/runs.parquet")["scenario"].to_pylist()) == {"tiny", "longer"}


def test_learned_policies_that_changed_make_another_curve(tmp_path: Path) -> None:
    arm = {"opponent": 1, "action": "fight", "reward": 1.0, "time": 1.0, "count": 1.0, "q": 0.1}
    file = tmp_path / "learned.json"
    content = {"format": "kswarms-policies-1", "swarm": 2, "robots": [[arm]]}
    file.write_text(json.dumps(content))
    swarms = (SwarmRule(policy="avoid"), SwarmRule(policy=f"learned(file='{file}')"))
    loading = TINY.replace(conditions=(Condition(swarms=swarms, duration=1.0),), seeds=1)
    with Study(Path("results")) as study:
        (run, *_) = study.plan([loading])
    file.write_text(json.dumps(content | {"robots": [[arm | {"action": "flight"}]]}))
    with Study(Path("results")) as study, pytest.raises(InputError, match="has runs of a different tiny"):
        study.plan([loading.replace(densities=(8,))])
    with pytest.raises(InputError, match="loads a file that has changed"):
        recorded_run(Path("results"), run.digest)


def test_runs_of_another_version_are_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0
    before = contents("results")
    for module in ("runs.run", "study.ledger", "study.study"):
        monkeypatch.setattr(f"kswarms.scenarios.{module}.__version__", "9.0.0")
    version = __version__
    assert invoke(RUN) == 2
    assert capsys.readouterr().err == (
        f"kswarms: out='results': has runs of kswarms {version}, this is 9.0.0; use another directory\n"
    )
    assert contents("results") == before


def test_runs_of_other_code_are_told_of(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        for module in ("study.ledger", "runs.play", "runs.sweep"):
            patch.setattr(f"kswarms.scenarios.{module}.code_version", lambda: "0.1.0 before")
        assert invoke([*RUN, "--seeds", "1"]) == 0
        assert capsys.readouterr().err == ""
    assert invoke(RUN) == 0
    assert capsys.readouterr().err == (
        "kswarms: results keeps runs of other code, 0.1.0 before; name another --out to play them again\n"
    )
    assert invoke(["status", "results"]) == 0
    assert "played by: kswarms 0.1.0 before, 4 runs" in capsys.readouterr().out
