"""Calibration: a fit of the free parameters to Table 6.1."""
