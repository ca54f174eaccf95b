"""Ctrl-C for processes that a test starts."""

import signal


def accept_interrupts() -> None:
    """Restore the default handling of Ctrl-C, which background jobs of a shell and their children ignore.

    Use it as the argument ``preexec_fn`` of `subprocess.Popen`.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
