"""What a robot learns with: the bandit, selection rules and rewards."""
