"""Parsing of comma-separated lists."""

from kswarms.agents.common.errors import InputError


def split_words(text: str) -> list[str]:
    """Split a comma-separated list; drop duplicates."""
    return list(dict.fromkeys(word.strip() for word in text.split(","))) if text else []


def parse_integers(field: str, text: str | None) -> tuple[int, ...]:
    """Parse a comma-separated list of integers; sort it and drop duplicates. None is an empty list."""
    if text is None:
        return ()
    try:
        return tuple(sorted({int(word) for word in text.split(",")}))
    except ValueError:
        raise InputError(field, text, "must be integers separated by commas, for example 6,30,50") from None
