"""Ctrl-C for processes that a test starts."""

import signal


def heed_interrupts() -> None:
    """Let a child process hear Ctrl-C, to which a background job of a shell and its children are deaf.

    For the argument ``preexec_fn`` of `subprocess.Popen`.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
