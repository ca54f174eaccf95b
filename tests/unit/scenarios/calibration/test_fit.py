"""Calibration on synthetic games: result, validation, interruption."""

import json
import math
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import bootstrap_interval
from kswarms.model.description.parameters import parse_parameters
from kswarms.scenarios.calibration import fit
from kswarms.scenarios.calibration import shares as shares_module
from kswarms.scenarios.calibration.fit import Setup, error_of
from kswarms.scenarios.calibration.games import START, learning_game, texts_of, to_candidate, to_position
from kswarms.scenarios.runs.run import Run

TARGET = {("avoid", 6): 10.0, ("avoid", 30): 60.0, ("attack", 6): 2.0, ("attack", 30): 30.0}
TINY = Setup(
    free=("friction", "gamma"), densities=(6,), seeds=1, generations=3, population=4, validation_seeds=6
)
Played = Generator[tuple[Run, float], None, None]


def calibrate(setup: Setup, play: Any, out: Path, fresh: bool = False) -> dict[str, Any]:
    return fit.calibrate(setup, TARGET, play, bootstrap_interval, out, fresh)


def share(run: Run, friction: float, distance: float = START["conflict_distance"]) -> float:
    """Return a share that equals the table if friction and conflict distance have these values."""
    opponent, n = run.game.swarms[0].policy, run.n
    world = run.game.parameters
    off = abs(math.log(world.friction / friction)) + abs(math.log(world.conflict_distance / distance))
    noise = np.random.default_rng([run.seed, n, len(opponent)]).normal(0.0, 0.03)
    return TARGET[opponent, n] / 100 + 0.3 * off + noise


class FakePlay:
    """Plays runs: yields synthetic shares, records the runs, and is interrupted after some of them."""

    def __init__(self, stop_after: float = math.inf, backwards: bool = False, **truth: float) -> None:
        self.runs: list[Run] = []
        self._stop_after, self._backwards = stop_after, backwards
        self._truth = truth or {"friction": 0.27}

    def __call__(self, runs: Sequence[Run]) -> Played:
        for run in reversed(runs) if self._backwards else runs:
            if len(self.runs) >= self._stop_after:
                raise KeyboardInterrupt
            self.runs.append(run)
            yield run, share(run, **self._truth)


def trace_of(out: Path) -> dict[str, Any]:
    return dict(json.loads((out / "calibration.json").read_text()))


def test_the_error_compares_means_over_seeds() -> None:
    shares = np.array([[0.1, 0.3], [0.5, 0.5], [1.0, 0.0]])
    assert error_of(shares.mean(axis=1), np.array([10.0, 65.0, 50.0])) == pytest.approx((10 + 15 + 0) / 3)


def test_the_search_finds_the_values_behind_the_table(tmp_path: Path) -> None:
    setup = Setup(free=("friction", "conflict_distance", "gamma"), densities=(6, 30), seeds=2, generations=30)
    table = FakePlay(friction=0.27, distance=0.1)
    trace = calibrate(setup, table, tmp_path)
    found = trace["generations"][-1]["mean"]
    assert found["friction"] == pytest.approx(0.27, rel=0.1)
    assert found["conflict_distance"] == pytest.approx(0.1, rel=0.1)
    assert trace["validation"]["gain_low"] > 10
    assert trace["result"]["beats_start"] is True
    world = parse_parameters(trace["result"]["parameters"])
    assert (world.friction, world.conflict_distance) == (found["friction"], found["conflict_distance"])
    assert trace["result"]["rule"] == f"ucb(gamma={found['gamma']})"
    assert trace == trace_of(tmp_path)


def test_the_start_values_are_kept_if_they_are_the_best(tmp_path: Path) -> None:
    table = FakePlay(friction=START["friction"])
    trace = calibrate(TINY.replace(validation_seeds=30), table, tmp_path)
    assert trace["validation"]["gain"] < 0
    assert trace["result"]["beats_start"] is False


def test_without_any_effect_the_gain_is_zero(tmp_path: Path) -> None:
    validation = calibrate(TINY, lambda runs: ((run, 0.25) for run in runs), tmp_path)["validation"]
    assert (validation["gain"], validation["gain_low"], validation["gain_high"]) == (0, 0, 0)


