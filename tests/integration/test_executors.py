"""Runs played through executors: all their workers play, and their failures are named."""

from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from contextlib import closing
from threading import Barrier

import pytest

from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.outcome import Failure
from kswarms.scenarios.runs.sweep import sweep
from tests.helpers.short_runs import by_digest, failing_run, short_runs


def test_an_executor_plays_and_a_failure_does_not_end_the_sweep() -> None:
    runs = short_runs("fig-6.1a", densities=(6,), seeds=4)
    with ThreadPoolExecutor(1) as executor:
        results = by_digest(sweep([failing_run(runs[0]), *runs], executor=executor))
    failure = results.pop("bad")
    assert isinstance(failure, Failure)
    assert failure.error.startswith("InputError: seed=-1")
    assert failure.trace.startswith("Traceback")
    assert results == by_digest(sweep(runs))


@pytest.mark.parametrize(("own_workers", "jobs", "together"), [(5, 1, 5), (3, 2, 3), (4, 9, 4)])
def test_all_workers_of_an_executor_play(
    monkeypatch: pytest.MonkeyPatch, own_workers: int, jobs: int, together: int
) -> None:
    met = Barrier(together, timeout=10)  # broken if fewer runs are played at a time

    def attempt(*_: object) -> tuple[Failure, float]:
        met.wait()
        return Failure("played"), 0.0

    monkeypatch.setattr("kswarms.scenarios.runs.sweep.attempt_in_worker", attempt)
    runs = short_runs("fig-6.1a", densities=(6,), seeds=2 * together)
    with ThreadPoolExecutor(own_workers) as executor:
        results = by_digest(sweep(runs, jobs, executor=executor))
    assert {result.error for result in results.values()} == {"played"}


@pytest.mark.parametrize(
    ("name", "counts"), [("num_workers", [1, 4]), ("_max_workers", [2, 3]), ("", [3, 3])]
)
def test_an_executor_gets_two_runs_for_each_of_its_present_workers(name: str, counts: list[int]) -> None:
    class Counted(Executor):
        submitted = 0

        def submit(self, *_arguments: object, **_options: object) -> Future[object]:
            self.submitted += 1
            future: Future[object] = Future()
            future.set_result((Failure("played"), 0.0))
            return future

    executor = Counted()
    runs = short_runs("fig-6.1a", densities=(6,), seeds=20)
    with closing(sweep(runs, jobs=3 if not name else 1, executor=executor)) as played:
        for ended, count in enumerate(counts):
            if name:
                setattr(executor, name, count)  # workers may join
            next(played)
            assert executor.submitted == ended + 2 * count


def executor_with(submit: Callable[[], Future[object]]) -> ThreadPoolExecutor:
    class Executor(ThreadPoolExecutor):
        def submit(self, *_arguments: object, **_options: object) -> Future[object]:
            return submit()

    return Executor(1)


def refuse() -> Future[object]:
    raise BrokenExecutor


def cancel() -> Future[object]:
    future: Future[object] = Future()
    future.cancel()
    future.set_running_or_notify_cancel()
    return future


def lose() -> Future[object]:
    future: Future[object] = Future()
    future.set_exception(TypeError("cannot pickle"))
    return future


@pytest.mark.parametrize("submit", [refuse, cancel])
def test_a_broken_executor_ends_the_sweep(submit: Callable[[], Future[object]]) -> None:
    with executor_with(submit) as executor, pytest.raises(RunError, match="all workers exited"):
        list(sweep(short_runs("fig-6.1a"), executor=executor))


def test_a_result_that_cannot_be_pickled_is_a_failure() -> None:
    with executor_with(lose) as executor:
        ((_, failure, _),) = sweep(short_runs("fig-6.1a", densities=(6,), seeds=1), executor=executor)
    assert isinstance(failure, Failure)
    assert failure.error == "TypeError: cannot pickle"
