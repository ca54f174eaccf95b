"""Values that nobody means, and mutations of nested data."""

import copy
import math
from random import Random
from typing import Any, Final

NUMBERS: Final = (
    *(0, 1, -1, 2, 7, 2**31, 2**63, 10**400, -(10**400)),
    *(0.0, -0.0, 0.5, -0.5, 1.5, 5e-324, 1e-9, 1e308, -1e308, math.inf, -math.inf, math.nan),
)
TEXTS: Final = (
    *(
        "",
        " ",
        "\t",
        "0",
        "1",
        "-1",
        "1.5",
        "nan",
        "true",
        "x",
        "avoid",
        "attack",
        "x=1",
        "a,b",
        "a+b",
        "f(",
        "f:X",
    ),
    *(
        "../../x",
        "/dev/zero",
        "~",
        "a\nb",
        "\x1b[31m",
        "\u202e",
        "\udcff",
        "漢字",
        "<b>&",
        "=1+1",
        "$x^{",
        "%s",
    ),
    *("x" * 5000, "(" * 2000, "learner(rule='no')", "learner(", "wlu(delta=2)", "no.py:X", "a" * 100),
)
OTHERS: Final = (
    None,
    True,
    False,
    [],
    {},
    [[]],
    [None],
    [True],
    {"a": 1},
    [1, "1"],
    [[0.0, 0.0]],
    [1] * 2000,
)
BYTES: Final = (b"", b"\xff", b"1")
JUNK: Final = (*NUMBERS, *TEXTS, *OTHERS)

WORDS: Final = (
    *(
        "",
        " ",
        "0",
        "1",
        "-1",
        "2",
        "1.5",
        "nan",
        "inf",
        "1e308",
        "-0.0",
        "x",
        "true",
        "1" * 500,
        "0x10",
        "6,x",
        "4,6",
    ),
    *(
        "--",
        "-x",
        "--nonsense",
        "--out",
        "--seeds=",
        "--help=1",
        "-",
        "../x",
        "no.toml",
        "/dev/null",
        ".",
        "study",
    ),
    *("a\nb", "\x1b[31m", "\udcff", "漢字", "x" * 5000, "~", "$(x)", "=1+1", "tiny.toml", "robots", "none"),
)


def mutate(rng: Random, data: Any, junk: tuple[Any, ...] = JUNK) -> Any:
    """Return a copy of nested lists and dictionaries with one entry changed, removed, repeated or renamed."""
    data = copy.deepcopy(data)
    places: list[tuple[Any, Any]] = []

    def collect(node: Any) -> None:
        keys = node if isinstance(node, dict) else range(len(node)) if isinstance(node, list) else ()
        for key in list(keys):
            places.append((node, key))
            collect(node[key])

    collect(data)
    if not places:
        return rng.choice(junk)
    node, key = rng.choice(places)
    how = rng.choice(("replace", "replace", "replace", "remove", "repeat", "rename", "wrap"))
    if how == "remove":
        del node[key]
    elif how == "repeat" and isinstance(node, list):
        node.append(node[key])
    elif how == "rename" and isinstance(node, dict):
        node[rng.choice(("self", "x", "", "a.b", "\x1b", key + "x"))] = node.pop(key)
    elif how == "wrap":
        node[key] = [node[key]]
    else:
        node[key] = copy.deepcopy(rng.choice(junk))
    return data


def damage(rng: Random, content: bytes) -> bytes:
    """Return bytes with some of them changed, removed or repeated."""
    where, length = rng.randrange(len(content) + 1), rng.choice((1, 1, 8, 500))
    middle = rng.choice(
        (b"", rng.randbytes(length), content[where : where + length] * 2, b"[" * 2000, b"\x00")
    )
    return content[:where] + middle + content[where + rng.choice((0, length, len(content))) :]
