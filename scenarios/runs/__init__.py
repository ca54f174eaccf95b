"""Runs: one game with one seed each, played alone or in a sweep."""
