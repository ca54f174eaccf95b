"""Shards, orders of play and merging: the tables are those of one study that plays all runs."""

import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from kswarms.model.game_model import GameModel
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.runs.run import expand, select_shard, sort_runs
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.lock import directory_lock
from kswarms.scenarios.study.study import Study
from tests.helpers.tiny_study import RUN, TINY, Fault, read_sessions, read_tables, uninterrupted_tables

pytestmark = pytest.mark.usefixtures("tiny_file")

OLD = Path(__file__).parents[1] / "data" / "study-0.1.0"
RUNS = expand([TINY, CATALOGUE["fig-6.1a"].replace(seeds=3)])


def change(directory: str, statement: str) -> None:
    with closing(sqlite3.connect(Path(directory, LEDGER_FILE))) as db, db:
        db.execute(statement)


def files(*directories: str) -> dict[Path, bytes]:
    """Return the content of files, except locks."""
    paths = [path for name in directories for path in Path(name).rglob("*") if path.is_file()]
    return {path: path.read_bytes() for path in paths if path.name != "lock"}


@pytest.mark.parametrize("parts", [1, 2, 7, 200])
def test_shards_hold_each_run_once_and_have_similar_efforts(parts: int) -> None:
    shards = [select_shard(RUNS, part, parts) for part in range(1, parts + 1)]
    assert sorted(run.digest for shard in shards for run in shard) == sorted(run.digest for run in RUNS)
    efforts = [sum(run.effort for run in shard) for shard in shards]
    assert max(efforts) - min(efforts) <= max(run.effort for run in RUNS) * 1.001
    assert [select_shard(RUNS[::-1], part, parts)[::-1] for part in range(1, parts + 1)] == shards


def test_runs_are_sorted_by_effort_or_first_by_seed() -> None:
    efforts = [run.effort for run in sort_runs(RUNS, "longest")]
    assert efforts == sorted(efforts, reverse=True)
    keys = [(run.seed, -run.effort) for run in sort_runs(RUNS, "seeds")]
    assert keys == sorted(keys)
    assert sorted(keys) == sorted((run.seed, -run.effort) for run in RUNS)


@pytest.mark.parametrize("text", ["0/3", "4/3", "1", "1/0", "-1/3", "a/b", "1/3/5", "", "²/3"])
def test_shards_that_do_not_exist_are_refused(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RUN, f"--shard={text}"]) == 2
    assert "must be K/M, part K of M parts, such as 3/16" in capsys.readouterr().err
    assert not Path("results").exists()


def test_merged_shards_have_the_tables_of_one_study(before_games: Callable[[Fault], None]) -> None:
    whole = uninterrupted_tables()
    games = []
    before_games(games.append)
    for part in ("1", "2", "3"):
        assert invoke([*RUN, "--shard", f"{part}/3", "--order", "seeds", "--out", part]) == 0
    assert len(games) == 40
    before = files("1", "2", "3")
    assert invoke(["merge", "all", "1", "2"]) == 0
    assert read_tables("all") != whole
    assert invoke(["merge", "all", "3", "1"]) == 0  # into an existing study, one part again
    assert read_tables("all") == whole
    assert files("1", "2", "3") == before
    shards = [session["shard"] for session in read_sessions("all") if "shard" in session]
    assert shards == ["1/3", "2/3", "3/3"]
    assert read_sessions("all")[-1]["merged"] == ["3", "1"]
    assert invoke([*RUN, "--out", "all"]) == 0
    assert len(games) == 40  # nothing is left to play


def test_the_order_of_play_does_not_change_tables(before_games: Callable[[Fault], None]) -> None:
    seeds = []
    before_games(lambda model: seeds.append(model.seed))
    assert invoke([*RUN, "--order", "seeds"]) == 0
    assert seeds == sorted(seeds)
    assert read_tables("results") == uninterrupted_tables()


def test_finished_runs_win_over_failed_and_missing_ones(
    before_games: Callable[[Fault], None], capsys: pytest.CaptureFixture[str]
) -> None:
    def fault(model: GameModel) -> None:
        raise ZeroDivisionError

    words = [*RUN, "--seeds", "1"]
    assert invoke([*words, "--out", "done"]) == 0
    before_games(fault)
    assert invoke([*words, "--out", "failed"]) == 1
    with Study(Path("missing")) as study:
        study.plan([TINY.replace(seeds=1)])
    for k, order in enumerate((["done", "failed", "missing"], ["missing", "failed", "done"])):
        assert invoke(["merge", f"all{k}", *order]) == 0
        assert read_tables(f"all{k}") == read_tables("done")
    assert invoke(["merge", "bad", "missing", "failed"]) == 0
    assert not list(Path("bad").glob("*.parquet"))
    capsys.readouterr()
    assert invoke(["status", "bad"]) == 0
    assert capsys.readouterr().out.splitlines()[1].split()[:4] == ["tiny", "0", "4", "0"]


REFUSED = {
    "UPDATE runs SET swarms = replace(swarms, 'pucks\": 0', 'pucks\": 9')": "has different results in",
    "UPDATE runs SET environment = 'Python 2.7'": "has runs of Python 2.7, others have Python 3.",
    "UPDATE runs SET version = '9.0'": "has runs of kswarms 9.0, others have",
    "UPDATE curves SET description = '{\"condition\": {}}'": "has runs of a different tiny",
    "UPDATE runs SET swarms = 'nonsense'": "is damaged",
    "UPDATE records SET rows = x'00' WHERE rowid = 3": "is damaged",
    "UPDATE points SET run = 'none'": "is damaged (points",
    "DROP TABLE games": "the table games is missing",
    "PRAGMA application_id = 5": "of another program",
}


@pytest.mark.parametrize("statement", REFUSED)
@pytest.mark.parametrize("new", [True, False])
def test_inputs_that_do_not_fit_are_refused_before_anything_is_written(
    statement: str, new: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*RUN, "--seeds", "1", "--out", "a"]) == 0
    shutil.copytree("a", "b")
    if not new:
        shutil.copytree("a", "all")
    change("b", statement)
    before = files("a", "b", "all")
    capsys.readouterr()
    assert invoke(["merge", "all", "a", "b"]) in (1, 2)
    (line,) = capsys.readouterr().err.splitlines()
    assert REFUSED[statement] in line
    assert files("a", "b", "all") == before


def test_mixed_environments_are_merged_on_request() -> None:
    assert invoke([*RUN, "--shard", "1/2", "--out", "a"]) == 0
    assert invoke([*RUN, "--shard", "2/2", "--out", "b"]) == 0
    change("b", "UPDATE runs SET environment = 'Python 2.7'")
    assert invoke(["merge", "all", "a", "b"]) == 2
    assert invoke(["merge", "all", "a", "b", "--allow-mixed"]) == 0
    assert read_tables("all") == uninterrupted_tables()


def test_directories_in_use_or_without_a_ledger_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*RUN, "--seeds", "1", "--out", "a"]) == 0
    Path("empty").mkdir()
    for directories, reason in (
        (["a", "empty"], "must be a directory with a ledger.sqlite"),
        (["a", "nowhere"], "must be a directory with a ledger.sqlite"),
        (["a", "./a"], "must be another directory"),
        (["a", str(OLD)], "has runs of kswarms 0.1.0, others have"),
    ):
        assert invoke(["merge", "a" if "./a" in directories else "all", *directories]) == 2
        assert reason in capsys.readouterr().err
    with directory_lock(Path("a"), "a sweep"):
        assert invoke(["merge", "all", "a"]) == 2
        assert "is in use by process" in capsys.readouterr().err
    assert not Path("all").exists()
