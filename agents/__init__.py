"""Krembots: their bodies, senses, actions, policies and lives. Knows nothing of the model they live in."""
