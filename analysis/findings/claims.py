"""Claims: testable statements about quantities, as data."""

from typing import Literal, Self

from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings.quantity import LEARNED, Quantity


class _ClaimAtDensities(FrozenModel):
    """A claim about quantities at some densities.

    Attributes
    ----------
    densities : tuple of int
        Numbers of robots, ascending; empty for all densities that the quantities have in common.
    """

    densities: tuple[int, ...] = ()

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        if list(self.densities) != sorted(set(self.densities)):
            raise InputError("densities", list(self.densities), "must ascend")
        return self

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """All quantities of the claim."""
        fields = [getattr(self, name) for name in type(self).model_fields]
        flat = [item for field in fields for item in (field if isinstance(field, tuple) else (field,))]
        return tuple(item for item in flat if isinstance(item, Quantity))


class Compare(_ClaimAtDensities):
    """A comparison of two quantities, or of a quantity and a number, seed by seed.

    Attributes
    ----------
    left, right : Quantity or float
        The two sides; a number has the unit of `left`.
    relation : str
        With d = left − right: ``>`` is d > margin, ``>=`` is d ≥ −margin, ``<`` is d < −margin, ``<=`` is
        d ≤ margin, and ``within`` is −margin ≤ d ≤ margin.
    over : str
        ``each N``: the relation holds at every density. ``mean over N`` and ``sum over N``: it holds for the
        mean or the sum over the densities.
    margin : float
        Margin in the unit of the quantities, ≥ 0.
    """

    kind: Literal["compare"] = "compare"
    left: Quantity
    relation: Literal[">", ">=", "<", "<=", "within"]
    right: Quantity | float
    over: Literal["each N", "mean over N", "sum over N"] = "each N"
    margin: float = Field(default=0.0, ge=0)

    @model_validator(mode="after")
    def _check_units(self) -> Self:
        unit = self.left.unit
        if isinstance(self.right, Quantity) and self.right.unit != unit:
            raise InputError("right.measure", self.right.measure, f"must have the unit of left, {unit}")
        return self


class Overtake(_ClaimAtDensities):
    """One quantity overtakes another between two densities, and stays ahead.

    Attributes
    ----------
    ahead, behind : Quantity
        The quantity that is larger at many robots, and the other quantity.
    between : tuple of int
        Two densities; the last crossing is between them.
    """

    kind: Literal["overtake"] = "overtake"
    ahead: Quantity
    behind: Quantity
    between: tuple[int, int]

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.between[0] >= self.between[1]:
            raise InputError("between", list(self.between), "must ascend")
        unit = self.ahead.unit
        if self.behind.unit != unit:
            raise InputError("behind.measure", self.behind.measure, f"must have the unit of ahead, {unit}")
        return self


class Peak(_ClaimAtDensities):
    """A quantity rises with N, then falls: at some density it exceeds both the first and the last."""

    kind: Literal["rise then fall"] = "rise then fall"
    quantity: Quantity


class Trend(_ClaimAtDensities):
    """A quantity rises with N: Spearman's rank correlation of its mean with N exceeds `above`, −1 … 1."""

    kind: Literal["trend"] = "trend"
    quantity: Quantity
    above: float = Field(default=0.0, ge=-1, lt=1)


class Share(_ClaimAtDensities):
    """More than `above` percent of a swarm's robots in all games learned an action."""

    kind: Literal["share above"] = "share above"
    quantity: Quantity
    above: float = Field(ge=0, lt=100)

    @model_validator(mode="after")
    def _check_measure(self) -> Self:
        measure = self.quantity.measure
        if measure not in LEARNED:
            raise InputError("quantity.measure", measure, f"must be one of {', '.join(LEARNED)}")
        return self


class Agreement(_ClaimAtDensities):
    """Learned shares agree with the published table, or scores with those of ARGoS.

    Attributes
    ----------
    cells : tuple of Quantity
        Columns of Tables 6.1 to 6.3, or pucks of the scenarios ``argos-*`` (`published.published_cells`);
        each has a cell for each density.
    margin : float
        Maximum mean absolute error of the cells (percentage points, or pucks).
    """

    kind: Literal["agree with the published table"] = "agree with the published table"
    cells: tuple[Quantity, ...] = Field(min_length=1)
    margin: float = Field(gt=0)

    @model_validator(mode="after")
    def _check_measures(self) -> Self:
        given = [cell.measure for cell in self.cells]
        scores = all(cell.measure == "pucks" and cell.scenario.startswith("argos-") for cell in self.cells)
        if not scores and any(measure not in LEARNED for measure in given):
            raise InputError(
                "cells", given, "must be columns of Tables 6.1 to 6.3: learned shares, or pucks of ARGoS"
            )
        return self


Claim = Compare | Overtake | Peak | Trend | Share | Agreement
