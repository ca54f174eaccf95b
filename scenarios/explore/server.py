"""Server of the page. It is reachable from this machine only and needs no network."""

import os
import socket
import threading
import time
import warnings
import webbrowser
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import uvicorn
from solara.server import settings

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.explore import page
from kswarms.scenarios.explore.guard import Application, Guard
from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.signals import deferred_signals

HOST: Final = "127.0.0.1"
"""Host of the page. ``localhost`` may mean the IPv6 address too, where another user may listen."""


def serve(
    new_session: Callable[[], Session], port: int, open_browser: bool, ready: Callable[[str], None]
) -> None:
    """Serve the page on a port (0 for any free port) until interrupted.

    `new_session` makes the session of a new page. `ready` is called with the address when the page can be
    opened. The address contains a token; without it, the page is refused (see `Guard`).
    """
    try:
        listener = socket.create_server((HOST, port))
    except OSError:
        raise InputError("port", port, "must be a free port of this machine, 0 for any") from None
    private = TemporaryDirectory(prefix="kswarms-explore-") if open_browser else nullcontext("")
    with listener, private as directory:
        port = listener.getsockname()[1]
        guard = Guard(_create_application(new_session), port)
        address = f"http://{HOST}:{port}/?token={guard.token}"
        config = uvicorn.Config(
            guard, log_level="error", access_log=False, proxy_headers=False, server_header=False
        )
        server = uvicorn.Server(config)

        def announce() -> None:
            while not server.started:
                time.sleep(0.05)
            ready(address)
            if open_browser:
                webbrowser.open(_write_link(Path(directory), address))

        def stop() -> None:
            server.should_exit = True

        threading.Thread(target=announce, daemon=True).start()
        with deferred_signals(stop):  # uvicorn handles SIGINT and SIGTERM in the same way, but not SIGHUP
            server.run(sockets=[listener])


def _write_link(directory: Path, address: str) -> str:
    """Write a file that leads to the page; return its address.

    All users of a machine can read the command line of a browser, but not this file in a private directory.
    """
    link = directory / "page.html"
    link.write_text(f'<!doctype html><meta http-equiv="refresh" content="0;url={address}">')
    return link.as_uri()


def _create_application(new_session: Callable[[], Session]) -> Application:
    """Return the ASGI application of the page, which contacts no other machine."""
    os.environ["SOLARA_APP"] = "kswarms.scenarios.explore.page"
    settings.telemetry.mixpanel_enable = False  # no usage reports to the makers of solara
    settings.main.mode = "production"  # do not watch the package for changes
    settings.theme.show_banner = False
    settings.theme.title = "kswarms explore"
    warnings.filterwarnings("ignore", "Cookies with samesite=none")  # needed in frames, which `Guard` forbids
    from solara.server.starlette import app

    page.new_session = new_session
    application: Application = app
    return application
