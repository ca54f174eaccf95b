"""A short fuzz test: mistaken inputs of all kinds. ``python -m tests.fuzz.fuzz`` gives more of them."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.fuzz.fuzz import GENERATORS, base_study, fuzz, name_of
from tests.fuzz.harness import Input, try_input

SEED = 2
"""Its first inputs have no reports, which take seconds."""


@pytest.fixture(scope="module")
def study() -> Iterator[Path]:
    with base_study() as directory:
        yield directory


@pytest.mark.parametrize(
    "inputs", [pytest.param(100, marks=pytest.mark.slow), pytest.param(600, marks=pytest.mark.full)]
)
@pytest.mark.parametrize("kind", list(GENERATORS))
def test_mistaken_inputs_end_in_one_line_and_leave_nothing(kind: str, inputs: int, study: Path) -> None:
    names = [name for name in (name_of(SEED, k) for k in range(inputs)) if name.startswith(f"{kind}/")]
    failures = [f"{failure.name} {failure.problem}" for failure in fuzz(names, study)]
    assert failures == []


@pytest.mark.parametrize(
    ("call", "problem"),
    [
        (lambda: 1 / 0, "ZeroDivisionError"),
        (lambda: Path("../left").write_text(""), "left ['left']"),
        (lambda: Path(".hidden").write_text(""), "left ['work/.hidden']"),
        (lambda: Path("results.png").write_text(""), ""),
    ],
)
def test_the_fuzz_test_finds_errors_and_files(
    call: Callable[[], object], problem: str, tmp_path: Path
) -> None:
    failure = try_input("x", lambda _rng, _directory: Input("x", call=call), tmp_path)
    assert (failure.problem if failure else "").startswith(problem)
    assert bool(failure) == bool(problem)
