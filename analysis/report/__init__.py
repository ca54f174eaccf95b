"""The report on a results directory: one HTML file with figures, tables and verdicts."""

from kswarms.analysis.report.coverage import PlannedScenario
from kswarms.analysis.report.page import Report, check_folder
from kswarms.analysis.report.report import build_report

__all__ = ["PlannedScenario", "Report", "build_report", "check_folder"]
