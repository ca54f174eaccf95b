"""Export: tables from the ledger without playing; what is wrong in a ledger is refused in one line."""

import json
import re
import shutil
import signal
import sqlite3
from contextlib import closing
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study import outputs
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.lock import directory_lock
from tests.helpers.tiny_study import RUN, read_tables

pytestmark = pytest.mark.usefixtures("tiny_file")

OLD = Path(__file__).parents[1] / "data" / "study-0.1.0"


def change(statement: str, *values: object) -> None:
    with closing(sqlite3.connect(Path("results", LEDGER_FILE))) as db, db:
        db.execute(statement, values)


@pytest.fixture
def played(tiny_file: None) -> None:
    assert invoke([*RUN, "--seeds", "1"]) == 0


@pytest.mark.usefixtures("played")
def test_lost_files_are_written_again() -> None:
    before, manifest = read_tables("results"), Path("results/manifest.json").read_text()
    for path in (*Path("results").glob("*.parquet"), Path("results/manifest.json")):
        path.unlink()
    assert invoke(["export", "results"]) == 0
    assert read_tables("results") == before
    assert Path("results/manifest.json").read_text() == manifest


def test_a_study_of_version_0_1_0_is_exported() -> None:
    shutil.copytree(OLD, "old")
    ledger = Path("old", LEDGER_FILE).read_bytes()
    for name in ("runs", "policies"):
        Path(f"old/{name}.parquet").unlink()
    assert invoke(["export", "old"]) == 0
    assert Path("old", LEDGER_FILE).read_bytes() == ledger
    for name in ("runs", "policies"):
        assert pq.read_table(f"old/{name}.parquet").equals(pq.read_table(OLD / f"{name}.parquet"))
    manifest = json.loads(Path("old/manifest.json").read_text())
    assert manifest["kswarms"] == "0.1.0"
    assert manifest["environments"] == {}


@pytest.mark.usefixtures("played")
def test_directories_in_use_or_of_others_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine").mkdir()
    for name in ("mine", "nowhere", "tiny.toml"):
        assert invoke(["export", name]) == 2
        assert "must be a directory with a ledger.sqlite" in capsys.readouterr().err
    assert list(Path("mine").iterdir()) == []
    assert not Path("nowhere").exists()
    with directory_lock(Path("results"), "kswarms run tiny.toml"):
        assert invoke(["export", "results"]) == 2
    assert "is in use by process" in capsys.readouterr().err


@pytest.mark.usefixtures("played")
@pytest.mark.parametrize("moment", ["before", "between"])
def test_a_signal_leaves_all_tables_or_none(moment: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = read_tables("results")
    change("UPDATE runs SET status = 'failed' WHERE run IN (SELECT run FROM points WHERE n = 6)")
    place, name = (outputs, "export") if moment == "before" else (Path, "replace")
    real = getattr(place, name)

    def stop(first: Ledger | Path, target: Path) -> object:
        result = real(first, target)
        if moment == "before" or target.suffix == ".parquet":
            signal.raise_signal(signal.SIGTERM)
        return result

    with monkeypatch.context() as patch:
        patch.setattr(place, name, stop)
        assert invoke(["export", "results"]) == 143
    assert not list(Path("results").glob(".unfinished*"))
    if moment == "before":
        assert read_tables("results") == before
    else:
        assert all(a != b for a, b in zip(read_tables("results"), before, strict=True))


def rows(**values: object) -> str:
    """Return a result of a game with other values in its first row."""
    (text,) = sqlite3.connect(Path("results", LEDGER_FILE)).execute("SELECT swarms FROM runs").fetchone()
    first, *rest = json.loads(text)
    return json.dumps([first | values, *rest])


DOCTORED = [
    ("swarms", lambda: rows(pucks="many")),
    ("swarms", lambda: rows(size=-1)),
    ("swarms", lambda: rows(pucks=1.5)),
    ("swarms", lambda: rows(pucks=2**70)),
    ("swarms", lambda: rows(t_p=float("inf"))),
    ("swarms", lambda: rows(duration=float("nan"))),
    ("swarms", lambda: rows(policy=None)),
    ("swarms", lambda: rows(policy="\ud800")),
    ("swarms", lambda: rows(ended=["time"])),
    ("swarms", lambda: "[" * 2000 + "]" * 2000),
    ("swarms", lambda: "5"),
    ("swarms", lambda: '{"swarm": 1}'),
    ("swarms", lambda: "[1, 2]"),
    ("swarms", lambda: None),
    ("swarms", lambda: b"\xff\x00"),
    ("swarms", lambda: "1" * 5000),
    ("policies", lambda: '[{"swarm": 1}]'),
    ("policies", lambda: "[null]"),
]
STATEMENTS = [
    "UPDATE points SET scenario = '../../escaped'",
    "UPDATE points SET scenario = char(27) || '[31m'",
    "UPDATE points SET n = -n",
    "UPDATE points SET n = 'six' || n",
    "UPDATE records SET rows = '/etc/passwd'",
    "UPDATE records SET rows = x'00'",
    "UPDATE records SET rows = ''",
    "UPDATE curves SET description = '[]'",
    'UPDATE curves SET description = \'{"condition": {"grid_point": [["../x", 1]]}}\'',
    'UPDATE curves SET description = \'{"condition": {"grid_point": 7}}\'',
    "UPDATE sessions SET about = '[]'",
    "UPDATE sessions SET about = '[' || about",
    "DROP TABLE records",
]


def assert_refused(capsys: pytest.CaptureFixture[str], what: str = "") -> None:
    before = read_tables("results")
    capsys.readouterr()
    assert invoke(["export", "results"]) in (1, 2), what
    (line,) = capsys.readouterr().err.splitlines()
    assert len(line) < 400
    assert re.match("kswarms: (results=')?results/ledger.sqlite'?: ", line)
    assert read_tables("results") == before
    assert not list(Path("results").glob(".unfinished*"))


@pytest.mark.usefixtures("played")
def test_doctored_results_are_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    original = Path("results", LEDGER_FILE).read_bytes()
    for column, value in DOCTORED:
        new = value()
        change(f"UPDATE runs SET {column} = ? WHERE run = (SELECT MIN(run) FROM runs)", new)
        assert_refused(capsys, repr(new))
        Path("results", LEDGER_FILE).write_bytes(original)


@pytest.mark.usefixtures("played")
@pytest.mark.parametrize("statement", STATEMENTS)
def test_doctored_tables_are_refused_in_one_line(statement: str, capsys: pytest.CaptureFixture[str]) -> None:
    change(statement)
    assert_refused(capsys)
