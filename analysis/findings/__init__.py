"""Findings: statements about outcomes, and their verdicts by results (section 3.4 of the experiments)."""

from collections.abc import Iterable
from pathlib import Path
from typing import Final

from kswarms.agents.common.errors import require_type
from kswarms.analysis.findings.finding import Finding, read_findings
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

FINDINGS: Final = read_findings(Path(__file__).with_name("thesis.toml"))
"""Findings of the thesis."""


def judge_all(results: Results, findings: Iterable[Finding] = FINDINGS) -> list[Verdict]:
    """Judge findings in order, with `judge`."""
    require_type("findings", findings, Iterable, "must be findings, see read_findings")
    return [judge(finding, results) for finding in findings]
