"""Discrepancies of claims, and targets of a calibration as data."""

from pathlib import Path

import numpy as np
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings.claims import Agreement, Claim, Compare, Overtake, Peak, Share, Trend
from kswarms.analysis.findings.data import NoDataError
from kswarms.analysis.findings.quantity import Quantity
from kswarms.analysis.findings.worlds.discrepancy import discrepancy
from kswarms.analysis.findings.worlds.targets import Target, Targets, read_targets
from kswarms.analysis.results.published import table_6_1
from kswarms.analysis.results.runs import Results
from kswarms.scenarios.catalogue import CATALOGUE
from tests.helpers.synthetic_results import DENSITIES, LEARNED, S1, S2, policies, runs

PUBLISHED = table_6_1().set_index("n")["fig_6_4a_attack_pct"]
LINE = Compare(left=S2, relation=">", right=S1, margin=1)


def duel(*curves: list[float]) -> Results:
    return Results(runs(curves))


@pytest.mark.parametrize(
    ("claim", "second", "expected"),
    [
        (LINE, [2.0, 3.0, 4.0, 5.0, 6.0], 0.0),
        (LINE, [2.0, 0.5, 4.0, -0.5, 6.0], 1.5),
        (LINE.replace(over="mean over N"), [2.0, -2.0, 0.0, 0.0, 2.0], 0.6),
        (LINE.replace(over="sum over N"), [2.0, -2.0, 0.0, 0.0, -3.0], 4.0),
        (LINE.replace(relation="within"), [1.5, 0.0, -3.0, 0.0, 0.0], 2.0),
        (LINE.replace(relation="<=", densities=(6, 50)), [2.5, 9.0, 9.0, 9.0, 1.0], 1.5),
        (Overtake(ahead=S2, behind=S1, between=(30, 40)), [-1.0, -1.0, -1.0, 1.0, 1.0], 0.0),
        (Overtake(ahead=S2, behind=S1, between=(30, 40)), [-1.0, 1.0, 1.0, 1.0, 1.0], 19.0),
        (Overtake(ahead=S2, behind=S1, between=(30, 40)), [1.0, 1.0, 1.0, 1.0, 1.0], 24.0),
        (Overtake(ahead=S2, behind=S1, between=(30, 40)), [-1.0, -1.0, -1.0, -1.0, -1.0], 10.0),
        (Peak(quantity=S2), [1.0, 2.0, 5.0, 2.0, 1.0], 0.0),
        (Peak(quantity=S2), [1.0, 2.0, 3.0, 4.0, 5.5], 1.5),
        (Trend(quantity=S2, above=0.5), [1.0, 2.0, 3.0, 4.0, 5.0], 0.0),
        (Trend(quantity=S2, above=0.5), [5.0, 4.0, 3.0, 2.0, 1.0], 1.5),
    ],
)
def test_the_discrepancy_is_the_distance_of_the_means_from_the_claim(
    claim: Claim, second: list[float], expected: float
) -> None:
    assert discrepancy(claim, duel([0.0] * 5, second)) == pytest.approx(expected)


def test_the_discrepancy_of_a_table_is_its_mean_absolute_error() -> None:
    claim = Agreement(cells=(LEARNED,), margin=9.6, densities=(16, 30))
    shares = [0.0, PUBLISHED[16] / 100 + 0.04, PUBLISHED[30] / 100 - 0.02, 0.0, 0.0]
    learned = policies(shares)
    results = Results(runs([[0.0] * 5] * 2, scenario="fig-6.4a"), learned)
    assert discrepancy(claim, results) == pytest.approx(3.0)
    share = Share(quantity=LEARNED, above=50, densities=(16, 30))
    mean = 50 * (shares[1] + shares[2])
    assert discrepancy(share, results) == pytest.approx(50 - mean)


def test_the_discrepancy_of_scores_is_their_mean_difference_from_argos() -> None:
    cells = tuple(Quantity(scenario="argos-avoid-attack", swarm=swarm) for swarm in (1, 2))
    claim = Agreement(cells=cells, margin=2, densities=(16, 36))
    made = runs([[31.3 + 1, 34.3], [26.7, 28.9 - 2]], densities=(16, 36), scenario="argos-avoid-attack")
    assert discrepancy(claim, Results(made)) == pytest.approx(0.75, abs=0.01)


def test_missing_games_are_an_error() -> None:
    with pytest.raises(NoDataError, match="no runs of"):
        discrepancy(Peak(quantity=Quantity(scenario="other")), duel([0.0] * 5, [0.0] * 5))


def test_the_implausibility_is_the_weighted_share_of_the_tolerance() -> None:
    claim = LINE.replace(densities=DENSITIES)
    target = Target(id="lead", claim=claim, tolerance=3, weight=2)
    outputs = target.outputs(duel([0.0] * 5, [2.0, 0.5, 4.0, -0.5, 6.0]))
    assert outputs == pytest.approx(np.array([2.0, 0.5, 4.0, -0.5, 6.0, *[0.0] * 5]))
    assert target.implausibility(np.array([outputs, outputs * 0])).tolist() == pytest.approx([1.0, 2 / 3])


