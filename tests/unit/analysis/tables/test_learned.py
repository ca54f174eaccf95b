"""Tables of learned shares, from policies with known shares and intervals."""

import math
from collections.abc import Mapping, Sequence

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.measures.learned import learned_shares, mean_absolute_error
from kswarms.analysis.results.published import learned_percentages
from kswarms.analysis.statistics.intervals import bootstrap_interval
from kswarms.analysis.tables.learned import learned_table

Column = tuple[str, str, int]  # scenario, condition, opponent of S2


def policies(shares: Mapping[Column, Mapping[int, Sequence[float]]]) -> pd.DataFrame:
    """Return rows of S2 with these shares of attack (one for each seed), by column and density."""
    return pd.DataFrame(
        {"run": f"{scenario}-{condition}-{n}-{seed}", "scenario": scenario, "condition": condition, "n": n}
        | {"seed": seed, "swarm": 2, "opponent": opponent}
        | {"action": action, "share": share, "attack_share": attack}
        for (scenario, condition, opponent), by_density in shares.items()
        for n, attacks in by_density.items()
        for seed, attack in enumerate(attacks)
        for action, share in (("flight", 1 - attack), ("fight", attack))
    )


def test_a_cell_is_the_mean_over_the_seeds_with_its_bootstrap_interval() -> None:
    attacks = [0.1, 0.2, 0.3, 0.4, 0.4, 0.4]
    made = policies({("fig-x", "", 1): {6: attacks, 10: [0.5] * 3, 16: [0.5] * 6}})
    first, few, equal = learned_shares(made, ["fig-x"]).to_dict("records")
    interval = bootstrap_interval([100 * share for share in attacks])
    assert first["seeds"] == 6
    assert first["measured"] == pytest.approx(30)
    assert (first["low"], first["high"]) == pytest.approx((interval.low, interval.high))
    assert math.isnan(first["published"])
    assert math.isnan(first["error"])
    assert (few["seeds"], few["measured"]) == (3, 50)
    assert math.isnan(few["low"])
    assert math.isnan(few["high"])
    assert (equal["low"], equal["measured"], equal["high"]) == (50, 50, 50)


def test_flight_is_counted_within_the_swarm() -> None:
    cells = learned_shares(policies({("fig-6.6", "", 2): {6: [0.0, 0.1]}}), ["fig-6.6"])
    assert list(cells["learned"]) == ["flight within"]
    assert list(cells["measured"]) == pytest.approx([95])


def test_a_share_counts_once_for_any_number_of_actions() -> None:
    rows = policies({("fig-x", "", 1): {6: [0.2, 0.4]}})
    third = rows[(rows["action"] == "fight") & (rows["seed"] == 0)].assign(action="ram")
    (cell,) = learned_shares(pd.concat([rows, third]), ["fig-x"]).to_dict("records")
    assert (cell["seeds"], cell["measured"]) == (2, pytest.approx(30))


def test_published_numbers_match_figure_density_and_kind() -> None:
    shares: dict[Column, Mapping[int, Sequence[float]]] = {("fig-6.8", "", 2): {26: [0.0]}}
    shares |= {("fig-6.8", "", 1): {26: [0.2], 28: [0.2]}, ("fig-6.4a", "", 1): {26: [0.5]}}
    cells = learned_shares(policies(shares), ["fig-6.8", "fig-6.4a"])
    shown = cells[["scenario", "learned", "n", "published"]].to_numpy().tolist()
    assert shown[0] == ["fig-6.8", "attack", 26, 15.7]
    assert shown[1][:3] == ["fig-6.8", "attack", 28]
    assert math.isnan(shown[1][3])
    assert shown[2:] == [["fig-6.8", "flight within", 26, 100], ["fig-6.4a", "attack", 26, 31.9]]
    assert list(cells["error"].dropna()) == pytest.approx([20 - 15.7, 0, 50 - 31.9])


