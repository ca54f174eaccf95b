"""What there is to play: ``list`` and ``show``."""

from collections.abc import Iterable
from typing import Annotated

import typer

from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selecting import chosen
from kswarms.scenarios.cli.options import ids
from kswarms.scenarios.cli.printing import print_columns
from kswarms.scenarios.cli.progress import clock
from kswarms.scenarios.description.condition import Condition
from kswarms.scenarios.description.scenario import Scenario, toml_of
from kswarms.scenarios.runs.cost import cpu_seconds


def list_scenarios() -> None:
    """List the scenarios of the catalogue, and the tables made of some, with what they take on one core."""
    rows = [("id", "curves", "runs", "CPU time", "title")]
    for name, scenario in CATALOGUE.items():
        rows.append((name, *_size([scenario]), scenario.title))
    for name, table in TABLES.items():
        rows.append((name, *_size(CATALOGUE[each] for each in table.scenarios), table.title))
    rows.append(("--all", *_size(CATALOGUE.values()), "All scenarios; what they share is played once"))
    print_columns(rows, left=(0, 4))


def _size(scenarios: Iterable[Scenario]) -> tuple[str, str, str]:
    """Return the curves, the runs and their CPU time, what is the same but for its name once."""
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
    return str(len(curves)), f"{sum(seeds.values()):,}", clock(cost)


def show(
    wanted: Annotated[
        str,
        typer.Argument(
            metavar="ID", help="A scenario or table of the list, or my.toml.", autocompletion=ids
        ),
    ],
) -> None:
    """Print a scenario as TOML, or those that a table is made of; edited, `kswarms run my.toml` plays it."""
    scenarios = chosen([wanted])
    typer.echo(
        toml_of(scenarios) if len(scenarios) > 1 or wanted in TABLES else scenarios[0].to_toml(), nl=False
    )
