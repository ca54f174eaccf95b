"""The ensemble of worlds: package data, texts that name its members, and files of worlds."""

from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import (
    PRESETS,
    ensemble,
    parse_parameters,
    read_worlds,
    text_of,
    write_worlds,
)
from kswarms.scenarios.calibration.prior import PRIOR


def test_the_ensemble_has_thirty_different_worlds_of_the_prior() -> None:
    worlds = ensemble()
    assert len(worlds) >= 30
    assert len({text_of(world) for world in worlds}) == len(worlds)
    for name, value in PRESETS["fitted"]:
        values = {getattr(world, name) for world in worlds}
        if name in PRIOR:
            assert PRIOR[name].low <= min(values) < max(values) <= PRIOR[name].high
        else:
            assert values == {value}


def test_a_text_names_a_member_of_the_ensemble() -> None:
    worlds = ensemble()
    assert parse_parameters("ensemble:7") == worlds[6]
    assert parse_parameters(f" ensemble:{len(worlds)}, friction=0.3") == worlds[-1].replace(friction=0.3)


@pytest.mark.parametrize("number", ["0", "-1", "1000", "1.0", "x", "", "\u0661", "9" * 5000])
def test_other_members_are_refused(number: str) -> None:
    with pytest.raises(InputError) as refusal:
        parse_parameters(f"ensemble:{number}")
    assert str(refusal.value).startswith("parameters='ensemble:")
    assert str(refusal.value).endswith(f": must be ensemble:1 to ensemble:{len(ensemble())}")


def test_worlds_are_written_and_read(tmp_path: Path) -> None:
    file = tmp_path / "worlds.csv"
    write_worlds(file, [{"friction": 0.25, "gamma": 0.01}, {"friction": 1 / 3, "gamma": 0.0}])
    assert read_worlds(file) == (
        Parameters(friction=0.25, gamma=0.01),
        Parameters(friction=1 / 3, gamma=0.0),
    )


@pytest.mark.parametrize(
    ("content", "error"),
    [
        ("friction\nmuch\n", "must be a CSV file of parameters"),
        ("friction,gamma\n0.1\n", "must be a CSV file of parameters"),
        ("friction\n0.1,0.2\n", "must be a CSV file of parameters"),
        ('friction\n"0.1', "must be a CSV file of parameters"),
        ("mass\n1\n", "mass=1.0: unknown field"),
        ("friction\n-1\n", "friction=-1.0: must be greater than or equal to 0"),
    ],
)
def test_other_files_are_refused(content: str, error: str, tmp_path: Path) -> None:
    file = tmp_path / "worlds.csv"
    file.write_text(content)
    with pytest.raises(InputError, match=error):
        read_worlds(file)


def test_an_absent_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="must be a CSV file of parameters"):
        read_worlds(tmp_path / "absent.csv")
