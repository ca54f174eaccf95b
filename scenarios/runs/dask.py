"""Play runs on a Dask cluster."""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Final

from kswarms.agents.common.errors import InputError

_MIN_RUNS: Final = 32
"""Minimum number of runs submitted at the same time, since a cluster may grow."""
_TIMEOUT: Final = 10
"""Connection timeout (s)."""


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Connect to a cluster; yield an executor that plays on it and its number of parallel runs.

    On exit, waiting tasks are cancelled; tasks that are running finish unnoticed.

    Parameters
    ----------
    address : str
        Address of the scheduler, as ``tcp://host:8786``.

    Raises
    ------
    InputError
        If Dask is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError as error:
        raise InputError("scheduler", address, "needs Dask: pip install 'kswarms[cluster]'") from error
    try:
        get_address_host_port(address)  # the client of a malformed address hangs when it is deleted
        client = Client(address, timeout=_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InputError(
            "scheduler", address, f"must be the address of a Dask scheduler ({reason})"
        ) from error
    with client:
        # Not pure: Dask would treat equal runs as one task and cache its result.
        executor = client.get_executor(pure=False)
        yield executor, max(_MIN_RUNS, sum(client.nthreads().values()))