def test_the_tolerance_of_a_table_is_the_margin_of_the_claim() -> None:
    table = Agreement(cells=(LEARNED,), margin=4, densities=(16, 30))
    outputs = np.array([[PUBLISHED[16] + 3, PUBLISHED[30] - 3]])
    assert Target(id="table", claim=table).implausibility(outputs) == pytest.approx(0.75)
    with pytest.raises(InputError, match=r"^tolerance=4\.0: must be omitted: the margin of the claim is the"):
        Target(id="other", claim=table, tolerance=4)
    with pytest.raises(InputError, match=r"^tolerance=None: must be given for a claim of this kind"):
        Target(id="other", claim=LINE.replace(densities=(6,)))


def test_the_outputs_of_a_stage_are_those_of_its_targets() -> None:
    first = Target(id="a", claim=LINE.replace(densities=(6, 16)), tolerance=1)
    other = Target(id="b", claim=Peak(quantity=S2, densities=(6, 16, 30)), tolerance=1)
    targets = Targets(name="x", seeds=(1,), targets=(first, other))
    results = duel([0.0] * 5, [3.0, 2.5, 5.0, 0.0, 0.0])
    outputs = targets.outputs(1, results)
    assert outputs == pytest.approx(np.array([3.0, 2.5, 0.0, 0.0, 3.0, 2.5, 5.0]))
    sets = np.array([outputs, outputs - [3, 0, 0, 0, 0, 0, 3]])
    assert targets.implausibility(1, sets) == pytest.approx(np.array([[0.0, 2.5], [1.0, 0.5]]))


def test_the_built_in_targets_are_about_curves_of_the_catalogue() -> None:
    targets = read_targets("chapter-6")
    for stage in range(1, len(targets.seeds) + 1):
        curves = targets.curves(stage)
        assert curves
        for (scenario, condition), densities in curves.items():
            names = [each.name for each in CATALOGUE[scenario].conditions]
            assert condition in names
            assert all(CATALOGUE[scenario].allows(n) for n in densities)
            assert not scenario.startswith("fig-7")
            assert scenario != "fig-6.4a"  # Table 6.1, column 1


def test_a_stage_needs_the_densities_of_its_targets() -> None:
    first = Target(id="a", claim=LINE.replace(densities=(6, 16)), tolerance=1)
    other = first.replace(id="b", claim=LINE.replace(densities=(16, 30)))
    last = first.replace(id="c", claim=LINE.replace(densities=(50,)), stage=2)
    targets = Targets(name="x", seeds=(2, 3), targets=(first, last, other))
    assert targets.of_stage(1) == (first, other)
    assert targets.curves(1) == {("duel", ""): (6, 16, 30)}
    assert targets.curves(2) == {("duel", ""): (50,)}


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"seeds": (2, 2)}, r"targets\.stage=\[1\]: must be 1 to 2, as many as there are seeds"),
        ({"seeds": ()}, "seeds"),
        ({"targets": "twice"}, r"targets\.id='a': must be given once"),
    ],
)
def test_invalid_targets_are_refused(changes: dict[str, object], error: str) -> None:
    target = Target(id="a", claim=LINE.replace(densities=(6,)), tolerance=1)
    values: dict[str, object] = {"name": "x", "seeds": (2,), "targets": (target,)} | changes
    if values["targets"] == "twice":
        values["targets"] = (target, target)
    with pytest.raises(InputError, match=error):
        Targets(**values)


@pytest.mark.parametrize(
    ("claim", "needed"),
    [
        (LINE, 1),
        (Overtake(ahead=S2, behind=S1, between=(30, 40), densities=(30,)), 2),
        (Peak(quantity=S2, densities=(6, 50)), 3),
        (Trend(quantity=S2, densities=(6, 50)), 3),
    ],
)
def test_a_target_names_enough_densities(claim: Claim, needed: int) -> None:
    with pytest.raises(InputError, match=rf"^claim\.densities=.*: must be {needed} or more for a target"):
        Target(id="a", claim=claim, tolerance=1)


def test_a_target_without_its_games_is_refused() -> None:
    target = Target(id="a", claim=LINE.replace(left=S2.replace(swarm=3), densities=(6,)), tolerance=1)
    with pytest.raises(InputError, match=r"^targets='a': must be about games that have its quant"):
        target.outputs(duel([0.0] * 5, [0.0] * 5))
    partly = target.replace(claim=LINE.replace(densities=(6, 7)))
    with pytest.raises(InputError, match=r"quantities: not all of N = 6, 7"):
        partly.outputs(duel([0.0] * 5, [0.0] * 5))


def test_targets_are_read_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text("""
name = "mine"
seeds = [4]
[[targets]]
id = "rise"
tolerance = 1
claim = { kind = "rise then fall", quantity = { scenario = "fig-6.1a" }, densities = [6, 20, 50] }
""")
    assert read_targets(file).targets[0].claim == Peak(
        quantity=Quantity(scenario="fig-6.1a"), densities=(6, 20, 50)
    )
    with pytest.raises(InputError, match=r"targets='?.*absent"):
        read_targets(tmp_path / "absent.toml")
    with pytest.raises(InputError, match=r"^targets='chapter-7': must be one of chapter-6, or a file as my"):
        read_targets("chapter-7")
