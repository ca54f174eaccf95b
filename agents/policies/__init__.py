"""What decides at a conflict: fixed, learning, saved and user-defined policies."""
