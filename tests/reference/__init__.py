"""A second kernel in plain numpy, and generated states: what the compiled one is compared with."""
