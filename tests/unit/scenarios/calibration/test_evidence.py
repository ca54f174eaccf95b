"""Games of candidate worlds, and the file with their results."""

import json
from collections.abc import Generator, Sequence
from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.presets import PRESETS
from kswarms.scenarios.calibration.evidence import Evidence, runs_of
from kswarms.scenarios.calibration.prior import PRIOR, to_world
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run

WORLD = PRESETS["fitted"].replace(friction=0.7, push_share=0.5, gamma=0.02, conflict_distance=0.11)
CURVES = {("fig-6.12", "delta=0.08"): (6, 10), ("fig-6.1c", ""): (6,)}


class Player:
    """Plays runs: yields the seed as score, and stops after some of them."""

    def __init__(self, stop_after: int = 1000) -> None:
        self.played: list[Run] = []
        self._left = stop_after

    def __call__(self, runs: Sequence[Run]) -> Generator[tuple[Run, Outcome], None, None]:
        for run in runs:
            if not self._left:
                raise KeyboardInterrupt
            self._left -= 1
            self.played.append(run)
            rows = [{"swarm": swarm, "policy": "avoid", "pucks": 10 * swarm + run.seed} for swarm in (1, 2)]
            learned = [{"swarm": 2, "opponent": 1, "action": "fight", "attack_share": 0.5}]
            yield run, Outcome(rows, learned, {})


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "games.jsonl"


def test_the_runs_of_a_world_are_those_of_the_catalogue_with_its_parameters() -> None:
    runs = runs_of(WORLD, CURVES, 7, 2)
    assert {(run.labels, run.n, run.seed) for run in runs} == {
        (((scenario, condition),), n, seed)
        for (scenario, condition), densities in CURVES.items()
        for n in densities
        for seed in (7, 8)
    }
    for run in runs:
        (label,) = run.labels
        of_catalogue = CATALOGUE[label[0]].game(label[1], run.n)
        assert run.game == of_catalogue.replace(parameters=WORLD)


def test_a_scenario_keeps_the_parameters_that_it_sets_itself() -> None:
    (run,) = runs_of(WORLD, {("fig-6.15", "learner"): (6,)}, 0, 1)
    assert run.game.parameters == WORLD.replace(period=0.05)
    (run,) = runs_of(WORLD, {("argos-avoid-attack", ""): (6,)}, 0, 1)
    assert run.game.parameters == PRESETS["argos"].replace(friction=0.7, push_share=0.5)


def test_an_unknown_curve_is_refused() -> None:
    with pytest.raises(InputError, match=r"^condition='x': must be one of 'delta=0.02', .* of fig-6\.12$"):
        runs_of(WORLD, {("fig-6.12", "x"): (6,)}, 0, 1)


def test_an_unknown_scenario_is_refused() -> None:
    with pytest.raises(InputError, match=r"^scenario='fig-9': must be one of `kswarms list`$"):
        runs_of(WORLD, {("fig-9", ""): (6,)}, 0, 1)


def test_rows_have_the_labels_of_their_curves(path: Path) -> None:
    (rows,) = Evidence(path, {}, Player()).rows([runs_of(WORLD, CURVES, 7, 2)])
    assert len(rows.swarms) == 12
    assert {(row["scenario"], row["condition"], row["n"]) for row in rows.swarms} == {
        (*curve, n) for curve, densities in CURVES.items() for n in densities
    }
    assert all(row["pucks"] == 10 * row["swarm"] + row["seed"] for row in rows.swarms)
    assert {row["attack_share"] for row in rows.policies} == {0.5}


def test_no_game_is_played_twice(path: Path) -> None:
    plan, player = runs_of(WORLD, CURVES, 0, 2), Player(stop_after=4)
    with pytest.raises(KeyboardInterrupt):
        Evidence(path, {}, player).rows([plan])
    with path.open("a") as file:
        file.write('["cut off by an interrup')
    resumed = Player()
    (rows,) = Evidence(path, {}, resumed).rows([plan])
    assert len(player.played) + len(resumed.played) == len(plan)
    assert Evidence(path, {}, Player(stop_after=0)).rows([plan, plan]) == [rows, rows]


@pytest.mark.parametrize(
    "content", ["precious", "precious\n", "3\n", '{"a": 1}\n', '{"calibration": {}}\n[3]\n', "[" * 5000]
)
def test_a_file_of_others_is_refused_and_unchanged(path: Path, content: str) -> None:
    path.write_text(content)
    with pytest.raises(InputError, match=r"has a games\.jsonl that is no file of games"):
        Evidence(path, {}, Player())
    assert path.read_text() == content


def test_a_file_of_another_calibration_is_refused(path: Path) -> None:
    Evidence(path, {"size": 3}, Player())
    with pytest.raises(InputError, match="has games of other settings; use another directory, or --fresh"):
        Evidence(path, {"size": 4}, Player())
    assert json.loads(path.read_text()) == {"calibration": {"size": 3}}


@pytest.mark.parametrize("part", [0.0, 0.37, 0.999999])
def test_every_position_of_the_prior_is_a_world(part: float) -> None:
    world = to_world(tuple(PRIOR), [part] * len(PRIOR))
    for name, (low, high, step) in PRIOR.items():
        value = getattr(world, name)
        assert low * 0.9999 <= value <= high * 1.0001
        if step:
            assert round((value - low) / step, 6).is_integer()
    runs_of(world, {(name, ""): (6, 50) for name in ("fig-6.1a", "fig-6.8", "argos-avoid-attack")}, 0, 1)


def test_parameters_that_are_not_free_keep_their_values() -> None:
    world = to_world(("friction",), [0.5])
    assert world == PRESETS["fitted"].replace(friction=float(f"{(0.15 * 1.5) ** 0.5:.4g}"))
