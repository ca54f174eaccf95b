"""``explore``: the live page."""

from functools import partial
from importlib.util import find_spec
from typing import Annotated

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.options import RunDigest, Source, Trust, resolve_source


def explore(
    source: Source = None,
    run: RunDigest = "",
    trust: Trust = False,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port; 0 for any free port.")] = 8765,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Do not open a browser.")] = False,
    allow_code: Annotated[
        bool,
        typer.Option("--allow-code", help="Fields of the page may name Python code and files."),
    ] = False,
) -> None:
    """Open a page to watch, change and inspect games. Ctrl-C ends it.

    Example: kswarms explore fig-6.4b
    """
    if find_spec("solara") is None:
        raise InputError("explore", "solara", "is not installed: pip install 'kswarms[explore]'")
    from kswarms.scenarios.explore.server import serve
    from kswarms.scenarios.explore.session import Session

    new_session = partial(Session, resolve_source(source, run, trust), allow_code)
    new_session().close()  # reports an error here, before a page is opened
    serve(new_session, port, not no_browser, lambda address: typer.echo(f"page: {address}  (Ctrl-C ends it)"))
