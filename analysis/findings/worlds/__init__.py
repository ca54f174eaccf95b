"""Findings and targets over several worlds: discrepancies, implausibilities and verdicts."""
