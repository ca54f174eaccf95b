"""Findings: statements about outcomes, and their verdicts by results (section 3.4 of the experiments)."""

from collections.abc import Iterable
from importlib.resources import files
from typing import Final

from kswarms.agents.common.errors import require_type
from kswarms.analysis.findings.finding import Finding, parse_findings, read_findings
from kswarms.analysis.findings.judging import judge
from kswarms.analysis.findings.verdicts import FAILS, HOLDS, NO_DATA, UNDECIDED, Verdict
from kswarms.analysis.results.runs import Results

__all__ = [
    "FAILS",
    "FINDINGS",
    "HOLDS",
    "NO_DATA",
    "UNDECIDED",
    "Finding",
    "Verdict",
    "judge",
    "judge_all",
    "read_findings",
]

_THESIS: Final = files(__name__).joinpath("thesis.toml")
FINDINGS: Final = parse_findings(_THESIS.read_text(encoding="utf-8"), "thesis.toml")
"""Findings of the thesis."""


def judge_all(results: Results, findings: Iterable[Finding] = FINDINGS) -> list[Verdict]:
    """Judge findings in order, with `judge`."""
    require_type("findings", findings, Iterable, "must be findings, see read_findings")
    return [judge(finding, results) for finding in findings]