def test_candidates_of_a_generation_have_the_same_seeds(tmp_path: Path) -> None:
    table = FakePlay()
    calibrate(TINY, table, tmp_path)
    seeds = [run.seed for run in table.runs]
    assert seeds[:24] == [10_000] * 8 + [10_001] * 8 + [10_002] * 8  # 4 points, 2 cells
    assert set(seeds[24:]) == set(range(1000, 1006))
    assert len(seeds[24:]) == 2 * len(TARGET) * 6  # the validation: start and fitted, all cells, 6 seeds
    assert len({run.digest for run in table.runs}) == len(table.runs)


@pytest.mark.parametrize("games", [0, 1, 5, 8, 17, 24, 30])
def test_a_resumed_fit_equals_an_uninterrupted_one(games: int, tmp_path: Path) -> None:
    whole, before, after = FakePlay(), FakePlay(stop_after=games), FakePlay(backwards=True)
    trace = calibrate(TINY, whole, tmp_path / "whole")
    with pytest.raises(KeyboardInterrupt):
        calibrate(TINY, before, tmp_path / "parts")
    assert calibrate(TINY, after, tmp_path / "parts") == trace
    assert trace_of(tmp_path / "parts") == trace
    played = [run.digest for run in before.runs + after.runs]
    assert sorted(played) == sorted(run.digest for run in whole.runs)  # each once


def test_temporary_files_of_a_killed_fit_are_removed(tmp_path: Path) -> None:
    for name in ("shares.json", "calibration.json"):
        (tmp_path / f".unfinished-{name.encode().hex()[:16]}.json").write_text("{")  # not locked
    with pytest.raises(KeyboardInterrupt):
        calibrate(TINY, FakePlay(stop_after=0), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["shares.json"]


def test_a_fit_can_be_extended_by_more_generations(tmp_path: Path) -> None:
    calibrate(TINY, FakePlay(), tmp_path / "grown")
    more = TINY.replace(generations=5)
    assert calibrate(more, FakePlay(), tmp_path / "grown") == calibrate(
        more, FakePlay(), tmp_path / "at once"
    )


def test_the_search_does_not_use_the_global_generator(tmp_path: Path) -> None:
    before = list(np.random.get_state()[1])  # noqa: NPY002
    calibrate(TINY, FakePlay(), tmp_path)
    assert list(np.random.get_state()[1]) == before  # noqa: NPY002


def test_another_setup_needs_another_directory_or_a_fresh_start(tmp_path: Path) -> None:
    calibrate(TINY, FakePlay(), tmp_path)
    other = TINY.replace(free=("friction", "flight_duration"))
    with pytest.raises(InputError, match="has another setup"):
        calibrate(other, FakePlay(), tmp_path)
    trace = calibrate(other, FakePlay(), tmp_path, fresh=True)
    assert set(trace["start"]) == {"friction", "flight_duration"}
    assert calibrate(other, FakePlay(stop_after=0), tmp_path) == trace


@pytest.mark.parametrize("content", ["", "[]", "3", '{"setup": {}}', '{"setup": 1, "shares": {}}'])
def test_a_foreign_file_is_refused_and_kept(content: str, tmp_path: Path) -> None:
    (tmp_path / "shares.json").write_text(content)
    with pytest.raises(InputError, match=r"has a shares\.json that is no file of a fit"):
        calibrate(TINY, FakePlay(), tmp_path)
    assert (tmp_path / "shares.json").read_text() == content


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"free": ("friction", "viscosity")}, "free='viscosity': must be among conflict_distance"),
        ({"free": ("friction", "period")}, "free='period': must be among"),
        ({"free": ("friction",)}, "free='friction': must be two or more"),
        ({"free": ("gamma", "gamma")}, "free='gamma,gamma': must be two or more"),
        ({"free": ()}, "free='': must be two or more"),
        ({"seeds": 0}, "seeds=0: must be greater"),
        ({"generations": 0}, "generations=0: must be greater"),
        ({"population": -1}, "population=-1: must be greater"),
        ({"population": 3}, "population=3: must be at least 4"),
        ({"validation_seeds": 4}, "validation_seeds=4: must be greater"),
        ({"validation_seeds": 9001}, "validation_seeds=9001: must be less"),
        ({"densities": ()}, "densities=()"),
        ({"budget": 3}, "budget=3: unknown field"),
    ],
)
def test_an_invalid_setup_is_refused(change: dict[str, object], complaint: str) -> None:
    with pytest.raises(InputError) as caught:
        TINY.replace(**change)
    assert str(caught.value).startswith(complaint)


