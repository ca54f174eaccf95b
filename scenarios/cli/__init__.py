"""The command line ``kswarms``: a module for each command. `app` registers them."""

from kswarms.scenarios.cli.app import invoke, main

__all__ = ["invoke", "main"]
