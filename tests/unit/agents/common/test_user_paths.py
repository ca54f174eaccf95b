"""Paths and types that a user gives in Python."""

from pathlib import Path

import pytest

from kswarms import Bandit, Learner, Study, judge, make_policy, read_conflicts, read_findings, read_results
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import to_path


def test_texts_and_paths_are_paths() -> None:
    assert to_path("out", "a/b") == to_path("out", Path("a/b")) == Path("a/b")


@pytest.mark.parametrize("path", [None, 3, b"x", ["x"], "a\0b", "x" * 5000, object()])
def test_other_values_are_refused(path: object) -> None:
    for call in (read_findings, read_conflicts, Study, lambda path: to_path("path", path)):
        with pytest.raises(InputError, match=r"must be a (shorter )?path$"):
            call(path)  # type: ignore[arg-type]


def test_a_name_that_is_too_long_is_refused_by_read_results() -> None:
    with pytest.raises(InputError, match=r"^results='x.*must be a shorter path$"):
        read_results("x" * 5000)


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: Bandit("2"), "arms"),  # type: ignore[arg-type]
        (lambda: Bandit(0), "arms"),
        (lambda: Bandit(True), "arms"),
        (lambda: make_policy("avoid", None), "setting"),  # type: ignore[arg-type]
        (lambda: Learner("avoid"), "setting"),  # type: ignore[arg-type]
        (lambda: judge("6.1a-alike", None), "finding"),  # type: ignore[arg-type]
    ],
)
def test_a_wrong_type_names_the_argument(call: object, field: str) -> None:
    with pytest.raises(InputError, match=f"^{field}="):
        call()  # type: ignore[operator]
