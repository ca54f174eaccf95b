"""Serves the page on this machine, without asking anything of another one."""

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
    """Serve the page until interrupted.

    Parameters
    ----------
    start : str or Run
        What a new page begins with, as `kswarms.scenarios.explore.session.Session` takes it.
    port : int
        Where; 0 for any that is free.
    open_browser : bool
        Whether to open the page in the browser.
    ready : callable
        Told the address once the page can be opened.

    Raises
    ------
    InputError
        If the port is taken.
    """
    with _listen(port) as listener:
        address = f"http://localhost:{listener.getsockname()[1]}"
        server = _server(start)

        def announce() -> None:
            while not server.started:
                time.sleep(0.05)
            ready(address)
            if open_browser:
                webbrowser.open(address)

        threading.Thread(target=announce, daemon=True).start()
        server.run(sockets=[listener])


def _listen(port: int) -> socket.socket:
    refusal = InputError("port", port, "must be a free port of this machine, 0 for any")
    if not 0 <= port <= 65535:
        raise refusal
    try:
        return socket.create_server((HOST, port))
    except OSError:
        raise refusal from None


def _server(start: str | Run) -> "uvicorn.Server":
    """Return the server of the page, set up to speak to this machine alone."""
    os.environ["SOLARA_APP"] = "kswarms.scenarios.explore.page"
    import uvicorn
    from solara.server import settings

    settings.telemetry.mixpanel_enable = False  # else it would tell its maker of each start
    settings.main.mode = "production"  # else it would watch the files of the package for changes
    settings.theme.show_banner = False
    settings.theme.title = "kswarms explore"
    from solara.server.starlette import app

    from kswarms.scenarios.explore import page

    page.start = start
    return uvicorn.Server(uvicorn.Config(app, log_level="error", access_log=False))
