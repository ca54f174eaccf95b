"""Shared by all packages: errors, validated data, atomic files, compilation, limits, columns of tables."""