def test_densities_must_be_in_the_table_and_out_a_directory(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"densities=8: must be among 6, 30"):
        calibrate(TINY.replace(densities=(6, 8)), FakePlay(), tmp_path / "out")
    assert not (tmp_path / "out").exists()
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="must be a writable directory"):
        calibrate(TINY, FakePlay(), tmp_path / "file")


def test_shares_are_saved_during_long_generations(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    saved: list[int] = []
    clock: Iterator[float] = iter(range(0, 10_000, 3))
    monkeypatch.setattr(shares_module.time, "monotonic", lambda: float(next(clock)))
    monkeypatch.setattr(
        shares_module, "write_json", lambda _, content: saved.append(len(content.get("shares", ())))
    )
    with pytest.raises(KeyboardInterrupt):
        calibrate(TINY, FakePlay(stop_after=7), tmp_path)
    assert saved == [0, 2, 4, 6, 7]


def validate(start: NDArray[np.float64], fitted: NDArray[np.float64]) -> dict[str, float]:
    return fit.validate(start, fitted, np.full(20, 50.0), bootstrap_interval)


def _shares(seed: int, mean: float) -> NDArray[np.float64]:
    return np.random.default_rng(seed).normal(mean, 0.05, size=(20, 20))


@pytest.mark.parametrize(("fitted", "beaten"), [(0.52, True), (0.60, False), (0.70, False)])
def test_the_interval_distinguishes_a_gain_from_chance(fitted: float, beaten: bool) -> None:
    found = validate(_shares(1, 0.60), _shares(2, fitted))
    assert found["start_error"] - found["fitted_error"] == pytest.approx(found["gain"])
    assert found["gain_low"] <= found["gain"] <= found["gain_high"]
    assert found["gain"] == pytest.approx(100 * (0.60 - fitted), abs=1.0)
    assert (found["gain_low"] > 0) is beaten


def test_noise_common_to_both_candidates_does_not_widen_the_interval() -> None:
    noise = _shares(1, 0.0)
    found = validate(noise + 0.9, noise + 0.8)
    assert (found["gain_low"], found["gain_high"]) == pytest.approx((10, 10))


@pytest.mark.parametrize("end", [0.0, 1.0])
@pytest.mark.parametrize("name", list(START))
def test_both_ends_of_each_range_are_valid_games(name: str, end: float) -> None:
    point = to_candidate([name], np.array([end]))
    lowest = pytest.approx(START[name] / 2, rel=1e-3)
    assert point[name] == lowest if end == 0 else point[name] > START[name]
    game = learning_game(("attack", 50), point)
    assert (game.size, game.swarms[0].policy, game.learning, game.duration) == (50, "attack", 3000, 0.1)
    if name == "gamma":
        assert f"ucb(gamma={point[name]})" in game.swarms[1].policy
    else:
        assert getattr(game.parameters, name) == point[name]


def test_the_start_values_are_the_defaults() -> None:
    parameters, rule = texts_of(START)
    assert parse_parameters(parameters) == parse_parameters("fitted")
    assert rule == f"ucb(gamma={START['gamma']})"
    again = to_candidate(list(START), to_position(START))
    assert again == {name: float(f"{value:.4g}") for name, value in START.items()}


def test_all_parameters_can_be_searched_together(tmp_path: Path) -> None:
    setup = Setup(densities=(6,), seeds=1, generations=2, validation_seeds=6)
    trace = calibrate(setup, FakePlay(), tmp_path)
    assert len(trace["start"]) == 16
    assert all(0 <= point["push_share"] <= 0.5 for point in trace["generations"][1]["points"])
