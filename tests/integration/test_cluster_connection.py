"""Connections to a Dask scheduler: TLS by Dask's configuration, and one line for everything else."""

import gc
import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import dask
import pytest
from distributed import LocalCluster, Security

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.runs import dask as dask_module
from kswarms.scenarios.runs.dask import dask_executor
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.executor import count_workers
from kswarms.scenarios.runs.sweep import sweep
from tests.helpers.short_runs import by_digest, short_runs

pytestmark = [
    pytest.mark.slow,
    # Dask closes the socket of a failed handshake when it is collected.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]

ONE_LINE = "must be the address of a Dask scheduler"


@pytest.fixture(autouse=True)
def _collect_sockets() -> Iterator[None]:
    yield
    gc.collect()


def refusal(address: str) -> str:
    """Return the message of a refused address."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dask_module, "_TIMEOUT", 0.5)
        with pytest.raises(InputError) as refused, dask_executor(address):
            pass
    assert "\n" not in str(refused.value)
    return str(refused.value)


# TLS.

needs_openssl = pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl 3")


def make_key(directory: Path, name: str, signed_by: str = "") -> None:
    """Write a private key and its certificate, signed by itself or by another key of the directory."""
    options = ["-CA", f"{signed_by}.crt", "-CAkey", f"{signed_by}.key"] if signed_by else []
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes"]
    names = ["-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.crt", "-days", "2"]
    subprocess.run([*command, *names, *options], cwd=directory, check=True, capture_output=True)


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory with a certificate authority, a member that it has signed, and a stranger."""
    directory = tmp_path_factory.mktemp("keys")
    make_key(directory, "authority")
    make_key(directory, "member", "authority")
    make_key(directory, "stranger")
    return directory


def files(keys: Path, name: str) -> dict[str, str]:
    """Return Dask's configuration of TLS for a key."""
    tls = {"ca-file": keys / "authority.crt"}
    for role in ("client", "scheduler", "worker"):
        tls |= {f"{role}.cert": keys / f"{name}.crt", f"{role}.key": keys / f"{name}.key"}
    return {f"distributed.comm.tls.{key}": str(path) for key, path in tls.items()}


@pytest.fixture(scope="module")
def secure(keys: Path) -> Iterator[LocalCluster]:
    """Start a cluster of one worker that speaks TLS only."""
    with dask.config.set(files(keys, "member")):
        security = Security(require_encryption=True)
    with LocalCluster(
        1, processes=False, threads_per_worker=1, dashboard_address=":0", protocol="tls://", security=security
    ) as cluster:
        yield cluster


@needs_openssl
def test_tls_works_with_the_configuration_of_dask(secure: LocalCluster, keys: Path) -> None:
    address = secure.scheduler_address
    assert address.startswith("tls://")
    runs = short_runs("fig-6.1a", densities=(6,))
    with dask.config.set(files(keys, "member")), dask_executor(address) as executor:
        results = by_digest(sweep(runs, executor=executor))
    assert results == by_digest(sweep(runs))


@needs_openssl
def test_tls_without_files_or_with_a_key_of_a_stranger_is_refused(secure: LocalCluster, keys: Path) -> None:
    address = secure.scheduler_address
    assert "TLS needs ca-file, client.cert and client.key of distributed.comm.tls" in refusal(address)
    assert "TLS needs" in refusal("wss://127.0.0.1:1")
    for changed in (
        files(keys, "stranger"),
        files(keys, "missing"),
        files(keys, "member") | {"distributed.comm.tls.client.key": str(keys / "stranger.key")},
        files(keys, "member") | {"distributed.comm.tls.min-version": "nonsense"},
    ):
        with dask.config.set(changed):
            assert ONE_LINE in refusal(address)
    assert ONE_LINE in refusal(address.replace("tls://", "tcp://"))


@needs_openssl
def test_an_unencrypted_scheduler_is_refused_if_the_configuration_requires_encryption(
    plain: LocalCluster, keys: Path
) -> None:
    with dask.config.set(files(keys, "member")):
        assert ONE_LINE in refusal(plain.scheduler_address.replace("tcp://", "tls://"))
        with dask.config.set({"distributed.comm.require-encryption": True}):
            assert "encryption required by Dask configuration" in refusal(plain.scheduler_address)


# Other addresses.


@pytest.fixture(scope="module")
def plain() -> Iterator[LocalCluster]:
    """Start a cluster of one worker without TLS."""
    with LocalCluster(
        1, processes=False, threads_per_worker=1, dashboard_address=":0", protocol="tcp://"
    ) as cluster:
        yield cluster


def test_the_address_of_a_worker_is_refused(plain: LocalCluster) -> None:
    assert "a Worker answers there" in refusal(plain.workers[0].address)


@pytest.mark.parametrize(
    "address",
    [
        "",
        "scheduler",
        "tcp://",
        "tcp://127.0.0.1",
        "tcp://127.0.0.1:1",
        "tcp://127.0.0.1:99999",
        "tcp://127.0.0.1:1/path",
        "tcp://\0:1",
        "ws://127.0.0.1:1",
        "ucx://127.0.0.1:1",
        "inproc://127.0.0.1/1/1",
        "unix:///scheduler",
        "http://127.0.0.1:8786",
        f"tcp://{'x' * 5000}:1",
    ],
)
def test_an_address_without_a_scheduler_is_refused_in_one_line(
    address: str, empty_directory: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_module, "_TIMEOUT", 0.5)
    words = ["run", "fig-6.1c", "--densities", "6", "--seeds", "1", "--quiet", "--scheduler", address]
    assert invoke(words) == 2
    printed = capfd.readouterr().err
    assert printed.startswith("kswarms: scheduler=")
    assert ONE_LINE in printed
    assert printed.count("\n") == 1
    assert list(empty_directory.iterdir()) == []


@pytest.mark.parametrize(
    "greeting",
    [b"", b"SSH-2.0-OpenSSH_9.6\r\n" * 20, b"\0" * 64, b"\xff" * 64, None],
    ids=["silence", "ssh", "zeros", "ones", "closed"],
)
def test_a_port_that_answers_something_else_is_refused(
    greeting: bytes | None, capfd: pytest.CaptureFixture[str]
) -> None:
    kept: list[socket.socket] = []

    def serve() -> None:
        while True:
            try:
                client, _ = listener.accept()
            except OSError:  # closed below
                return
            if greeting is None:
                client.close()
                continue
            kept.append(client)
            client.sendall(greeting)

    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        assert ONE_LINE in refusal(f"tcp://127.0.0.1:{listener.getsockname()[1]}")
        listener.shutdown(socket.SHUT_RDWR)
    thread.join(10)
    for client in kept:
        client.close()
    assert capfd.readouterr().err == ""


# Workers that come and go.


def test_workers_that_join_later_are_counted(plain: LocalCluster, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_module, "_MIN_WORKERS", 1)
    monkeypatch.setattr(dask_module, "_COUNT_PERIOD", 0.0)
    with dask_executor(plain.scheduler_address) as executor:
        assert count_workers(executor) == 1
        plain.scale(3)
        plain.wait_for_workers(3)
        assert count_workers(executor) == 3


def test_a_scheduler_that_exits_ends_the_sweep_in_one_line(caplog: pytest.LogCaptureFixture) -> None:
    words = ["--host", "127.0.0.1", "--port", "0", "--dashboard-address", "127.0.0.1:0"]
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", *words]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as scheduler:
        assert scheduler.stderr is not None
        line = next(line for line in scheduler.stderr if "Scheduler at:" in line)
        with dask_executor(line.split()[-1]) as executor:
            played = sweep(short_runs("fig-6.1a"), executor=executor)
            threading.Timer(0.5, scheduler.kill).start()
            with pytest.raises(RunError, match="all workers exited"):
                next(played)
    assert [record.message for record in caplog.records if record.levelname == "ERROR"] == []
