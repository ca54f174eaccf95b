"""Runs: one game with one seed, and how many of them are played."""
