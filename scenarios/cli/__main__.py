"""``python -m scenarios.cli`` is ``kswarms``."""

from scenarios.cli.app import main

main()
