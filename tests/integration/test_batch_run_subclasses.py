"""Subclasses in `mesa.batch_run`: own steps, own ends, own reporters; seeds and ends of games in its rows."""

from collections.abc import Iterator
from typing import Any

import mesa
import pytest
import simpy
from mesa import DataCollector

from kswarms import ForagingModel, read_results
from kswarms.agents.robot.krembot import Krembot
from tests.helpers.mesa_versions import repetitions, sample_labels

Row = dict[str, Any]


def run(model: type[ForagingModel], period: int = 1, iterations: int = 1, **parameters: Any) -> list[Row]:
    """Run games of six robots; `period` is the data collection period."""
    given = {"n": 6, "duration": 60.0, "policies": "avoid,avoid"} | parameters
    rows: list[Row] = mesa.batch_run(
        model,
        given,
        number_processes=1,
        **repetitions(iterations),
        data_collection_period=period,
        max_steps=given.pop("max_steps", 1000),
        display_progress=False,
    )
    return rows


# Seeds and ends.


def test_iterations_without_seeds_are_different_games_that_can_be_replayed() -> None:
    rows = run(ForagingModel, -1, iterations=4, policies=["avoid,avoid", "attack,avoid"])
    assert len({row["run_seed"] for row in rows}) == 8
    for row in rows[::3]:
        model = ForagingModel(n=6, duration=60.0, policies=row["policies"], seed=row["run_seed"])
        model.play()
        assert [row["t_p_1"], row["t_p_2"]] == [result["t_p"] for result in model.results()]
    assert len(read_results(rows).runs) == 16


def test_seeds_of_the_parameters_are_in_the_rows() -> None:
    rows = run(ForagingModel, -1, seed=[3, "4", None], duration=10.0)
    assert [row["seed"] for row in rows] == [3, "4", None]
    assert [row["run_seed"] for row in rows[:2]] == [3, 4]
    runs = read_results(rows).runs
    assert set(runs["seed"]) == {row["run_seed"] for row in rows}


def test_a_game_that_is_cut_is_not_reported_as_ended() -> None:
    (row,) = run(ForagingModel, -1, max_steps=3, seed=1)
    assert (row["ended"], row["time"]) == ("running", 30.0)
    with pytest.raises(ValueError, match="a game was stopped before its end"):
        read_results([row])


# Games that end early.


class UntilTwoPucks(ForagingModel):
    """Stops when two pucks are deposited."""

    def step(self) -> None:
        """Play a sampling period."""
        super().step()
        if sum(self.pucks) >= 2:
            self.running = False


class StoppedByTheClock(ForagingModel):
    """Stops in the middle of a step."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.env.process(self._stop_at(33.0))

    def _stop_at(self, time: float) -> Iterator[simpy.Event]:
        yield self.env.timeout(self.controller.periods(time))
        self.running = False


class StoppedAtOnce(ForagingModel):
    """Stops before the first step."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.running = False


class OwnPeriods(ForagingModel):
    """Steps of one control period each, up to the first deposit."""

    def step(self) -> None:
        """Play one control period."""
        self.env.run(until=self.now + 1)
        self.running = not any(self.pucks)


@pytest.mark.parametrize("record", ["model", "model,agents", "agents,model,trajectory"])
@pytest.mark.parametrize("model", [UntilTwoPucks, StoppedByTheClock, OwnPeriods])
@pytest.mark.parametrize("period", [1, -1])
def test_the_last_row_of_a_stopped_game_is_that_of_its_stop(
    model: type[ForagingModel], period: int, record: str
) -> None:
    twin = model(n=6, duration=600.0, policies="avoid,avoid", seed=1, record=record)
    twin.play()
    assert (twin.ended, twin.running) == ("", False)
    rows = run(model, period, duration=600.0, seed=1, record=record)
    last = rows[-1]
    assert last["ended"] == "stopped"
    assert last["time"] == twin.time < 600.0
    assert last["pucks_1"] + last["pucks_2"] == sum(twin.pucks)
    if "agents" in record:
        assert (last["x"], last["y"]) == tuple(twin.robots[-1].position)
    steps = sorted({row["Step"] for row in rows})
    assert steps == sample_labels(twin.sample_times)[0 if period == 1 else -1 :]
    assert {row["ended"] for row in rows if row["Step"] < steps[-1]} <= {"running"}


