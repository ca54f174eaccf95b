"""Quoting of hostile names for terminals, shells, spreadsheets, Markdown and file names."""

import subprocess
import tomllib
from pathlib import Path

import pytest
import tomlkit

from kswarms.agents.common.quoting import (
    LONGEST_FILE_NAME,
    for_cell,
    for_file_name,
    for_markdown,
    for_shell,
    for_terminal,
    for_toml,
)

NAMES = {
    "escape": "\x1b]0;owned\x07\x1b[2J",
    "C1": "a\x9b31m",
    "right to left": "a\u202etxt.exe",
    "isolate": "\u2066x\u2069",
    "invisible": "a\u200b\ufeffb",
    "lines": "a\nb\r\nc\u2028d\x85e",
    "surrogate": "caf\udce9",
    "lone surrogate": "\ud800",
    "NUL": "a\x00b",
    "separators": "../../x",
    "absolute": "/etc/passwd",
    "backslash": "..\\..\\x",
    "hidden": ".bashrc",
    "option": "-rf",
    "dots": "..",
    "empty": "",
    "shell": "$(reboot); `reboot` 'x' \"y\" && z",
    "HTML": "<img src=x onerror=alert(1)>",
    "long": "x" * 5000,
    "long Greek": "Δ" * 5000,
}


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_every_quoted_text_is_printable_and_in_one_line(name: str) -> None:
    for quote in (for_terminal, for_shell, for_cell, for_markdown, for_file_name):
        assert quote(name).isprintable()
        quote(name).encode()


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_a_file_name_is_a_plain_name_in_its_folder(tmp_path: Path, name: str) -> None:
    file = tmp_path / f"{for_file_name(name)}.png"
    assert file.resolve().parent == tmp_path
    assert file.name[0] not in ".-"
    assert len(for_file_name(name).encode()) <= LONGEST_FILE_NAME
    file.touch()


def test_different_texts_have_different_file_names() -> None:
    names = [*NAMES.values(), *(f"{'x' * 5000}{k}" for k in range(50)), "a b", "a-b", "a/b", "a:b", "a\\b"]
    assert len({for_file_name(name) for name in names}) == len(names)


@pytest.mark.parametrize("name", ["fig-6.1a", "fig-6.1c-side=2.0, layout=ring-n6-seed0", "Δ (α = 0.5)"])
def test_ordinary_names_are_unchanged(name: str) -> None:
    assert for_file_name(name) == for_terminal(name) == for_cell(name) == for_markdown(name) == name


@pytest.mark.parametrize("number", ["-1", "+0.5", "-1e-300", "-inf", "0", "nan", "1,5", "−3"])
def test_numbers_in_cells_are_unchanged(number: str) -> None:
    assert for_cell(number) == number


@pytest.mark.parametrize(
    "formula", ["=1+1", "+1+1", "-1+1", "@SUM(A1)", "\t=1", "\r=1", " =1", "\uff1d1", "-A1"]
)
def test_formulas_in_cells_start_with_an_apostrophe(formula: str) -> None:
    assert for_cell(formula) == f"'{for_terminal(formula)}"


@pytest.mark.parametrize(
    "text", ["a|b", "a`b`", "<b>", "[a](http://b)", "**a**", "__a__", "a\\", "&lt;", "$x$"]
)
def test_markup_in_markdown_is_escaped(text: str) -> None:
    assert for_markdown(text) != text
    assert for_markdown(text).replace("\\", "") == text.replace("\\", "")
    assert for_markdown("time_sud") == "time_sud"


@pytest.mark.parametrize(
    "word", ["a b", "$(reboot)", "'", "two\nlines", "\x1b[2J'", "caf\udce9", "\\", "\u202eΔ\n", "\U000e0001"]
)
def test_a_shell_reads_a_quoted_word_back(word: str) -> None:
    command = ["bash", "-c", f"printf %s {for_shell(word)}"]
    found = subprocess.run(command, capture_output=True, env={"LC_ALL": "C.UTF-8"}, check=True).stdout
    assert found.decode("utf-8", "surrogateescape") == word


def test_a_quoted_toml_document_has_the_same_content() -> None:
    content = {"title": "\x1b[2J\x9b\u202e\u2028\U000e0001\t\xa0Δ\\", "swarms": [{"policy": "a\nb"}]}
    document = for_toml(tomlkit.dumps(content))
    assert all(line.isprintable() for line in document.split("\n"))
    assert tomllib.loads(document) == content