def test_the_mean_absolute_error_covers_the_published_cells() -> None:
    made = policies({("fig-6.4a", "", 1): {6: [0.116], 10: [0.0], 12: [1.0]}})
    cells = learned_shares(made, ["fig-6.4a"])
    assert mean_absolute_error(cells) == pytest.approx((10 + 2) / 2)
    assert math.isnan(mean_absolute_error(cells[cells["n"] == 12]))


def test_the_published_numbers_have_no_error() -> None:
    published = learned_percentages()
    made = {
        (scenario, condition, 2 if kind == "flight within" else 1): {
            int(n): [percent / 100 if kind == "attack" else 1 - percent / 100]
            for n, percent in zip(rows["n"], rows["published"], strict=True)
        }
        for (scenario, condition, kind), rows in published.groupby(["scenario", "condition", "learned"])
    }
    cells = learned_shares(policies(made), ["fig-6.4a", "fig-6.4b", "fig-6.8", "fig-6.12"])
    assert len(cells) == len(published) == 90
    assert mean_absolute_error(cells) == pytest.approx(0)


def test_scenarios_without_learners_are_refused() -> None:
    made = policies({("fig-6.4a", "", 1): {6: [0.0]}})
    with pytest.raises(InputError, match=r"^scenarios=\['fig-6\.1a'\]: must include one .*: fig-6\.4a$"):
        learned_shares(made, ["fig-6.1a"])


def test_the_table_shows_published_beside_measured_numbers() -> None:
    both = {6: [0.0] * 6, 26: [0.4] * 3 + [0.6] * 3}, {26: [0.13] * 6}
    made = policies({("fig-6.4a", "", 1): both[0], ("fig-6.4b", "", 1): both[1]})
    table = learned_table(learned_shares(made, ["fig-6.4a", "fig-6.4b"]))
    of_curves = (f"{name}\n{kind}" for name in ("fig-6.4a", "fig-6.4b") for kind in ("published", "measured"))
    assert table.header == ["N", *of_curves]
    assert table.rows == [
        ["6", "1.6", "0.0 (0.0 … 0.0)", "–", "–"],
        ["26", "31.9", "50.0 (40.0 … 60.0)", "3.0", "13.0 (13.0 … 13.0)"],
    ]
    first, second = table.caption.splitlines()
    assert first == "percent of the learning swarm's robots; mean of 6 seeds (95 % interval)"
    # (1.6 + 18.1) / 2, 10, and (1.6 + 18.1 + 10) / 3
    assert second == ("mean absolute error, percentage points: fig-6.4a 9.9, fig-6.4b 10.0, all 3 cells 9.9")


def test_the_table_without_published_numbers() -> None:
    made = policies({("fig-6.14", "ucb", 1): {6: [0.5]}, ("fig-6.14", "greedy", 1): {6: [0.25]}})
    table = learned_table(learned_shares(made, ["fig-6.14"]))
    assert table.header == ["N", "greedy\nmeasured", "ucb\nmeasured"]
    assert table.rows == [["6", "25.0", "50.0"]]
    assert table.caption == "percent of the learning swarm's robots; one seed"


def test_column_names_have_only_the_parts_that_differ() -> None:
    made = policies({("fig-6.8", "", 1): {6: [0.5] * 3}, ("fig-6.8", "", 2): {6: [0.0] * 2}})
    table = learned_table(learned_shares(made, ["fig-6.8"]))
    names = [heading.splitlines()[0] for heading in table.header[1:]]
    assert names == ["attack", "attack", "flight within", "flight within"]
    assert "mean of 2 to 3 seeds" in table.caption
    assert "attack 50.0, flight within 0.0, all 2 cells 25.0" in table.caption
    alone = learned_table(learned_shares(made[made["opponent"] == 1], ["fig-6.8"]))
    assert alone.header == ["N", "attack\npublished", "attack\nmeasured"]
    assert alone.caption.endswith("percentage points: attack 50.0")