def test_a_game_stopped_at_once_has_one_row() -> None:
    (row,) = run(StoppedAtOnce)
    assert row["time"] == 0.0


# Reporters, in the ways of Mesa.


class AddsByName(ForagingModel):
    """Adds a reporter to the dictionary of the collector."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.count = 0
        self.datacollector.model_reporters["twice"] = lambda model: 2 * model.count
        self.datacollector._new_model_reporter("count", "count")
        self.datacollector._new_model_reporter("sum", [sum, [[1, 2]]])
        self.datacollector._new_agent_reporter("own", lambda robot: robot.unique_id)
        self.datacollector._new_agenttype_reporter(Krembot, "number", "number")

    def step(self) -> None:
        """Play a sampling period and count it."""
        super().step()
        self.count += 1


class Replaces(AddsByName):
    """Replaces the collector and leaves it to the model to collect."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.datacollector = DataCollector(
            {"twice": lambda model: 2 * model.count, "count": "count", "ended": lambda model: model.ended},
            {"own": "unique_id"},
        )


class CollectsItself(Replaces):
    """Replaces the collector and collects at the start and after each step, as models of Mesa do."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.datacollector.collect(self)

    def step(self) -> None:
        """Play a sampling period and collect."""
        super().step()
        self.datacollector.collect(self)


class CollectsFirst(Replaces):
    """Collects before each step."""

    def step(self) -> None:
        """Collect and play a sampling period."""
        self.datacollector.collect(self)
        super().step()


class CollectsTwice(AddsByName):
    """Collects in the collector of the model."""

    def step(self) -> None:
        """Play a sampling period and collect."""
        super().step()
        self.datacollector.collect(self)
        self.datacollector.collect(self)


@pytest.mark.parametrize("model", [AddsByName, Replaces, CollectsItself, CollectsFirst, CollectsTwice])
@pytest.mark.parametrize("record", ["model", "conflicts,trajectory", "", "model,agents"])
def test_reporters_of_subclasses_have_a_value_in_each_row(model: type[ForagingModel], record: str) -> None:
    rows = [row for row in run(model, seed=1, record=record) if "own" in row]  # Mesa 3.5 adds agenttype rows
    of_first = [row for row in rows if row["AgentID"] == 1]
    assert [(row["Step"], row["count"], row["twice"]) for row in of_first] == [
        (label, k, 2 * k) for k, label in enumerate(sample_labels(range(0, 70, 10)))
    ]
    assert len(rows) == 7 * 6
    assert all(row["own"] == row["AgentID"] for row in rows)
    played = model(n=6, duration=60.0, seed=1, record=record)
    played.play()
    frame = played.datacollector.get_model_vars_dataframe()
    assert frame["count"].tolist() == list(range(7))
    plain = ForagingModel(n=6, duration=60.0, seed=1, record=record)
    plain.play()
    assert played.tables() == plain.tables()
    assert played.results() == plain.results()


def test_reporters_may_be_removed_and_added_during_a_game() -> None:
    model = ForagingModel(n=6, duration=60.0, seed=1)
    model.step()
    del model.datacollector.model_reporters["time"]
    model.datacollector.model_reporters["now"] = "now"
    model.play()
    frame = model.datacollector.get_model_vars_dataframe()
    assert "time" not in frame
    assert frame["now"].iloc[2:].tolist() == [200, 300, 400, 500, 600]
    assert frame["now"].iloc[:2].isna().all()


def test_a_user_may_collect_at_any_time() -> None:
    model = ForagingModel(n=6, duration=200.0, policies="avoid,avoid", seed=1)
    while model.running:
        model.datacollector.collect(model)
        assert model.datacollector.model_vars["time"][-1] == model.time
        assert model.datacollector.model_vars["pucks_1"][-1] == model.pucks[0]
        model.step()
        assert model.datacollector.model_vars["time"] == model.sample_times
    assert model.pucks[0] > 0


def test_rows_collected_at_one_instant_have_the_state_of_their_collection() -> None:
    model = ForagingModel(n=6, seed=1)
    model.running = False
    model.datacollector.collect(model)
    assert model.datacollector.model_vars["ended"] == ["running", "stopped"]
