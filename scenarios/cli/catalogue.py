"""``list`` and ``show``: the scenarios of the catalogue."""

from collections.abc import Iterable
from typing import Annotated

import typer

from kswarms.agents.common.quoting import for_toml
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selection import select_scenarios
from kswarms.scenarios.cli.options import complete_ids
from kswarms.scenarios.cli.printing import format_duration, print_columns
from kswarms.scenarios.description.condition import Condition
from kswarms.scenarios.description.scenario import Scenario, toml_of
from kswarms.scenarios.runs.run import cpu_seconds


def list_scenarios() -> None:
    """List the scenarios and tables of the catalogue, with their estimated CPU time.

    Example: kswarms list
    """
    rows = [("id", "curves", "runs", "CPU time", "title")]
    for name, scenario in CATALOGUE.items():
        rows.append((name, *_cost([scenario]), scenario.title))
    for name, table in TABLES.items():
        rows.append((name, *_cost(CATALOGUE[each] for each in table.scenarios), table.title))
    rows.append(("--all", *_cost(CATALOGUE.values()), "All scenarios; shared runs are played once"))
    print_columns(rows, left=(0, 4))


def _cost(scenarios: Iterable[Scenario]) -> tuple[str, str, str]:
    """Return the numbers of curves and runs, and the CPU time; equal runs count once."""
    seeds: dict[tuple[Condition, int], int] = {}
    for scenario in scenarios:
        for condition in scenario.conditions:
            nameless = condition.model_copy(update={"name": ""})
            for n in scenario.densities:
                seeds[nameless, n] = max(scenario.seeds, seeds.get((nameless, n), 0))
    curves = {condition for condition, _ in seeds}
    cost = sum(
        games * cpu_seconds(n, each.learning, each.duration, each.puck_limit, each.parameters.period)
        for (each, n), games in seeds.items()
    )
    return str(len(curves)), f"{sum(seeds.values()):,}", format_duration(cost)


def show(
    source: Annotated[
        str,
        typer.Argument(
            metavar="ID", help="Scenario or table of `kswarms list`, or my.toml.", autocompletion=complete_ids
        ),
    ],
) -> None:
    """Print a scenario, or the scenarios of a table, as TOML. Edit a copy and play it: `kswarms run my.toml`.

    Example: kswarms show fig-6.1c
    """
    scenarios = select_scenarios([source])
    text = toml_of(scenarios) if len(scenarios) > 1 or source in TABLES else scenarios[0].to_toml()
    typer.echo(for_toml(text), nl=False)
