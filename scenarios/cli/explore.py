"""``explore``: the live page."""

from functools import partial
from importlib.util import find_spec
from typing import Annotated

import typer

from agents.errors import InputError
from scenarios.cli.options import RunDigest, Watched, watched


def explore(
    what: Watched = None,
    run: RunDigest = "",
    port: Annotated[int, typer.Option(help="Port of this machine; 0 for any that is free.")] = 8765,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Only print the address, open no browser.")
    ] = False,
) -> None:
    """Open a page in which games are watched, changed and looked into; Ctrl-C ends it."""
    if find_spec("solara") is None:
        raise InputError("explore", "solara", "is not installed: pip install 'kswarms[explore]'")
    from scenarios.explore.server import serve
    from scenarios.explore.session import Session

    scenario, results = watched(what, run)
    begin = partial(Session, scenario, run, results) if run else partial(Session, scenario)
    begin().close()  # a mistake is told here, not in the page
    serve(begin, port, not no_browser, lambda address: typer.echo(f"page: {address}  (Ctrl-C ends it)"))
