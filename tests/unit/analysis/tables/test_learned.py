"""Tables of what was learned, on made-up policies whose shares and intervals are known."""

import math
from collections.abc import Mapping, Sequence

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.published import learned_percentages
from kswarms.analysis.tables.learned import learned, mean_absolute_error, printed

Column = tuple[str, str, int]  # scenario, condition, opponent of S2


def policies(shares: Mapping[Column, Mapping[int, Sequence[float]]]) -> pd.DataFrame:
    """Make rows of S2, which attacks with these shares (one for each seed), by column and density."""
    return pd.DataFrame(
        {
            "run": f"{scenario}-{condition}-{n}-{seed}",
            "scenario": scenario,
            "condition": condition,
            "n": n,
            "seed": seed,
            "swarm": 2,
            "opponent": opponent,
            "action": action,
            "share": share,
            "attack_share": attack,
        }
        for (scenario, condition, opponent), by_density in shares.items()
        for n, attacks in by_density.items()
        for seed, attack in enumerate(attacks)
        for action, share in (("flight", 1 - attack), ("fight", attack))
    )


def test_a_cell_is_the_mean_over_the_seeds_with_the_interval_of_student() -> None:
    cells = learned(policies({("fig-x", "", 1): {6: [0.1, 0.2, 0.3, 0.4]}}), ["fig-x"])
    (cell,) = cells.to_dict("records")
    assert cell["seeds"] == 4
    assert cell["measured"] == pytest.approx(25)
    # s = sqrt(500/3) = 12.910, s / sqrt(4) = 6.455, t(3; 0.975) = 3.18245
    assert cell["high"] - 25 == pytest.approx(20.543, abs=0.001)
    assert 25 - cell["low"] == pytest.approx(20.543, abs=0.001)
    assert math.isnan(cell["published"])
    assert math.isnan(cell["error"])


def test_the_interval_stays_between_nothing_and_all() -> None:
    (cell,) = learned(policies({("fig-x", "", 1): {6: [0.4, 0.6]}}), ["fig-x"]).to_dict("records")
    assert (cell["low"], cell["measured"], cell["high"]) == (0, pytest.approx(50), 100)


def test_seeds_that_agree_leave_no_interval_and_one_seed_has_none() -> None:
    cells = learned(policies({("fig-x", "", 1): {6: [0.5, 0.5, 0.5], 10: [0.5]}}), ["fig-x"])
    three, one = cells.to_dict("records")
    assert (three["low"], three["measured"], three["high"]) == (50, 50, 50)
    assert (one["seeds"], one["measured"]) == (1, 50)
    assert math.isnan(one["low"])
    assert math.isnan(one["high"])


def test_of_the_own_swarm_flight_is_counted() -> None:
    cells = learned(policies({("fig-6.6", "", 2): {6: [0.0, 0.1]}}), ["fig-6.6"])
    assert list(cells["learned"]) == ["flight within"]
    assert list(cells["measured"]) == pytest.approx([95])


def test_a_share_counts_once_however_many_actions_there_are() -> None:
    rows = policies({("fig-x", "", 1): {6: [0.2, 0.4]}})
    third = rows[(rows["action"] == "fight") & (rows["seed"] == 0)].assign(action="ram")
    (cell,) = learned(pd.concat([rows, third]), ["fig-x"]).to_dict("records")
    assert (cell["seeds"], cell["measured"]) == (2, pytest.approx(30))


def test_published_numbers_stand_beside_those_of_the_same_figure_density_and_kind() -> None:
    made = policies(
        {
            ("fig-6.8", "", 2): {26: [0.0]},
            ("fig-6.8", "", 1): {26: [0.2], 28: [0.2]},
            ("fig-6.4a", "", 1): {26: [0.5]},
        }
    )
    cells = learned(made, ["fig-6.8", "fig-6.4a"])
    shown = cells[["scenario", "learned", "n", "published"]].to_numpy().tolist()
    assert shown[0] == ["fig-6.8", "attack", 26, 15.7]
    assert shown[1][:3] == ["fig-6.8", "attack", 28]
    assert math.isnan(shown[1][3])
    assert shown[2:] == [["fig-6.8", "flight within", 26, 100], ["fig-6.4a", "attack", 26, 31.9]]
    assert list(cells["error"].dropna()) == pytest.approx([20 - 15.7, 0, 50 - 31.9])


