"""Learning: bandit, selection rules and rewards."""
