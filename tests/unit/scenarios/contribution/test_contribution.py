"""Contributions: games with and without each robot."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import WLU, IndividualUtility
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.scenarios.contribution.games import RECORD, contributions, parse_robots
from kswarms.scenarios.contribution.table import FILE, SCHEMA, prepare_table, write_table
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run, digest
from kswarms.scenarios.runs.sweep import play_all

LEARNER = "inter-learner(reward='individual(delta=0.2)')"
GAME = Game(
    swarms=(Swarm(policy="attack", size=4), Swarm(policy=LEARNER, size=3)), learning=60.0, duration=60.0
)


def count_conflicts(conflicts: Any, swarms: int) -> list[float]:
    """Return a number for each swarm, in place of its SUD in time-utility; games have different numbers."""
    return [float(len(conflicts["phase"]) + swarm) for swarm in range(swarms)]


def play_game(game: Game, seed: int) -> GameModel:
    model = GameModel(game, seed, record=RECORD)
    model.play()
    return model


@pytest.mark.parametrize(
    ("text", "robots"),
    [(None, range(7)), ("S2", (4, 5, 6)), ("3", (3,)), (" 5, 0,5", (0, 5)), ("6,S1", (0, 1, 2, 3, 6))],
)
def test_robots_are_selected_by_number_or_swarm(text: str | None, robots: Sequence[int]) -> None:
    assert parse_robots(GAME, text) == tuple(robots)


@pytest.mark.parametrize("text", ["7", "-1", "S3", "S0", "s1", "1.0", "01", "all", "", "1,,2", "1-3"])
def test_unknown_robots_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"^robots='.*': must be robots, 0 to 6, or swarms, S1, S2$"):
        parse_robots(GAME, text)


@pytest.mark.parametrize("absent_from", ["learning", "game"])
def test_the_compared_games_equal_games_played_separately(absent_from: Any) -> None:
    rows = contributions(GAME, [1, 5], [3, 4], absent_from, ("a", "b"), time_sud=count_conflicts)
    assert [(row["seed"], row["robot"]) for row in rows] == [(3, 1), (3, 5), (4, 1), (4, 5)]
    for row in rows:
        assert set(row) == set(SCHEMA.names)
        assert (row["scenario"], row["condition"], row["n"], row["absent_from"]) == ("a", "b", 7, absent_from)
        swarm = 1 if row["robot"] < 4 else 2
        assert (row["swarm"], row["policy"]) == (swarm, "attack" if swarm == 1 else LEARNER)
        lacking = GAME.replace(absent=(row["robot"],), absent_from=absent_from)
        for game, ending in ((GAME, ""), (lacking, "_without")):
            model = play_game(game, row["seed"])
            assert row[f"run{ending}"] == digest(game, row["seed"])
            assert row[f"sud{ending}"] == model.results()[swarm - 1]["sud"]
            assert row[f"time_sud{ending}"] == count_conflicts(model.tables()["conflicts"], 2)[swarm - 1]
            assert row[f"duration{ending}"] == 60.0
            for others, k in (("mates", swarm), ("opponents", 3 - swarm)):
                times = [each.times() for each in model.members[k - 1] if each.number != row["robot"]]
                t_a, t_p = sum(sum(periods) for periods, _ in times), sum(periods for _, periods in times)
                assert row[f"{others}_t_a{ending}"] == pytest.approx(0.1 * t_a)
                assert row[f"{others}_t_p{ending}"] == pytest.approx(0.1 * t_p)


def test_the_reward_is_a_sum_over_conflicts_of_the_measured_game() -> None:
    rows = {row["robot"]: row for row in contributions(GAME, [0, 6], [2])}
    table = play_game(GAME, 2).tables()["conflicts"]
    conflicts = [dict(zip(table, values, strict=True)) for values in zip(*table.values(), strict=True)]
    measured = [row for row in conflicts if row["phase"] == "game"]
    for robot, swarm, reward in ((0, 1, WLU()), (6, 2, IndividualUtility(delta=0.2))):
        own = [row for row in measured if row["robot"] == robot]
        assert {row["opponent_swarm"] for row in own} == {1, 2}
        expected = sum(
            reward.of(
                *(row["t_a"], row["t_p"], row["active"], 1 if row["action"] == "fight" else -1),
                *(row["opponent_swarm"] != swarm, row["opponent_swarm"]),
            )
            for row in own
        )
        assert rows[robot]["reward"] == pytest.approx(expected)
        assert rows[robot]["reward_time"] == pytest.approx(sum(row["t_a"] + row["t_p"] for row in own))
        for others, name in ((swarm, "mates"), (3 - swarm, "opponents")):
            met = sum(row["t_a"] for row in measured if row["opponent"] == robot and row["swarm"] == others)
            assert rows[robot][f"{name}_t_a_met"] == pytest.approx(met) != 0.0


def test_action_and_program_time_have_the_same_sum_in_games_of_equal_length() -> None:
    for row in contributions(GAME, [2], [0, 1]):
        assert row["time_sud"] != row["time_sud"]  # NaN without a measure
        for others in ("mates", "opponents"):
            freed = row[f"{others}_t_a"] - row[f"{others}_t_a_without"]
            assert row[f"{others}_t_p_without"] - row[f"{others}_t_p"] == pytest.approx(freed, abs=1e-6)


def test_absence_from_the_learning_changes_the_game() -> None:
    rows = [contributions(GAME, [1], [0, 1, 2], way) for way in ("learning", "game")]
    assert [row["sud"] for row in rows[0]] == [row["sud"] for row in rows[1]]
    assert [row["mates_t_a_without"] for row in rows[0]] != [row["mates_t_a_without"] for row in rows[1]]


def test_robots_outside_the_game_and_games_with_absent_robots_are_refused() -> None:
    for robot in (7, -1):
        with pytest.raises(InputError, match=r"absent=.*: must be a robot of the game, 0 to 6"):
            contributions(GAME, [robot], [0])
    with pytest.raises(InputError, match=r"absent=\(3,\): must be empty"):
        contributions(GAME.replace(absent=(3,)), [1], [0])


def test_the_order_of_outcomes_does_not_change_the_result() -> None:
    def play_backwards(runs: Sequence[Run]) -> Iterator[tuple[Run, Outcome]]:
        yield from reversed(list(play_all(runs, record=RECORD)))

    measure = partial(contributions, GAME, [0, 5], [0, 1], time_sud=count_conflicts)
    assert measure() == measure(play=play_backwards)
    assert measure() != contributions(GAME, [0, 5], [2, 3], time_sud=count_conflicts)


def rows(**changes: Any) -> list[dict[str, Any]]:
    values = {"string": "x", "int64": 1, "double": 0.5}
    plain: dict[str, Any] = {name: values[str(SCHEMA.field(name).type)] for name in SCHEMA.names}
    plain["absent_from"] = "game"
    return [{**plain, "robot": robot, **changes} for robot in (2, 0)]


def test_a_table_keeps_the_rows_of_other_games(tmp_path: Path) -> None:
    prepare_table(tmp_path)
    for part in (rows(), rows(n=26), rows(absent_from="learning"), rows(seed=7)):
        prepare_table(tmp_path)
        path = write_table(tmp_path, part)
    assert path == tmp_path / FILE
    assert list(tmp_path.iterdir()) == [path]
    table = pq.read_table(path)
    assert table.schema.equals(SCHEMA)
    found = [(row["absent_from"], row["n"], row["seed"], row["robot"]) for row in table.to_pylist()]
    # The last part has replaced the first.
    games = (("game", 1, 7), ("game", 26, 1), ("learning", 1, 1))
    assert found == [(*game, robot) for game in games for robot in (0, 2)]


def test_temporary_files_of_killed_processes_are_removed(tmp_path: Path) -> None:
    (tmp_path / ".unfinished-0123456789abcdef.parquet").write_text("half a table")  # not locked
    prepare_table(tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_foreign_file_is_refused_and_kept(tmp_path: Path) -> None:
    pq.write_table(pa.table({"mine": [1]}), tmp_path / FILE)
    contents = {b"mine": "must be a readable Parquet file", (tmp_path / FILE).read_bytes(): "missing columns"}
    (tmp_path / FILE).unlink()
    write_table(tmp_path, rows())
    extended = pq.read_table(tmp_path / FILE).append_column("mine", [[1, 2]])
    pq.write_table(extended, tmp_path / FILE)
    contents[(tmp_path / FILE).read_bytes()] = "must have the columns of a table of contributions only"
    for content, message in contents.items():
        (tmp_path / FILE).write_bytes(content)
        before = (tmp_path / FILE).read_bytes()
        with pytest.raises(InputError, match=message):
            prepare_table(tmp_path)
        assert (tmp_path / FILE).read_bytes() == before


def test_a_failed_write_leaves_the_table_unchanged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_table(tmp_path, rows())
    before = path.read_bytes()

    monkeypatch.setattr(Path, "replace", lambda *_: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        write_table(tmp_path, rows(n=3))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
