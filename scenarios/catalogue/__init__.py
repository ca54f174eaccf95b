"""The catalogue: a scenario for every figure of chapters 6 and 7 of the source, and their tables.

The entries follow the tables of sections 3.2 and 3.3 of the specification, and omit default values.
"""

from typing import Final, NamedTuple

from kswarms.scenarios.catalogue.argos import ARGOS
from kswarms.scenarios.catalogue.chapter_6 import SYMMETRIC
from kswarms.scenarios.catalogue.chapter_7 import DISADVANTAGED

CATALOGUE: Final = {scenario.id: scenario for scenario in (*SYMMETRIC, *DISADVANTAGED, *ARGOS)}
"""Scenarios by id, in the order of the source."""


class SourceTable(NamedTuple):
    """A table of the source about learned policies. `scenarios` are the ids of its figures."""

    title: str
    scenarios: tuple[str, ...]


TABLES: Final = {
    "table-6.1": SourceTable("Learned to attack: figures 6.4a and 6.4b", ("fig-6.4a", "fig-6.4b")),
    "table-6.2": SourceTable("Learned to attack, and to flee within the swarm: figure 6.8", ("fig-6.8",)),
    "table-6.3": SourceTable("Learned to attack: figure 6.12", ("fig-6.12",)),
    "table-7.1": SourceTable("Learned to attack: figure 7.4", ("fig-7.4",)),
    "table-7.2": SourceTable("Learned to attack: figures 7.16a and 7.16b", ("fig-7.16a", "fig-7.16b")),
}
"""Tables by id, in the order of the source."""
