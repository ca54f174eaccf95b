"""One robot: senses, state, behaviour and time accounting."""
