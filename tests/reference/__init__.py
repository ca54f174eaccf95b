"""A reference kernel in plain numpy, and generated states to compare the compiled kernel with it."""
