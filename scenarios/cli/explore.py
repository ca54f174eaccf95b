"""``explore``: the live page."""

from importlib.util import find_spec
from typing import Annotated

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.options import RunDigest, Watched, asked


def explore(
    what: Watched = None,
    run: RunDigest = "",
    port: Annotated[
        int, typer.Option(help="Port of this machine, 1 to 65535; 0 for any that is free.")
    ] = 8765,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only print the address, open no browser.")
    ] = False,
) -> None:
    """Open a page in which games are watched, changed and looked into; Ctrl-C ends it."""
    if find_spec("solara") is None:
        raise InputError("explore", "solara", "is not installed: pip install 'kswarms[explore]'")
    from kswarms.scenarios.explore.server import serve
    from kswarms.scenarios.explore.session import Session

    start = asked(what, run)
    Session(start).close()  # a mistake is told here, not in the page
    serve(start, port, not no_browser, lambda address: typer.echo(f"page: {address}  (Ctrl-C ends it)"))
