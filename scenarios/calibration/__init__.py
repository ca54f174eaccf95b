"""Calibration: the free parameters fitted to Table 6.1."""
