"""docs/theory.md maps every numbered statement to exactly the functions whose docstrings name it."""

import importlib
import inspect
import pkgutil
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

import kswarms.agents

DOCUMENT = Path(__file__).parents[4] / "docs" / "theory.md"

SPECIFIED = {
    *(f"Eq. 3.{k}" for k in (1, 2, 3, 5, 7, 8, 9, 10, 11)),
    *(f"Eq. 4.{k}" for k in range(1, 17) if k != 4),
    *(f"Eq. 5.{k}" for k in range(1, 6)),
    *("Eq. 6.1", "Eq. 6.2", "Eq. 6.3", "section 6.3.5", "Eq. 7.1", "Eq. 7.2"),
    *("Thm 5", "Cor. 6", "Thm 7", "Lemma 10", "Cor. 11", "Cor. 12", "Thm 13"),
    *("Lemma 17", "Lemma 19", "Prop. 20", "Prop. 21", "Fig. 3.1", "Table 3.1", "Table 3.2"),
}
"""Every numbered statement of the specification's chapters on theory."""

KIND = r"Eqs?\.|Thms?|Cors?\.|Lemmas?|Props?\.|Figs?\.|Tables?|section"
NUMBER = r"\d+(?:\.\d+)*"
MARKER = re.compile(rf"\(((?:(?:{KIND}) {NUMBER}(?:, {NUMBER})*(?:, )?)+)\)")


def numbers(docstring: str) -> Iterator[str]:
    """Yield the numbers of equations in the brackets of a docstring, before its sections."""
    text = " ".join(docstring.split("\n\nParameters\n")[0].split())
    for marker in MARKER.findall(text):
        kind = ""
        for word in re.findall(rf"{KIND}|{NUMBER}", marker):
            if not word[0].isdigit():
                kind = re.sub(r"s(?=\.?$)", "", word)
            elif kind != "section" or word.count(".") == 2:  # the specification's own sections have one point
                yield f"{kind} {word}"


def documented(name: str) -> dict[str, object]:
    """Return the functions and methods that a module defines, by qualified name."""
    module = importlib.import_module(name)
    found: dict[str, object] = {}
    for thing in vars(module).values():
        if (inspect.isclass(thing) or inspect.isroutine(thing)) and getattr(thing, "__module__", "") == name:
            found[f"{name}.{thing.__name__}"] = thing
            if inspect.isclass(thing):
                for method in vars(thing).values():
                    if inspect.isfunction(method):
                        found[f"{name}.{thing.__name__}.{method.__name__}"] = method
    return found


def named_by_docstrings() -> dict[str, set[str]]:
    named: defaultdict[str, set[str]] = defaultdict(set)
    for module in pkgutil.walk_packages(kswarms.agents.__path__, "kswarms.agents."):
        for name, thing in documented(module.name).items():
            for number in numbers(inspect.getdoc(thing) or ""):
                named[number].add(name)
    return dict(named)


def mapped_by_the_document() -> dict[str, set[str]]:
    mapped = {}
    for line in DOCUMENT.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("|") and re.fullmatch(rf"(?:{KIND}) {NUMBER}", cells[0]):
            functions = re.findall(r"`([\w.]+)`", cells[-1])
            assert cells[0] not in mapped, f"{cells[0]} stands twice"
            prefixes = ("" if f.startswith("kswarms.") else "kswarms.agents.theory." for f in functions)
            mapped[cells[0]] = {prefix + f for prefix, f in zip(prefixes, functions, strict=True)}
    return mapped


def test_the_map_has_every_number_of_the_specification() -> None:
    assert set(mapped_by_the_document()) == SPECIFIED


def test_the_map_names_the_functions_whose_docstrings_name_the_number() -> None:
    assert mapped_by_the_document() == named_by_docstrings()


@pytest.mark.parametrize(
    ("docstring", "found"),
    [
        ("Return W (Eq. 4.14).", ["Eq. 4.14"]),
        ("Return W (Thm 13, Eqs. 4.8, 4.9).\n\n(Lemma 17)", ["Thm 13", "Eq. 4.8", "Eq. 4.9", "Lemma 17"]),
        ("Sums over\nlines (Props. 20,\n21).", ["Prop. 20", "Prop. 21"]),
        ("By Eq. 3.1, of section 6.3 (section 1.2), choose (Eq. 4.16 while learning).", []),
        ("Alone (section 6.3.5).\n\nParameters\n----------\nx : float\n    (Eq. 6.2)", ["section 6.3.5"]),
    ],
)
def test_markers_are_found(docstring: str, found: list[str]) -> None:
    assert list(numbers(docstring)) == found
