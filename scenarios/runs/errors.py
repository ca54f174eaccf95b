"""The error of a run."""


class RunError(RuntimeError):
    """A run failed. `trace` is the traceback of its error, empty if there is none."""

    def __init__(self, message: str, trace: str = "") -> None:
        super().__init__(message)
        self.trace = trace
