"""``python -m kswarms.scenarios.cli`` is ``kswarms``."""

from kswarms.scenarios.cli.app import main

main()
