"""Standard output and standard error: characters that they cannot show, and readers that close them."""

import io
import os
import sys


def prepare_streams() -> None:
    """Escape characters that the terminal cannot show; discard what is written to a stream that is closed."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by the caller; the next file that is opened would take its place
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def flush_output() -> OSError | None:
    """Flush standard output; if that fails, discard the rest, which Python would flush again at its end."""
    try:
        sys.stdout.flush()
    except OSError as error:
        with open(os.devnull, "wb") as devnull:  # noqa: PTH123
            os.dup2(devnull.fileno(), sys.stdout.fileno())
        return error
    return None
