"""From the words of a command line to scenarios that can be played."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.catalogue.selecting import chosen, integers, planned, words


def test_scenarios_come_in_the_order_asked_for_and_once() -> None:
    assert [each.id for each in chosen(["fig-7.1", "fig-6.4b", "fig-7.1"])] == ["fig-7.1", "fig-6.4b"]


def test_a_table_stands_for_its_figures() -> None:
    assert [each.id for each in chosen(["table-6.1"])] == ["fig-6.4a", "fig-6.4b"]
    assert [each.id for each in chosen(["fig-6.4b", "table-6.2", "table-6.1"])] == [
        "fig-6.4b",
        "fig-6.8",
        "fig-6.4a",
    ]


@pytest.mark.parametrize(
    ("name", "hint"),
    [("table-6.4", "did you mean table-6.3"), ("fig-7.20", "did you mean fig-7.2"), ("q", "see `kswarms")],
)
def test_an_unknown_id_is_refused_with_a_hint(name: str, hint: str) -> None:
    with pytest.raises(InputError, match=rf"^id='{name}': must be a scenario or table of the list; {hint}"):
        chosen(["fig-6.1a", name])


def test_a_plan_keeps_what_is_not_asked_for() -> None:
    (scenario,), left_out = planned([CATALOGUE["fig-7.12"]], (), None, suitable_only=False)
    assert scenario == CATALOGUE["fig-7.12"]
    (scenario,), _ = planned([CATALOGUE["fig-7.12"]], (26,), 3, suitable_only=False)
    assert (scenario.densities, scenario.seeds) == ((26,), 3)
    assert left_out == []


def test_what_no_density_suits_is_left_out_only_if_that_is_wanted() -> None:
    both = [CATALOGUE["fig-6.1a"], CATALOGUE["fig-7.12"]]
    scenarios, left_out = planned(both, (6, 13), 1, suitable_only=True)
    assert [(each.id, each.densities) for each in scenarios] == [("fig-6.1a", (6,)), ("fig-7.12", (13,))]
    assert left_out == []
    assert planned(both, (6,), 1, suitable_only=True)[1] == ["fig-7.12"]
    with pytest.raises(InputError, match=r"^n=6: must be a multiple of 13 .* \(fig-7\.12\)$"):
        planned(both, (6,), 1, suitable_only=False)
    with pytest.raises(InputError, match=r"^densities='7': must suit some scenario"):
        planned(both, (7,), 1, suitable_only=True)


def test_lists_are_read_without_repetition() -> None:
    assert words("robots, conflicts,robots") == ["robots", "conflicts"]
    assert words("") == []
    assert integers("densities", "30,6,30") == (6, 30)
    assert integers("densities", None) == ()
    with pytest.raises(InputError, match=r"^densities='6,x': must be integers"):
        integers("densities", "6,x")
