"""Findings as data: what is claimed of which scenarios, in a form that results can answer.

A finding is a sentence and a claim. Each kind of claim is a small checked description; TOML files hold lists
of findings. How a claim is judged stands in `kswarms.analysis.findings.verdicts`.
"""

import tomllib
from pathlib import Path
from typing import Annotated, Final, Literal, Self

from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import CONFIDENCE

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
"""What can be measured, and its unit."""

LEARNED: Final = ("learned_attack", "learned_flight_within")
"""What `policies.parquet` tells; the others are from `runs.parquet`."""

Relation = Literal[">", ">=", "<", "<=", "within"]


class Quantity(Checked):
    """A number that each game gives: a measure of a swarm under a condition of a scenario.

    Attributes
    ----------
    measure : str
        One of `UNITS`. Times are shares of T(a) + T(p).
    scenario, condition : str
        Which curve.
    swarm : int, optional
        1 … K; None is all swarms together.
    opponent : int, optional
        Of ``learned_attack`` where several opponents are learned about: which one.
    """

    measure: str = "pucks"
    scenario: str = Field(min_length=1)
    condition: str = ""
    swarm: int | None = Field(default=None, ge=1)
    opponent: int | None = Field(default=None, ge=1)

    @model_validator(mode="after")
    def _measurable(self) -> Self:
        if self.measure not in UNITS:
            raise InputError("measure", self.measure, f"must be one of {', '.join(UNITS)}")
        if self.measure in LEARNED and self.swarm is None:
            raise InputError("swarm", self.swarm, f"must be given: {self.measure} is of one swarm")
        if self.measure in ("sud", "duration") and self.swarm is None:
            raise InputError("swarm", self.swarm, f"must be given: {self.measure} does not add up")
        if self.opponent is not None and self.measure != "learned_attack":
            raise InputError("opponent", self.opponent, "must be left out: only learned_attack has one")
        return self

    @property
    def unit(self) -> str:
        """Unit of the measure."""
        return UNITS[self.measure]


class _OverDensities(Checked):
    densities: tuple[int, ...] = ()

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if list(self.densities) != sorted(set(self.densities)):
            raise InputError("densities", list(self.densities), "must ascend")
        return self


class Compare(_OverDensities):
    """One quantity against another, or against a number, seed by seed.

    Attributes
    ----------
    left, right : Quantity or float
        What is compared; a number is in the unit of `left`.
    relation : str
        ``>``: left exceeds right by more than the margin; ``>=``: left is less than right by no more than
        the margin; ``<`` and ``<=`` the reverse; ``within``: they differ by no more than the margin.
    over : str
        ``each N``: the relation holds at every density; ``mean over N``, ``sum over N``: of these.
    margin : float
        In the unit of the quantities, ≥ 0.
    densities : tuple of int
        Numbers of robots; empty for all that both sides have.
    """

    kind: Literal["compare"] = "compare"
    left: Quantity
    relation: Relation
    right: Quantity | float
    over: Literal["each N", "mean over N", "sum over N"] = "each N"
    margin: float = Field(default=0.0, ge=0)

    @model_validator(mode="after")
    def _of_one_unit(self) -> Self:
        if isinstance(self.right, Quantity) and self.right.unit != self.left.unit:
            raise InputError(
                "right.measure", self.right.measure, f"must be in {self.left.unit}, as the left is"
            )
        return self

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the results must hold."""
        return (self.left, self.right) if isinstance(self.right, Quantity) else (self.left,)


class Overtake(_OverDensities):
    """One quantity overtakes another between two densities, and stays ahead.

    Attributes
    ----------
    ahead, behind : Quantity
        Which is ahead where robots are many, and which is then behind.
    between : tuple of int
        The two densities: behind at or before the one, ahead at and after the other.
    densities : tuple of int
        Numbers of robots; empty for all that both have.
    """

    kind: Literal["overtake"] = "overtake"
    ahead: Quantity
    behind: Quantity
    between: tuple[int, int]

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.between[0] >= self.between[1]:
            raise InputError("between", list(self.between), "must ascend")
        if self.ahead.unit != self.behind.unit:
            raise InputError(
                "behind.measure", self.behind.measure, f"must be in {self.ahead.unit}, as ahead is"
            )
        return self

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the results must hold."""
        return (self.ahead, self.behind)


