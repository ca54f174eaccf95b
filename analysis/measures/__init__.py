"""Measures of results: utilities, contributions, networks, emergence, conflict density."""
