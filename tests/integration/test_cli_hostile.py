"""The command line against odd numbers, odd titles and damaged results: one line, and nothing lost."""

import os
import re
import sqlite3
import sys
from pathlib import Path

import pytest

from kswarms.scenarios.cli import invoke
from kswarms.scenarios.study.database import LEDGER_FILE

QUICK = ["--densities", "6", "--seeds", "1", "--jobs", "1", "--quiet"]
SCENARIO = """
id = "mine"
title = "TITLE"
densities = [6]
seeds = 1
[[conditions]]
name = "TITLE"
duration = 5
swarms = [{ policy = "avoid" }, { policy = "attack" }]
[[conditions]]
duration = 5
swarms = [{ policy = "attack" }, { policy = "attack" }]
"""
MOST = 2**53


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (
            "run fig-6.1a --first-seed 99999999999999999999",
            f"first_seed=99999999999999999999: must be at least 0, at most {MOST}",
        ),
        ("run fig-6.1a --seeds 1000001", "seeds=1000001: must be less than or equal to 1000000"),
        (f"run fig-6.1a --densities 6,{10**400}", f"n={10**400}: must be at most 1000000 (fig-6.1a)"),
        (f"film fig-6.1a --n {10**400}", f"n={10**400}: must be at most 1000000"),
        ("run fig-6.1a --jobs 999999", "jobs=999999: must be at least 1, at most 1024"),
        ("run fig-6.1a --scheduler nowhere", "scheduler='nowhere': must be the address of a Dask scheduler"),
        ("run fig-6.1a --out=", "out='': must be the path of a directory"),
        ("contribution fig-6.1a --n 6 --out=", "out='': must be the path of a directory"),
        ("calibrate --out=", "out='': must be the path of a directory"),
        (
            "contribution fig-6.1a --n 6 --seeds 99999999",
            "seeds=99999999: must be at least 1, at most 1000000",
        ),
        ("contribution fig-6.1a --n 6 --seeds 0", "seeds=0: must be at least 1, at most 1000000"),
        ("contribution fig-6.1a --n 6 --first-seed -1", f"first_seed=-1: must be at least 0, at most {MOST}"),
        ("calibrate --seeds 99999999", "seeds=99999999: must be less than or equal to 1000"),
        ("calibrate --generations 99999999", "generations=99999999: must be less than or equal to 10000"),
        (
            "film fig-6.1a --n 6 --seed 9007199254740993",
            f"seed=9007199254740993: must be at least 0, at most {MOST}",
        ),
        (
            "film fig-6.1a --n 6 --out a.gif --speed 1e-300",
            "speed=1e-300: must be so high that there are at most",
        ),
        ("conflicts fig-6.1a --n 6 --from nan", "from=nan: must be a number of seconds"),
        ("conflicts fig-6.1a --n 6 --to nan", "to=nan: must be a number of seconds, at least -inf"),
        ("conflicts fig-6.1a --n 6 --from 9 --to 5", "to=5.0: must be a number of seconds, at least 9"),
    ],
)
def test_a_number_or_path_out_of_range_is_one_line_and_nothing_is_written(
    words: str, complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"kswarms: {complaint}")
    assert not list(Path.cwd().iterdir())


def test_what_is_no_number_is_refused_by_every_option_that_takes_one(
    capsys: pytest.CaptureFixture[str],
) -> None:
    tried = set()
    for command in ("run", "calibrate", "explore", "film", "conflicts", "contribution"):
        assert invoke([command, "--help"]) == 0
        for option, kind in re.findall(r"--(\S+) (<int>|<float>|K )", capsys.readouterr().out):
            for value in ("soon", "", "1.5" if kind != "<float>" else "1,5"):
                assert invoke([command, f"--{option}", value]) == 2
                (line,) = capsys.readouterr().err.splitlines()
                field, number = option.replace("-", "_"), "number" if kind == "<float>" else "integer"
                assert line.startswith(f"kswarms: {field}={value!r}: must be a valid {number}")
            tried.add(f"{command} --{option}")
    assert {"run --seeds", "explore --port", "film --sheet", "conflicts --from", "calibrate --jobs"} < tried
    assert not list(Path.cwd().iterdir())


@pytest.mark.parametrize("title", ["$x^{ costs $", "漢字", "../../a/b", "<b>&amp;", "_x"])
def test_whatever_a_title_says_it_is_drawn_and_reported(
    title: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("mine.toml").write_text(SCENARIO.replace("TITLE", title), encoding="utf-8")
    assert invoke(["run", "mine.toml", *QUICK]) == 0
    assert capsys.readouterr().err == ""
    assert Path("results", "figures", "mine.png").stat().st_size > 0
    assert invoke(["report", "results"]) == 0
    assert [path.name for path in Path.cwd().iterdir() if path.name not in ("mine.toml", "results")] == []


def test_a_film_is_called_by_its_curve_and_stays_in_its_directory() -> None:
    Path("mine.toml").write_text(SCENARIO.replace("TITLE", "../../a/b"))
    assert invoke(["film", "mine.toml", "--sheet", "1", "--to", "1"]) == 0
    assert {path.name for path in Path.cwd().iterdir()} == {"mine.toml", "mine-..-..-a-b-n6-seed0.png"}


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE runs SET swarms = 'nonsense'",
        "UPDATE runs SET swarms = '[{}]'",
        "UPDATE records SET rows = x'00'",
        "UPDATE sessions SET about = 'nonsense'",
    ],
)
def test_a_damaged_ledger_is_told_in_a_line_and_the_tables_stay_as_they_were(
    statement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["run", "fig-6.1a", *QUICK, "--no-figures", "--record", "robots"]
    assert invoke(command) == 0
    before = Path("results", "runs.parquet").read_bytes()
    with sqlite3.connect(Path("results", LEDGER_FILE)) as ledger:
        ledger.execute(statement)
    ledger.close()
    assert invoke(command) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "ledger.sqlite: is damaged (" in line
    assert Path("results", "runs.parquet").read_bytes() == before
