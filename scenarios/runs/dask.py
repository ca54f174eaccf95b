"""Workers elsewhere: a Dask cluster, which `dask.distributed` reaches by the address of its scheduler."""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Final

from kswarms.agents.common.errors import InputError

_FEWEST_AT_ONCE: Final = 32
"""Runs that a cluster is taken to play at the same time at least, for it may grow."""
_PATIENCE: Final = 10
"""Time for a scheduler to answer (s)."""


@contextmanager
def connected(address: str) -> Iterator[tuple[Executor, int]]:
    """Connect to a cluster, and yield an executor that plays on it and how many runs it plays at once.

    When the connection ends, what waits is dropped; what is played then comes to its end on its own.

    Parameters
    ----------
    address : str
        Of the scheduler, as ``tcp://host:8786``.

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
        get_address_host_port(address)  # a client of no address at all would hang when it is thrown away
        client = Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise InputError(
            "scheduler", address, f"must be the address of a Dask scheduler ({reason})"
        ) from error
    with client:
        # Not pure: Dask would else take two runs of the same text for one, and keep what came out.
        executor = client.get_executor(pure=False)
        yield executor, max(_FEWEST_AT_ONCE, sum(client.nthreads().values()))
