"""Run ``kswarms`` as ``python -m kswarms.scenarios.cli``."""

from kswarms.scenarios.cli.app import main

main()
