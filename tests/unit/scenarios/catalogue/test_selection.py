"""Selection of scenarios by id, with densities and seeds."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.catalogue.selection import select_scenarios, with_densities_and_seeds


@pytest.mark.parametrize(
    ("names", "ids"),
    [
        (["fig-7.1", "fig-6.4b", "fig-7.1"], ["fig-7.1", "fig-6.4b"]),
        (["table-6.1"], ["fig-6.4a", "fig-6.4b"]),
        (["fig-6.4b", "table-6.2", "table-6.1"], ["fig-6.4b", "fig-6.8", "fig-6.4a"]),
    ],
)
def test_scenarios_are_unique_and_in_the_order_of_the_ids(names: list[str], ids: list[str]) -> None:
    assert [scenario.id for scenario in select_scenarios(names)] == ids


@pytest.mark.parametrize(
    ("name", "hint"),
    [("table-6.4", "did you mean table-6.3"), ("fig-7.20", "did you mean fig-7.2"), ("q", "see `kswarms")],
)
def test_an_unknown_id_is_refused_with_a_hint(name: str, hint: str) -> None:
    with pytest.raises(InputError, match=rf"^id='{name}': must be a scenario or table; {hint}"):
        select_scenarios(["fig-6.1a", name])


def test_densities_and_seeds_that_are_not_given_are_kept() -> None:
    (scenario,), left_out = with_densities_and_seeds([CATALOGUE["fig-7.12"]], (), None, suitable_only=False)
    assert scenario == CATALOGUE["fig-7.12"]
    (scenario,), _ = with_densities_and_seeds([CATALOGUE["fig-7.12"]], (26,), 3, suitable_only=False)
    assert (scenario.densities, scenario.seeds) == ((26,), 3)
    assert left_out == []


def test_a_scenario_without_a_suitable_density_is_left_out_or_refused() -> None:
    both = [CATALOGUE["fig-6.1a"], CATALOGUE["fig-7.12"]]
    scenarios, left_out = with_densities_and_seeds(both, (6, 13), 1, suitable_only=True)
    assert [(each.id, each.densities) for each in scenarios] == [("fig-6.1a", (6,)), ("fig-7.12", (13,))]
    assert left_out == []
    assert with_densities_and_seeds(both, (6,), 1, suitable_only=True)[1] == ["fig-7.12"]
    with pytest.raises(InputError, match=r"^n=6: must be a multiple of 13 .* \(fig-7\.12\)$"):
        with_densities_and_seeds(both, (6,), 1, suitable_only=False)
    with pytest.raises(InputError, match=r"^densities='7': must suit at least one scenario"):
        with_densities_and_seeds(both, (7,), 1, suitable_only=True)
