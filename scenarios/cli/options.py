"""What several commands ask for."""

import os
from typing import Annotated

import typer

from agents.errors import InputError

Jobs = Annotated[int | None, typer.Option(help="Processes that play. [default: one for each CPU]")]


def processes(jobs: int | None) -> int:
    """Return how many processes play: as many as asked for, or one for each CPU.

    Raises
    ------
    InputError
        If fewer than one is asked for.
    """
    if jobs is None:
        return os.cpu_count() or 1
    if jobs < 1:
        raise InputError("jobs", jobs, "must be at least 1")
    return jobs
