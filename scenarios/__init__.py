"""Experiments: scenarios as data, their runs, the tables of results and the command line."""
