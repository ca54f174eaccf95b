"""Contributions: the same games played without single robots."""
