"""Damaged and doctored ledgers: every command that reads them ends with one line, and changes nothing."""

import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study.database import LEDGER_FILE
from tests.helpers.tiny_study import PLAIN_RUN, RUN, TINY

pytestmark = pytest.mark.usefixtures("tiny_file")

GAME = "UPDATE games SET description = ? WHERE id = (SELECT game FROM runs LIMIT 1)"
COMMANDS = ("status bad", "replay bad RUN", "conflicts bad --run RUN", " ".join([*PLAIN_RUN, "--out", "bad"]))


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Return the directory of a study, and the digest of one of its runs."""
    directory = tmp_path_factory.mktemp("study")
    toml = directory / "tiny.toml"
    toml.write_text(TINY.replace(seeds=1, densities=(4,)).to_toml())
    assert invoke([RUN[0], str(toml), *RUN[2:], "--out", str(directory / "good")]) == 0
    with closing(sqlite3.connect(directory / "good" / LEDGER_FILE)) as db:
        ((run,),) = db.execute("SELECT run FROM runs LIMIT 1")
    return directory / "good", run


@pytest.mark.parametrize(
    ("statement", "value", "refusing"),
    [
        (GAME, "[" * 2000, "replay conflicts"),
        (GAME, '{"n": NaN}', "replay conflicts"),
        (GAME, "[3]", "replay conflicts"),
        ("UPDATE runs SET swarms = ?", "{" * 2000, "replay run"),
        ("UPDATE runs SET swarms = ?", '{"a":' * 2000, "replay run"),
        ("UPDATE runs SET swarms = ?", '[{"swarm": NaN}]', "replay run"),
        ("UPDATE runs SET swarms = ?", "[]", "replay run"),
        ("UPDATE runs SET swarms = replace(swarms, '\"swarm\": 2', '\"swarm\": ' || ?)", 99, "replay run"),
        ("UPDATE runs SET policies = ?", "3", "replay run"),
        ("UPDATE runs SET swarms = ?", None, "replay run"),
        ("UPDATE runs SET seed = ?", "x", "status replay conflicts run"),
        ("UPDATE runs SET seconds = ?", float("inf"), "status replay conflicts run"),
        ("UPDATE runs SET code = ?", b"\xff\x00", "status replay conflicts run"),
        ("UPDATE runs SET code = ?", "a" * 1000, "status replay conflicts run"),
        ("UPDATE runs SET environment = ?", "Python 3.12, " * 1000, "status replay conflicts run"),
        ("UPDATE runs SET error = ?", "\x1b[2J\nred", ""),
        ("UPDATE points SET scenario = ?", b"\xff", "status replay conflicts run"),
        ("DELETE FROM points WHERE run != ?", "", "replay conflicts"),
        ("UPDATE points SET n = ?", -(2**62), "run"),
        ("UPDATE records SET rows = ?", b"junk", "run"),
        ("UPDATE records SET rows = ?", 7, "status replay conflicts run"),
        ("UPDATE sessions SET about = ?", "null", "status run"),
        ("UPDATE sessions SET about = ?", "{}", ""),
        ("UPDATE curves SET description = ?", '{"condition": 3}', "run"),
        ("DROP TABLE games -- ?", None, "status replay conflicts run"),
        ("ALTER TABLE runs RENAME COLUMN status TO state -- ?", None, "status replay run"),
    ],
)
def test_a_doctored_ledger_is_one_line(
    statement: str,
    value: object,
    refusing: str,
    study: tuple[Path, str],
    capsys: pytest.CaptureFixture[str],
) -> None:
    shutil.copytree(study[0], "bad")
    with closing(sqlite3.connect(Path("bad", LEDGER_FILE))) as db, db:
        db.execute(statement, (value,) if not statement.endswith("-- ?") else ())
    ledger = Path("bad", LEDGER_FILE).read_bytes()
    refused = []
    for command in COMMANDS:
        status = invoke(command.replace("RUN", study[1]).split())
        lines = capsys.readouterr().err.splitlines()
        if status:
            refused.append(command.split()[0])
            assert len(lines) == 1
            assert lines[0].isprintable()
        if not command.startswith("run"):
            assert Path("bad", LEDGER_FILE).read_bytes() == ledger
    assert " ".join(refused) == refusing


def test_a_ledger_that_lacks_pages_is_one_line(
    study: tuple[Path, str], capsys: pytest.CaptureFixture[str]
) -> None:
    whole = (study[0] / LEDGER_FILE).read_bytes()
    Path("bad").mkdir()
    for content in (whole[:5000], whole[:4096] + b"\xff" * 4096 + whole[8192:], whole[:100], b"", b"SQLite"):
        Path("bad", LEDGER_FILE).write_bytes(content)
        for command in COMMANDS[:3]:
            assert invoke(command.replace("RUN", study[1]).split()) in (1, 2)
            assert len(capsys.readouterr().err.splitlines()) == 1
        assert [path.name for path in Path("bad").iterdir()] == [LEDGER_FILE]
        assert Path("bad", LEDGER_FILE).read_bytes() == content
