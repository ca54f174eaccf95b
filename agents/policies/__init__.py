"""Policies: fixed, learning, saved and user-defined."""
