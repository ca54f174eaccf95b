"""Play runs on a Dask cluster."""

import asyncio
import logging
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Final

from kswarms.agents.common.errors import InputError

if TYPE_CHECKING:
    from distributed import Client, Security

_MIN_WORKERS: Final = 32
"""Minimum assumed number of workers. More may join the cluster later."""
_COUNT_PERIOD: Final = 1.0
"""Minimum time between two counts of the workers (s)."""
_TIMEOUT: Final = 10
"""Connection timeout (s)."""


@contextmanager
def dask_executor(address: str) -> Iterator[Executor]:
    """Connect to a Dask scheduler (``tcp://host:8786`` or ``tls://host:8786``); yield an executor.

    TLS uses the files that Dask's configuration names. On exit, waiting tasks are cancelled. Running tasks
    finish, and their results are discarded.

    Raises
    ------
    InputError
        If Dask is not installed, or no scheduler answers at the address.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise InputError("scheduler", address, "needs Dask: pip install 'kswarms[cluster]'") from error
    try:
        security = _require_scheduler(address)
        client = Client(address, timeout=_TIMEOUT, set_as_default=False, security=security)
    except Exception as error:  # the port may answer anything
        reason = " ".join(str(error).split()) or type(error).__name__
        rule = f"must be the address of a Dask scheduler ({reason})"
        raise InputError("scheduler", address, rule) from error
    with _without_logs("distributed.client", "tornado.application"), client:
        yield _ClusterExecutor(client)


@contextmanager
def _without_logs(*names: str) -> Iterator[None]:
    """Silence loggers. Dask logs tracebacks if the scheduler exits or if a result arrives at the end."""
    loggers = [logging.getLogger(name) for name in names]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _require_scheduler(address: str) -> "Security":
    """Raise an error if no scheduler answers at an address; return the settings of the connection.

    A `Client` that fails to connect prints tracebacks later, so this uses a connection of its own.
    """
    from dask import config
    from distributed import Security
    from distributed.comm.addressing import get_address_host_port
    from distributed.core import rpc
    from distributed.utils import LoopRunner, import_term

    get_address_host_port(address)
    loader = config.get("distributed.client.security-loader", None)
    security: Security = import_term(loader)({"address": address}) if loader else Security()
    connection = security.get_connection_args("client")
    if address.startswith(("tls://", "wss://")) and connection["ssl_context"] is None:
        files = "ca-file, client.cert and client.key of distributed.comm.tls"
        raise ValueError(f"TLS needs {files} in Dask's configuration")

    async def identify() -> Any:
        async with (
            asyncio.timeout(1.1 * _TIMEOUT),  # for a port that accepts a connection and is silent
            rpc(address, timeout=_TIMEOUT, connection_args=connection) as server,
        ):
            return await server.identity()

    kind = LoopRunner().run_sync(identify)["type"]
    if kind != "Scheduler":
        raise ValueError(f"a {kind} answers there")
    return security


class _ClusterExecutor(Executor):
    """An executor that plays on the workers of a cluster."""

    def __init__(self, client: "Client") -> None:
        self._client = client
        # With `pure`, Dask would treat equal runs as one task and cache its result.
        self._executor = client.get_executor(pure=False)
        self._workers = _MIN_WORKERS
        self._next_count = 0.0

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **options: Any) -> Future[Any]:
        submitted: Future[Any] = self._executor.submit(function, *arguments, **options)
        return submitted

    @property
    def num_workers(self) -> int:
        """Number of threads of all workers; it changes as workers join and leave."""
        if time.monotonic() >= self._next_count:
            with suppress(OSError):  # without a scheduler, the runs will be cancelled
                self._workers = max(_MIN_WORKERS, sum(self._client.nthreads().values()))
            self._next_count = time.monotonic() + _COUNT_PERIOD
        return self._workers
