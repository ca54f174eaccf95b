"""Watching a game: step by step, robot by robot, conflict by conflict."""
