"""Findings: statements about outcomes that results decide (section 3.4 of the experiments)."""

from collections.abc import Iterable
from importlib.resources import files
from typing import Final

from kswarms.analysis.findings.finding import Finding, parse, read_findings
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

FINDINGS: Final = parse(files(__name__).joinpath("thesis.toml").read_text(encoding="utf-8"), "thesis.toml")
"""Findings of the thesis, as far as it states its outcomes."""


def judge_all(results: Results, findings: Iterable[Finding] = FINDINGS) -> list[Verdict]:
    """Judge findings in their order, as `judge` does."""
    return [judge(finding, results) for finding in findings]
