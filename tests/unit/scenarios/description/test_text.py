"""Comma-separated lists."""

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.description.text import parse_integers, split_words


def test_lists_are_parsed_without_repetition() -> None:
    assert split_words("robots, conflicts,robots") == ["robots", "conflicts"]
    assert split_words("") == []
    assert parse_integers("densities", "30,6,30") == (6, 30)
    assert parse_integers("densities", None) == ()
    with pytest.raises(InputError, match=r"^densities='6,x': must be integers"):
        parse_integers("densities", "6,x")
