"""Lists in texts of the command line and the page."""

from kswarms.agents.common.errors import InputError


def split_words(text: str) -> list[str]:
    """Return the words between commas, each once."""
    return list(dict.fromkeys(word.strip() for word in text.split(","))) if text else []


def parse_integers(field: str, text: str | None) -> tuple[int, ...]:
    """Return the integers between commas, ascending, each once; none for None."""
    if text is None:
        return ()
    try:
        return tuple(sorted({int(word) for word in text.split(",")}))
    except ValueError:
        raise InputError(field, text, "must be integers separated by commas, as 6,30,50") from None