def test_the_mean_absolute_error_is_over_the_cells_that_were_published() -> None:
    made = policies({("fig-6.4a", "", 1): {6: [0.116], 10: [0.0], 12: [1.0]}})
    cells = learned(made, ["fig-6.4a"])
    assert mean_absolute_error(cells) == pytest.approx((10 + 2) / 2)
    assert math.isnan(mean_absolute_error(cells[cells["n"] == 12]))


def test_the_source_beside_itself_has_no_error() -> None:
    published = learned_percentages()
    made = {
        (scenario, "", 2 if kind == "flight within" else 1): {
            int(n): [percent / 100 if kind == "attack" else 1 - percent / 100]
            for n, percent in zip(rows["n"], rows["published"], strict=True)
        }
        for (scenario, kind), rows in published.groupby(["scenario", "learned"])
    }
    cells = learned(policies(made), ["fig-6.4a", "fig-6.4b", "fig-6.8"])
    assert len(cells) == len(published) == 40
    assert mean_absolute_error(cells) == pytest.approx(0)


def test_scenarios_in_which_nobody_learned() -> None:
    made = policies({("fig-6.4a", "", 1): {6: [0.0]}})
    with pytest.raises(InputError, match=r"^scenarios=\['fig-6\.1a'\]: must include one .*: fig-6\.4a$"):
        learned(made, ["fig-6.1a"])


def test_printed_with_published_numbers() -> None:
    made = policies(
        {("fig-6.4a", "", 1): {6: [0.0, 0.0], 26: [0.4, 0.6]}, ("fig-6.4b", "", 1): {26: [0.13, 0.13]}}
    )
    table = printed(learned(made, ["fig-6.4a", "fig-6.4b"]))
    assert table.header == [
        "N",
        "fig-6.4a\npublished",
        "fig-6.4a\nmeasured",
        "fig-6.4b\npublished",
        "fig-6.4b\nmeasured",
    ]
    assert table.rows == [
        ["6", "1.6", "0.0 (0.0 … 0.0)", "–", "–"],
        ["26", "31.9", "50.0 (0.0 … 100.0)", "3.0", "13.0 (13.0 … 13.0)"],
    ]
    first, second = table.caption.splitlines()
    assert first == "percent of the learning swarm's robots; mean of 2 seeds (95 % interval, Student's t)"
    # (1.6 + 18.1) / 2, 10, and (1.6 + 18.1 + 10) / 3
    assert second == (
        "mean absolute error, percentage points: fig-6.4a 9.9, fig-6.4b 10.0, all 3 cells 9.9"
    )


def test_printed_without_published_numbers() -> None:
    made = policies({("fig-6.12", "delta=0.25", 1): {6: [0.5]}, ("fig-6.12", "delta=0.02", 1): {6: [0.25]}})
    table = printed(learned(made, ["fig-6.12"]))
    assert table.header == ["N", "delta=0.02\nmeasured", "delta=0.25\nmeasured"]
    assert table.rows == [["6", "25.0", "50.0"]]
    assert table.caption == "percent of the learning swarm's robots; one seed"


def test_printed_by_what_was_learned() -> None:
    made = policies({("fig-6.8", "", 1): {6: [0.5] * 3}, ("fig-6.8", "", 2): {6: [0.0] * 2}})
    table = printed(learned(made, ["fig-6.8"]))
    assert [heading.splitlines()[0] for heading in table.header[1:]] == [
        *("attack", "attack"),
        *("flight within", "flight within"),
    ]
    assert "mean of 2 to 3 seeds" in table.caption
    assert "attack 50.0, flight within 0.0, all 2 cells 25.0" in table.caption
    alone = printed(learned(made[made["opponent"] == 1], ["fig-6.8"]))
    assert alone.header == ["N", "attack\npublished", "attack\nmeasured"]
    assert alone.caption.endswith("percentage points: attack 50.0")
