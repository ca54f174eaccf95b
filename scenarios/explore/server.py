"""Server of the page. It is reachable from this machine only and needs no network."""

import os
import socket
import threading
import time
import webbrowser
from collections.abc import Callable
from typing import TYPE_CHECKING

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.runs.run import Run

if TYPE_CHECKING:
    import uvicorn

HOST = "127.0.0.1"


def serve(start: str | Run, port: int, open_browser: bool, ready: Callable[[str], None]) -> None:
    """Serve the page on a port (0 for any free port) until interrupted.

    `start` is the scenario or run of a new page, as `Session` takes it. `ready` is called with the address
    when the page can be opened.
    """
    try:
        listener = socket.create_server((HOST, port))
    except OSError:
        raise InputError("port", port, "must be a free port of this machine, 0 for any") from None
    with listener:
        address = f"http://localhost:{listener.getsockname()[1]}"
        server = _create_server(start)

        def announce() -> None:
            while not server.started:
                time.sleep(0.05)
            ready(address)
            if open_browser:
                webbrowser.open(address)

        threading.Thread(target=announce, daemon=True).start()
        server.run(sockets=[listener])


def _create_server(start: str | Run) -> "uvicorn.Server":
    """Return a server of the page that contacts no other machine."""
    os.environ["SOLARA_APP"] = "kswarms.scenarios.explore.page"
    import uvicorn
    from solara.server import settings

    settings.telemetry.mixpanel_enable = False  # no usage reports to the makers of solara
    settings.main.mode = "production"  # do not watch the package for changes
    settings.theme.show_banner = False
    settings.theme.title = "kswarms explore"
    from solara.server.starlette import app

    from kswarms.scenarios.explore import page

    page.start = start
    return uvicorn.Server(uvicorn.Config(app, log_level="error", access_log=False))
