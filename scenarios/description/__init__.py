"""A scenario as data, and its TOML file."""
