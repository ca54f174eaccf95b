"""What there is to play: ``list`` and ``show``."""

from typing import Annotated

import typer

from scenarios.catalogue import CATALOGUE, TABLES
from scenarios.choice import chosen
from scenarios.description import toml_of


def list_scenarios() -> None:
    """List the scenarios of the catalogue, and the tables made of some."""
    titles = {name: scenario.title for name, scenario in CATALOGUE.items()}
    titles |= {name: table.title for name, table in TABLES.items()}
    width = max(map(len, titles))
    for name, title in titles.items():
        typer.echo(f"{name:<{width}}  {title}")


def show(
    wanted: Annotated[str, typer.Argument(metavar="ID", help="A scenario or table of the list.")],
) -> None:
    """Print a scenario as TOML, or those that a table is made of."""
    scenarios = chosen([wanted])
    typer.echo(toml_of(scenarios) if wanted in TABLES else scenarios[0].to_toml(), nl=False)
