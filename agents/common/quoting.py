"""Quoting of names and other texts for terminals, shells, spreadsheets, Markdown and file names.

HTML is escaped by the templates.
"""

import hashlib
import re
import shlex
from typing import Final

LONGEST_FILE_NAME: Final = 150
"""Maximum length of a result of `for_file_name` (bytes of UTF-8); file systems allow 255."""

_FORMULA: Final = re.compile(r"\s*[=+\-@\uff1d\uff0b\uff0d\uff20]")  # wide letters too
# Not underscores within words, and only ampersands of entities.
_MARKDOWN: Final = re.compile(r"[\\`*\[\]<|~$]|&(?=#?\w+;)|(?<![^\W_])_|_(?![^\W_])")
_FOREIGN: Final = re.compile(r"[^\w .,=+()@%-]+")
_DIGEST_LENGTH: Final = 8


def for_terminal(text: str) -> str:
    r"""Return a text in one line; characters that are not printable are escaped, as `repr` does it.

    This covers control characters, ANSI escape sequences, line breaks, invisible and bidirectional format
    characters, and lone surrogates, which stand for bytes of paths that are not UTF-8.

    Examples
    --------
    >>> for_terminal("fight \x1b[31mΔ = 1")
    'fight \\x1b[31mΔ = 1'
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def for_toml(document: str) -> str:
    r"""Return a TOML document with characters that are not printable as escapes; its content is the same.

    Such characters can only be in strings, and TOML Kit writes strings with escapes.

    Examples
    --------
    >>> print(for_toml('title = "\x9b1m"'))
    title = "\U0000009b1m"
    """
    return "".join(c if c.isprintable() or c == "\n" else f"\\U{ord(c):08x}" for c in document)


def for_shell(word: str) -> str:
    r"""Return a word quoted for a shell, in one line.

    Examples
    --------
    >>> print(for_shell("my results"), for_shell("two\nlines"))
    'my results' $'two\x0alines'
    """
    if word.isprintable():
        return shlex.quote(word)
    return "$'" + "".join(c if c.isprintable() and c not in "'\\" else _shell_escape(c) for c in word) + "'"


def _shell_escape(character: str) -> str:
    code = ord(character)
    if 0xDC80 <= code <= 0xDCFF:  # a byte of a path that is not UTF-8
        code -= 0xDC00
    elif code > 0xFFFF:
        return f"\\U{code:08x}"
    elif code >= 0x80:
        return f"\\u{code:04x}"
    return f"\\x{code:02x}"


def for_cell(text: str) -> str:
    """Return a text for a cell of a CSV file: in one line, and with an apostrophe before a formula.

    Spreadsheets evaluate texts that start with ``=``, ``+``, ``-`` or ``@``. Numbers are returned unchanged.

    Examples
    --------
    >>> for_cell("=1+1"), for_cell("-0.5"), for_cell("avoid")
    ("'=1+1", '-0.5', 'avoid')
    """
    quoted = for_terminal(text)
    return f"'{quoted}" if _FORMULA.match(text) and not _is_number(quoted) else quoted


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def for_markdown(text: str) -> str:
    r"""Return a text in one line of Markdown, without markup and HTML; line breaks become spaces.

    Examples
    --------
    >>> print(for_markdown("a|b <i>"))
    a\|b \<i>
    """
    return _MARKDOWN.sub(r"\\\g<0>", for_terminal(" ".join(text.splitlines())))


def for_file_name(text: str) -> str:
    """Return a text as a file name, without suffix.

    The name has no separators, control characters or characters with a meaning in shells, does not start
    with a dot or a hyphen, and has at most `LONGEST_FILE_NAME` bytes. If the text must be changed, the name
    ends with a digest of the text, so that different texts have different names.

    Examples
    --------
    >>> for_file_name("fig-6.1a"), for_file_name("../../x")
    ('fig-6.1a', 'x-9cdf6a50')
    """
    name = _FOREIGN.sub("-", text).lstrip(".-~ ").rstrip(". ")
    name = name.encode("utf-8", "replace")[: LONGEST_FILE_NAME - _DIGEST_LENGTH - 1].decode("utf-8", "ignore")
    if name and name == text:
        return name
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGEST_LENGTH]
    return f"{name}-{digest}" if name else digest
