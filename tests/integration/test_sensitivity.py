"""`kswarms sensitivity` on games of few robots."""

import sys
from pathlib import Path

import pandas as pd
import pytest

from kswarms.scenarios.cli import invoke

pytestmark = pytest.mark.usefixtures("empty_directory")

COMMAND = [
    *("sensitivity", "fig-6.1a", "--densities", "6", "--free", "friction,station_radius", "--seeds", "1"),
    *("--trajectories", "2", "--jobs", "1"),
]


def test_the_indices_are_printed_and_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("SALib", reason="needs the extra `sensitivity`")
    assert invoke(COMMAND) == 0
    printed = capsys.readouterr().out
    assert "2 trajectories, seeds: 1" in printed
    table = pd.read_csv("sensitivity/sensitivity.csv")
    assert set(table["parameter"]) == {"friction", "station_radius"}
    assert (table["mu_star"].diff().dropna() <= 0).all()
    monkeypatch.setattr("kswarms.scenarios.runs.sweep.play_all", None)  # calling it would fail
    assert invoke(COMMAND) == 0
    assert capsys.readouterr().out == printed


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--free", "mass"], "free='mass': must be among conflict_distance"),
        (["--measure", "mass"], "measure='mass': must be one of pucks"),
        (["--condition", "x"], "condition='x': must be one of '' of fig-6.1a"),
        (["--densities", "7"], "n=7: must be a multiple of 2"),
        (["--measure", "learned_attack", "--swarm", "2"], "measure='learned_attack': must be a measure of"),
        (["--swarm", "3"], "measure='pucks': must be a measure of the games: none of fig-6.1a S3"),
    ],
)
def test_invalid_options_are_refused(
    words: list[str], error: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("SALib", reason="needs the extra `sensitivity`")
    assert invoke([*COMMAND, *words]) == 2
    assert capsys.readouterr().err.startswith(f"kswarms: {error}")


def test_an_unknown_scenario_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("SALib", reason="needs the extra `sensitivity`")
    assert invoke(["sensitivity", "fig-9"]) == 2
    assert capsys.readouterr().err.startswith("kswarms: scenario='fig-9': must be one of `kswarms list`")
    assert not list(Path().iterdir())


def test_without_the_library_one_line_says_what_to_install(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in list(sys.modules):
        if name.startswith(("SALib", "kswarms.scenarios.calibration.sensitivity")):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "SALib", None)
    assert invoke(COMMAND) == 2
    assert "must be installed: pip install kswarms[sensitivity]" in capsys.readouterr().err
    assert not list(Path().iterdir())
