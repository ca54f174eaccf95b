"""Shared by all packages: errors, validated data, files, compilation, limits, columns of tables, quoting."""
