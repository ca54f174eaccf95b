"""Contributions of robots, measured by games without them."""
