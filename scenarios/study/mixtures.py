"""Refusal of mixtures: the runs of a study have one version, one environment and one curve for each name."""

from typing import NamedTuple

from kswarms.agents.common.errors import InputError

Curve = tuple[str, str]
"""Scenario and condition."""


class Contents(NamedTuple):
    """What runs have in common."""

    versions: set[str]
    """Versions of the package."""
    environments: set[str]
    """Environments that played them (`kswarms.scenarios.runs.outcome.environment`)."""
    curves: dict[Curve, str]
    """Descriptions of their curves."""


def refuse_mixtures(directory: str, held: Contents, added: Contents, origin: str, allow_mixed: bool) -> None:
    """Raise an `InputError` if runs of a directory must not be mixed with others.

    Parameters
    ----------
    directory : str
        The directory.
    held, added : Contents
        Its runs, and the other runs.
    origin : str
        Subject and verb for the other runs, such as 'this is'.
    allow_mixed : bool
        Whether environments may differ.
    """
    for version in sorted(held.versions):
        for other in added.versions - {version}:
            reason = f"has runs of kswarms {version}, {origin} {other}; use another directory"
            raise InputError("out", directory, reason)
    for environment in () if allow_mixed else sorted(held.environments):
        for other in added.environments - {environment}:
            reason = f"has runs of {environment}, {origin} {other}; use another directory, or --allow-mixed"
            raise InputError("out", directory, reason)
    for curve, text in held.curves.items():
        if added.curves.get(curve, text) != text:
            reason = (
                f"has runs of a different {' '.join(curve).strip()}; use another directory, or another id"
            )
            raise InputError("out", directory, reason)
