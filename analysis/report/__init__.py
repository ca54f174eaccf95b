"""The report on a results directory: one HTML file with figures, tables and verdicts."""

from kswarms.analysis.report.coverage import Planned
from kswarms.analysis.report.page import Report
from kswarms.analysis.report.report import build_report

__all__ = ["Planned", "Report", "build_report"]
