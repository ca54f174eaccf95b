"""Robots: bodies, senses, actions, policies and behaviour. Independent of the model."""
