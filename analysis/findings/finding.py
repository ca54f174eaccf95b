"""Findings as data, and reading findings from TOML."""

from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_toml, to_path
from kswarms.analysis.findings.claims import Claim
from kswarms.analysis.statistics.intervals import CONFIDENCE


class Finding(FrozenModel):
    """A statement about outcomes, and a claim that results can test.

    Attributes
    ----------
    id, statement : str
        Short name, and the statement as a sentence.
    source : str
        Section and figure with the statement.
    claim : Claim
        The statement in testable form.
    confidence : float
        Level of the intervals.
    """

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")
    statement: str = Field(min_length=1)
    source: str = ""
    claim: Annotated[Claim, Field(discriminator="kind")]
    confidence: float = Field(default=CONFIDENCE, gt=0, lt=1)

    @property
    def scenarios(self) -> tuple[str, ...]:
        """Ids of the scenarios that the claim is about."""
        return tuple(dict.fromkeys(quantity.scenario for quantity in self.claim.quantities))


class _FindingsFile(FrozenModel):
    findings: tuple[Finding, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _check_ids(self) -> Self:
        ids = [finding.id for finding in self.findings]
        for name in ids:
            if ids.count(name) > 1:
                raise InputError("findings.id", name, "must be given once")
        return self


def read_findings(path: str | Path) -> tuple[Finding, ...]:
    """Read findings from a TOML file with an array of tables ``findings``.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or has invalid or other content.
    """
    return _FindingsFile(**read_toml("findings", to_path("findings", path))).findings