class Peak(_OverDensities):
    """A quantity rises with N, then falls: at some density it exceeds both the first and the last.

    Attributes
    ----------
    quantity : Quantity
        What rises and falls.
    densities : tuple of int
        Numbers of robots; empty for all that there are.
    """

    kind: Literal["rise then fall"] = "rise then fall"
    quantity: Quantity

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the results must hold."""
        return (self.quantity,)


class Trend(_OverDensities):
    """A quantity goes up with N: Spearman's rank correlation of its mean with N exceeds a number.

    Attributes
    ----------
    quantity : Quantity
        What goes up.
    above : float
        What the correlation exceeds, −1 … 1.
    densities : tuple of int
        Numbers of robots; empty for all that there are.
    """

    kind: Literal["trend"] = "trend"
    quantity: Quantity
    above: float = Field(default=0.0, ge=-1, lt=1)

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the results must hold."""
        return (self.quantity,)


class Share(_OverDensities):
    """Of all robots of a swarm, in all games, more than some percentage learned this.

    Attributes
    ----------
    quantity : Quantity
        A measure in % of robots.
    above : float
        Percentage, 0 … 100.
    densities : tuple of int
        Numbers of robots; empty for all that there are.
    """

    kind: Literal["share above"] = "share above"
    quantity: Quantity
    above: float = Field(ge=0, lt=100)

    @model_validator(mode="after")
    def _of_robots(self) -> Self:
        if self.quantity.measure not in LEARNED:
            raise InputError(
                "quantity.measure", self.quantity.measure, f"must be one of {', '.join(LEARNED)}"
            )
        return self

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the results must hold."""
        return (self.quantity,)


class Agreement(_OverDensities):
    """What was learned agrees with the published table: the mean absolute error of its cells is bounded.

    Attributes
    ----------
    cells : tuple of Quantity
        Columns of Tables 6.1 and 6.2 (`published.learned_percentages`), a cell at each density.
    margin : float
        Percentage points that the mean absolute error does not exceed.
    densities : tuple of int
        Numbers of robots; empty for all that there are.
    """

    kind: Literal["agree with the published table"] = "agree with the published table"
    cells: tuple[Quantity, ...] = Field(min_length=1)
    margin: float = Field(gt=0)

    @model_validator(mode="after")
    def _learned(self) -> Self:
        if any(cell.measure not in LEARNED for cell in self.cells):
            given = [cell.measure for cell in self.cells]
            raise InputError("cells", given, "must be columns of Tables 6.1 and 6.2: what was learned")
        return self

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What the results must hold."""
        return self.cells


Claim = Compare | Overtake | Peak | Trend | Share | Agreement


class Finding(Checked):
    """A sentence about outcomes, and the claim by which results decide it.

    Attributes
    ----------
    id : str
        Short name, by which the finding is cited.
    statement : str
        The sentence.
    source : str
        Where it was found: section and figure.
    claim : Claim
        The sentence in a form that can be tested.
    confidence : float
        Level of the intervals that decide.
    """

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")
    statement: str = Field(min_length=1)
    source: str = ""
    claim: Annotated[Claim, Field(discriminator="kind")]
    confidence: float = Field(default=CONFIDENCE, gt=0, lt=1)

    @property
    def scenarios(self) -> tuple[str, ...]:
        """Ids of the scenarios that it takes to judge the finding."""
        return tuple(dict.fromkeys(quantity.scenario for quantity in self.claim.quantities))


class _File(Checked):
    findings: tuple[Finding, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _told_apart(self) -> Self:
        ids = [finding.id for finding in self.findings]
        for name in ids:
            if ids.count(name) > 1:
                raise InputError("findings.id", name, "must be given once")
        return self


def load(path: Path) -> tuple[Finding, ...]:
    """Read findings from a TOML file, an array of tables ``findings``.

    Raises
    ------
    InputError
        The file cannot be read, is no TOML, or holds something else than findings.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("findings", str(path), "must be a readable TOML file") from error
    return parse(text, str(path))


def parse(text: str, name: str) -> tuple[Finding, ...]:
    """Read findings from TOML text; `name` is what an error calls it.

    Raises
    ------
    InputError
        As for `load`.
    """
    try:
        content = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError("findings", name, f"must be TOML: {error}") from error
    return _File(**content).findings
