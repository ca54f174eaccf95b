"""Targets of a calibration as data: claims, each with the tolerance up to which a world may miss it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final, Self, cast

import numpy as np
from pydantic import Field, model_validator

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_toml, to_path
from kswarms.analysis.findings.claims import Agreement, Claim, Overtake, Peak, Trend
from kswarms.analysis.findings.data import ClaimData, NoDataError, format_densities
from kswarms.analysis.findings.worlds.discrepancy import discrepancy_of_means, means_of
from kswarms.analysis.results.runs import Results
from kswarms.analysis.statistics.intervals import Values

BUILT_IN: Final = ("chapter-6",)
"""Names of the targets that are package data."""


class Target(FrozenModel):
    """A claim that a world should meet.

    Attributes
    ----------
    id : str
        Short name.
    claim : Claim
        The claim, with its densities.
    tolerance : float, optional
        The discrepancy up to which the claim counts as met, in the unit of the claim. It is the margin of
        the claim for an `Agreement`, and must be given for other claims.
    weight : float
        Factor of the implausibility.
    stage : int
        From 1. A world is checked stage by stage and rejected at the first that it misses.
    """

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")
    claim: Annotated[Claim, Field(discriminator="kind")]
    tolerance: float | None = Field(default=None, gt=0)
    weight: float = Field(default=1.0, gt=0)
    stage: int = Field(default=1, ge=1)

    @model_validator(mode="after")
    def _check(self) -> Self:
        needed = 3 if isinstance(self.claim, Peak | Trend) else 2 if isinstance(self.claim, Overtake) else 1
        if len(self.claim.densities) < needed:
            rule = f"must be {needed} or more for a target of this kind"
            raise InputError("claim.densities", list(self.claim.densities), rule)
        with_margin = isinstance(self.claim, Agreement)
        if with_margin != (self.tolerance is None):
            omitted = "must be omitted: the margin of the claim is the tolerance"
            rule = omitted if with_margin else "must be given for a claim of this kind"
            raise InputError("tolerance", self.tolerance, rule)
        return self

    @property
    def _scale(self) -> float:
        return self.claim.margin if isinstance(self.claim, Agreement) else cast(float, self.tolerance)

    def outputs(self, results: Results) -> Values:
        """Return the means over the seeds that the claim is about, shape (quantities * densities,).

        `InputError` if the results lack what the claim is about, such as learners.
        """
        try:
            data = ClaimData(self.claim, results)
            if data.densities != list(self.claim.densities):
                raise NoDataError(f"not all of {format_densities(self.claim.densities)}")
            return means_of(data).ravel()
        except NoDataError as missing:
            rule = f"must be about games that have its quantities: {missing}"
            raise InputError("targets", self.id, rule) from None

    def implausibility(self, outputs: Values) -> Values:
        """Return weight · discrepancy / tolerance of each row of outputs; a target is met up to 1."""
        densities = self.claim.densities
        means = outputs.reshape(len(outputs), -1, len(densities))
        found: Values = self.weight * discrepancy_of_means(self.claim, densities, means) / self._scale
        return found


class Targets(FrozenModel):
    """The targets of a calibration.

    Attributes
    ----------
    name : str
        Name of the set.
    seeds : tuple of int
        Number of games for each density and curve, by stage.
    targets : tuple of Target
        At least one for each stage.
    """

    name: str = Field(min_length=1)
    seeds: tuple[Annotated[int, Field(ge=1, le=1000)], ...] = Field(min_length=1)
    targets: tuple[Target, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _check(self) -> Self:
        ids = [target.id for target in self.targets]
        for name in ids:
            if ids.count(name) > 1:
                raise InputError("targets.id", name, "must be given once")
        stages = {target.stage for target in self.targets}
        if stages != set(range(1, len(self.seeds) + 1)):
            rule = f"must be 1 to {len(self.seeds)}, as many as there are seeds, each with a target"
            raise InputError("targets.stage", sorted(stages), rule)
        return self

    def of_stage(self, stage: int) -> tuple[Target, ...]:
        """Return the targets of a stage."""
        return tuple(target for target in self.targets if target.stage == stage)

    def outputs(self, stage: int, results: Results) -> Values:
        """Return the outputs of the targets of a stage, one target after the other."""
        return np.concatenate([target.outputs(results) for target in self.of_stage(stage)])

    def implausibility(self, stage: int, outputs: Values) -> Values:
        """Return the implausibility of each target of a stage, shape (sets, targets).

        `outputs` has the outputs of a stage in each row.
        """
        targets = self.of_stage(stage)
        ends = np.cumsum([len(target.claim.quantities) * len(target.claim.densities) for target in targets])
        parts = np.split(outputs, ends[:-1], axis=1)
        return np.column_stack(
            [target.implausibility(part) for target, part in zip(targets, parts, strict=True)]
        )

    def curves(self, stage: int) -> Mapping[tuple[str, str], tuple[int, ...]]:
        """Return the densities that the targets of a stage need, by scenario and condition."""
        needed: dict[tuple[str, str], set[int]] = {}
        for target in self.of_stage(stage):
            for quantity in target.claim.quantities:
                curve = quantity.scenario, quantity.condition
                needed.setdefault(curve, set()).update(target.claim.densities)
        return {curve: tuple(sorted(densities)) for curve, densities in needed.items()}


def read_targets(name: str | Path) -> Targets:
    """Read targets from a TOML file, or the built-in ones of a name.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or has invalid or other content.
    """
    if name in BUILT_IN:
        return Targets(**read_toml("targets", Path(__file__).with_name(f"{name}.toml")))
    if not str(name).endswith(".toml"):
        raise InputError("targets", str(name), f"must be one of {', '.join(BUILT_IN)}, or a file as my.toml")
    return Targets(**read_toml("targets", to_path("targets", name)))
