"""Quantities of a game: a measure of one swarm, or of all swarms together."""

from typing import Final, Self

from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError

UNITS: Final = {
    "pucks": "pucks",
    "sud": "pucks",
    "duration": "s",
    "time_in_conflict": "% of time",
    "time_inter": "% of time",
    "time_intra": "% of time",
    "conflicts_inter": "conflicts",
    "conflicts_intra": "conflicts",
    "learned_attack": "% of robots",
    "learned_flight_within": "% of robots",
}
"""Units of the measures."""

LEARNED: Final = ("learned_attack", "learned_flight_within")
"""Measures from `policies.parquet`; the others are from `runs.parquet`."""


class Quantity(FrozenModel):
    """A measure of a game.

    Attributes
    ----------
    measure : str
        Key of `UNITS`. Times are shares of T(a) + T(p).
    scenario, condition : str
        Curve of the results.
    swarm : int, optional
        1 … K; None for all swarms together.
    opponent : int, optional
        Swarm that the robots learned to attack, for ``learned_attack`` with several opponents.
    """

    measure: str = "pucks"
    scenario: str = Field(min_length=1)
    condition: str = ""
    swarm: int | None = Field(default=None, ge=1)
    opponent: int | None = Field(default=None, ge=1)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.measure not in UNITS:
            raise InputError("measure", self.measure, f"must be one of {', '.join(UNITS)}")
        if self.swarm is None and self.measure in LEARNED:
            raise InputError("swarm", self.swarm, f"must be given: {self.measure} is a measure of one swarm")
        if self.swarm is None and self.measure in ("sud", "duration"):
            raise InputError("swarm", self.swarm, f"must be given: {self.measure} has no sum")
        if self.opponent is not None and self.measure != "learned_attack":
            raise InputError(
                "opponent", self.opponent, "must be omitted: only learned_attack has an opponent"
            )
        return self

    @property
    def unit(self) -> str:
        """Unit of the measure."""
        return UNITS[self.measure]

    @property
    def unit_of_difference(self) -> str:
        """Unit of the difference of two values."""
        return "percentage points" if self.unit.startswith("%") else self.unit

    def __str__(self) -> str:
        parts = [self.scenario]
        parts += [f"condition {self.condition!r}"] if self.condition else []
        parts += [f"S{self.swarm}"] if self.swarm else []
        parts += [f"({self.measure})"] if self.measure in LEARNED else []
        return " ".join(parts)
