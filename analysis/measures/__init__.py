"""Measures of results: utilities, contributions, networks, emergence, density of conflicts."""
