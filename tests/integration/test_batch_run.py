"""Sweeps with Mesa's batch runner, from a script, in one process and in two."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import mesa
import pytest

from kswarms.model.foraging import ForagingModel
from tests.helpers.mesa_versions import HAS_RNG, sample_labels

SCRIPT = """
import json

import mesa

from kswarms.model.foraging import ForagingModel

def sweep(processes, period):
    return mesa.batch_run(
        ForagingModel,
        {"n": [6, 13], "policies": ["avoid,attack", "mixed"], "seed": range(2), "puck_limit": [0, 1],
         "duration": 47.0},
        number_processes=processes,
        data_collection_period=period,
        display_progress=False,
    )

if __name__ == "__main__":
    print(json.dumps(sweep(2, 1)))
"""

Row = dict[str, Any]


def run_here(period: int) -> list[Row]:
    """Run the sweep of the script in this process; its rows are those of JSON."""
    names: dict[str, Any] = {"__name__": "sweep"}
    exec(SCRIPT, names)
    return in_order(json.loads(json.dumps(names["sweep"](1, period))))


def in_order(rows: list[Row]) -> list[Row]:
    return sorted(rows, key=lambda row: (row["RunId"], row["Step"]))


def run_script(folder: Path) -> list[Row]:
    """Run the script with two processes in a new interpreter, outside the repository."""
    script = folder / "sweep.py"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, "-W", "error", str(script)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return in_order(json.loads(done.stdout))


def play_game(row: Row) -> ForagingModel:
    """Return the game of a row, played directly."""
    names = ("n", "policies", "seed", "puck_limit")
    model = ForagingModel(duration=47.0, **{name: row[name] for name in names})
    model.play()
    return model


@pytest.mark.slow
def test_two_processes_give_the_rows_of_one(tmp_path: Path) -> None:
    one = run_here(1)
    assert run_script(tmp_path) == one
    assert len({row["RunId"] for row in one}) == 16
    steps = [(row["Step"], row["time"]) for row in one if row["RunId"] == 0]
    times = [0.0, 10.0, 20.0, 30.0, 40.0, 47.0]
    assert steps == list(zip(sample_labels(times), times, strict=True))
    # All samples of each run are there, with the one at its end.
    ends = {row["RunId"]: row for row in one}
    for row in ends.values():
        model = play_game(row)
        samples = [other["time"] for other in one if other["RunId"] == row["RunId"]]
        assert samples == model.sample_times
        assert row["time"] == model.time
        assert row["pucks_1"] == model.pucks[0]
    assert len({row["time"] for row in ends.values()}) > 2


def test_the_last_row_is_the_state_at_the_end() -> None:
    rows = run_here(-1)  # −1: the last sample of each run only
    assert [row["RunId"] for row in rows] == list(range(16))
    assert {row["time"] for row in rows if row["puck_limit"] == 0} == {47.0}
    for row in rows:
        for result in play_game(row).results():
            k = result.pop("swarm")
            assert (row["game_time"], row["ended"]) == (result.pop("duration"), result.pop("ended"))
            assert row["duration"] == 47.0  # the argument
            assert {name: row[f"{name}_{k}"] for name in result} == result
            time_in_action = result["t_a_intra"] + result["t_a_inter"]
            share = time_in_action / (time_in_action + result["t_p"])
            assert (row[f"share_a_{k}"], row[f"share_p_{k}"]) == pytest.approx((share, 1 - share))


def test_agents_have_rows() -> None:
    rows = mesa.batch_run(
        ForagingModel,
        {"n": 4, "duration": 20.0, "record": "agents", "policies": "avoid,avoid"},
        number_processes=1,
        data_collection_period=1,
        display_progress=False,
    )
    labels = sample_labels([0.0, 10.0, 20.0])
    assert [(row["Step"], row["AgentID"]) for row in rows] == [(s, a) for s in labels for a in (1, 2, 3, 4)]
    assert [row["swarm"] for row in rows[:4]] == [1, 1, 2, 2]
    assert all({"state", "puck", "x", "y", "heading"} <= row.keys() for row in rows)
    assert rows[0]["x"] != rows[-4]["x"]


@pytest.mark.skipif(not HAS_RNG, reason="Mesa 3.5 and later")
def test_seeds_may_be_given_as_rng() -> None:
    given = {"n": 4, "duration": 20.0, "policies": ["avoid,avoid", "avoid,attack"]}
    options: Row = {"number_processes": 1, "data_collection_period": -1, "display_progress": False}
    rows = mesa.batch_run(ForagingModel, given, rng=[3, 4], **options)
    assert [(row["rng"], row["run_seed"]) for row in rows] == [(3, 3), (3, 3), (4, 4), (4, 4)]
    same = mesa.batch_run(ForagingModel, given | {"seed": [3, 4]}, **options)
    key = ("policies", "run_seed", "t_p_1")
    assert {tuple(row[name] for name in key) for row in same} == {
        tuple(row[name] for name in key) for row in rows
    }
