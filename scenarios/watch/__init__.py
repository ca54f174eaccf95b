"""Watching a game: playing it stepwise, looking into a robot, telling its conflicts."""
