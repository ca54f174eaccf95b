"""One robot: its body, senses, state, behaviour and the account of its time."""
