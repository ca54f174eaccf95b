"""The command line with extreme numbers, unusual titles and damaged results."""

import re
from pathlib import Path

import pytest

from kswarms.agents.common.errors import shorten
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.cli.app import COMMANDS

pytestmark = pytest.mark.usefixtures("empty_directory")

QUICK = ["--densities", "6", "--seeds", "1", "--jobs", "1", "--quiet"]
SCENARIO = """
id = "mine"
title = "TITLE"
densities = [6]
seeds = 1
[[conditions]]
name = "TITLE"
duration = 5
swarms = [{ policy = "avoid" }, { policy = "attack" }]
[[conditions]]
duration = 5
swarms = [{ policy = "attack" }, { policy = "attack" }]
"""


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ("run fig-6.1a --seeds 1000001", "seeds=1000001: must be less than or equal to 1000000"),
        (f"run fig-6.1a --densities 6,{10**400}", f"n={shorten(10**400)}: must be at most 1000000"),
        (f"film fig-6.1a --n {10**400}", f"n={shorten(10**400)}: must be at most 1000000"),
        ("run fig-6.1a --out=", "out='': must not be empty"),
        ("contribution fig-6.1a --n 6 --out=", "out='': must not be empty"),
        ("calibrate --out=", "out='': must not be empty"),
        ("calibrate --size 99999999", "size=99999999: must be less than or equal to 10000"),
        ("calibrate --waves 99999999", "waves=99999999: must be less than or equal to 1000"),
        (
            "film fig-6.1a --n 6 --out a.gif --speed 1e-300",
            "speed=1e-300: must be higher: a film has at most",
        ),
        ("conflicts fig-6.1a --n 6 --from nan", "from=nan: must be a number of seconds"),
        ("conflicts fig-6.1a --n 6 --to nan", "to=nan: must be a number of seconds, at least -inf"),
        ("conflicts fig-6.1a --n 6 --from 9 --to 5", "to=5.0: must be a number of seconds, at least 9"),
    ],
)
def test_an_invalid_number_or_path_is_one_line_and_nothing_is_written(
    words: str, error: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(words.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"kswarms: {error}")
    assert not list(Path.cwd().iterdir())


@pytest.mark.parametrize(
    ("option", "least", "most"),
    [
        ("run --first-seed", 0, 2**53),
        ("run --jobs", 1, 1024),
        ("contribution --seeds", 1, 1_000_000),
        ("contribution --first-seed", 0, 2**53),
        ("film --seed", 0, 2**53),
        ("film --fps", 1, 60),
        ("film --size", 64, 4096),
        ("film --sheet", 1, 100),
        ("explore --port", 0, 65535),
    ],
)
def test_options_have_a_range(option: str, least: int, most: int, capsys: pytest.CaptureFixture[str]) -> None:
    command, name = option.split(" --")
    for value, rule in (
        (least - 1, f"greater than or equal to {least}"),
        (most + 1, f"less than or equal to {most}"),
    ):
        assert invoke([command, f"--{name}={value}", *(["fig-6.1a"] if command != "explore" else [])]) == 2
        field = name.replace("-", "_")
        assert capsys.readouterr().err == f"kswarms: {field}='{value}': must be {rule}\n"


def test_every_option_for_numbers_refuses_other_texts(capsys: pytest.CaptureFixture[str]) -> None:
    tried = set()
    for command in ("run", "calibrate", "explore", "film", "conflicts", "contribution"):
        assert invoke([command, "--help"]) == 0
        for option, kind in re.findall(r"--(\S+) (<int(?: range)?>|<float>|K )", capsys.readouterr().out):
            for value in ("soon", "", "1.5" if kind != "<float>" else "1,5"):
                assert invoke([command, f"--{option}", value]) == 2
                (line,) = capsys.readouterr().err.splitlines()
                field, number = option.replace("-", "_"), "number" if kind == "<float>" else "integer"
                assert line.startswith(f"kswarms: {field}={value!r}: must be a valid {number}")
            tried.add(f"{command} --{option}")
    assert {"run --seeds", "explore --port", "film --sheet", "conflicts --from", "calibrate --jobs"} < tried
    assert not list(Path.cwd().iterdir())


def test_every_option_for_a_path_expands_the_home_directory(capsys: pytest.CaptureFixture[str]) -> None:
    tried = set()
    for command in COMMANDS:
        assert invoke([command, "--help"]) == 0
        argument = [] if command == "calibrate" else ["fig-6.1a"]
        for option in re.findall(r"--(\S+) (?:DIR|FILE|TOML) ", capsys.readouterr().out):
            for value, rule in (
                ("~nobody-has-this-name/x", "names an unknown user; "),
                ("", "must not be empt"),
            ):
                assert invoke([command, *argument, f"--{option}={value}"]) == 2
                (line,) = capsys.readouterr().err.splitlines()
                assert line.startswith(f"kswarms: {option}={value!r}: {rule}")
            tried.add(f"{command} --{option}")
    outputs = {f"{command} --out" for command in ("run", "contribution", "calibrate", "film", "report")}
    assert outputs | {"report --files", "report --findings"} <= tried
    assert not list(Path.cwd().iterdir())


def test_outputs_go_to_the_home_directory(monkeypatch: pytest.MonkeyPatch) -> None:
    home = Path.cwd() / "home"
    home.mkdir()
    monkeypatch.setenv("HOME", str(home))
    film = ["film", "fig-6.1c", "--n", "6", "--to", "1", "--sheet", "1"]
    assert invoke(["run", "fig-6.1c", "--densities", "6", *QUICK, "--no-figures", "--out=~/study"]) == 0
    assert invoke([*film, "--out=~/sheet.png"]) == 0
    assert {path.name for path in home.iterdir()} == {"study", "sheet.png"}
    assert [path.name for path in Path.cwd().iterdir()] == ["home"]


def test_a_film_replaces_a_file_only_if_it_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    film = ["film", "fig-6.1c", "--n", "6", "--to", "1", "--sheet", "1"]
    for name in ("fig-6.1c-n6-seed0.png", "mine.png"):
        Path(name).write_text("precious")
    assert invoke(film) == 2
    error = "out='fig-6.1c-n6-seed0.png': exists; give its name with --out to replace it"
    assert capsys.readouterr().err == f"kswarms: {error}\n"
    assert Path("fig-6.1c-n6-seed0.png").read_text() == "precious"
    assert invoke([*film, "--out", "mine.png"]) == 0
    assert Path("mine.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("title", ["$x^{ costs $", "漢字", "../../a/b", "<b>&amp;", "_x"])
def test_any_title_is_drawn_and_reported(title: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine.toml").write_text(SCENARIO.replace("TITLE", title), encoding="utf-8")
    assert invoke(["run", "mine.toml", *QUICK]) == 0
    assert capsys.readouterr().err == ""
    assert Path("results", "figures", "mine.png").stat().st_size > 0
    assert invoke(["report", "results"]) == 0
    assert [path.name for path in Path.cwd().iterdir() if path.name not in ("mine.toml", "results")] == []


def test_a_film_is_named_by_its_condition_and_stays_in_the_directory() -> None:
    Path("mine.toml").write_text(SCENARIO.replace("TITLE", "../../a/b"))
    assert invoke(["film", "mine.toml", "--sheet", "1", "--to", "1"]) == 0
    names = {path.name for path in Path.cwd().iterdir()}
    assert names == {"mine.toml", "mine-..-..-a-b-n6-seed0-840e9fee.png"}


@pytest.mark.parametrize(
    "command",
    [
        *("status LONG", "export LONG", "replay LONG RUN", "replay . LONG", "merge x LONG"),
        *("run LONG.toml", "run fig-6.1a --out LONG", "report LONG", "film LONG", "film --out LONG.gif"),
        *("conflicts LONG --run RUN", "contribution LONG", "calibrate --out LONG", "show LONG/LONG"),
    ],
)
def test_a_long_name_is_one_short_line(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(command.replace("LONG", "n" * 5000).split()) in (1, 2)
    (line,) = capsys.readouterr().err.splitlines()
    assert len(line) < 400
    assert "Path(" not in line
    assert list(Path().iterdir()) == []
