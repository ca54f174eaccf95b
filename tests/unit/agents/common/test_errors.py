"""The text of an `InputError`: one short line, whatever the value is."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kswarms.agents.common.errors import LONGEST_VALUE, InputError, printable, shorten


class Broken:
    def __repr__(self) -> str:
        raise RuntimeError("no text")


class Endless:
    def __repr__(self) -> str:
        return repr(self)


class Coloured:
    def __repr__(self) -> str:
        return "\x1b[31mred\n  and long " + "x" * 5000


NESTED: list[Any] = []
NESTED.append(NESTED)


@pytest.mark.parametrize(
    "value",
    [
        *[Broken(), Endless(), Coloured(), [Broken()] * 9, {"a": Endless()}, NESTED, Broken],
        *["a" * 5000, "\x1b]0;title\x07", "a\nb\r\u2028c", "\udcff", "\u202eabc", b"\xff" * 5000],
        *[10**400, -(10**9999), list(range(10**6)), {k: k for k in range(1000)}, np.arange(5000), np.eye(3)],
    ],
    ids=lambda value: type(value).__name__,
)
def test_any_value_is_shown_on_one_short_printable_line(value: object) -> None:
    text = shorten(value)
    assert 0 < len(text) <= LONGEST_VALUE
    assert text.isprintable()
    error = InputError("field", value, "must be good")
    assert str(error) == f"field={text}: must be good"
    assert error.value is value


@pytest.mark.parametrize("value", [3, 0.1, "text", "it's", None, True, (1, 2.5), ["a", "b"], {"a": 1}])
def test_short_values_are_shown_as_they_are(value: object) -> None:
    assert shorten(value) == repr(value)


def test_a_long_value_is_shown_by_its_beginning_and_end() -> None:
    assert shorten("begin" + "-" * 5000 + "end").startswith("'begin---")
    assert shorten("begin" + "-" * 5000 + "end").endswith("---end'")
    assert shorten(Path("a" * 5000)) == shorten("a" * 5000)
    assert shorten(10**9999) == "<integer of 33216 bits>"


def test_fields_and_rules_are_printable_and_short_too() -> None:
    error = InputError("\x1b[1m" + "f" * 5000, 1, "must be\n  one of \x1b[0m" + ", name" * 5000)
    assert str(error).startswith(r"\x1b[1mfff")
    assert r"must be one of \x1b[0m, name" in str(error)
    assert str(error).isprintable()
    assert len(str(error)) < 2500


def test_printable_texts_are_unchanged() -> None:
    assert printable("Δ, ü, 漢字 and  two spaces") == "Δ, ü, 漢字 and  two spaces"
