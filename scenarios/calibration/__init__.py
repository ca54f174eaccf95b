"""Calibration: the worlds that are compatible with all targets."""
