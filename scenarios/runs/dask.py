"""Play runs on a Dask cluster."""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Final

from kswarms.agents.common.errors import InputError

_MIN_RUNS: Final = 32
"""Minimum number of parallel runs. More workers may join the cluster later."""
_TIMEOUT: Final = 10
"""Connection timeout (s)."""


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """Connect to a Dask scheduler (``tcp://host:8786``); yield an executor and its number of parallel runs.

    On exit, waiting tasks are cancelled. Running tasks finish, and their results are discarded.
    """
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError as error:
        raise InputError("scheduler", address, "needs Dask: pip install 'kswarms[cluster]'") from error
    try:
        get_address_host_port(address)  # a client with a malformed address hangs on deletion
        client = Client(address, timeout=_TIMEOUT, set_as_default=False)
    except (OSError, ValueError) as error:
        rule = f"must be the address of a Dask scheduler ({' '.join(str(error).split())})"
        raise InputError("scheduler", address, rule) from error
    with client:
        # With `pure`, Dask would treat equal runs as one task and cache its result.
        yield client.get_executor(pure=False), max(_MIN_RUNS, sum(client.nthreads().values()))
