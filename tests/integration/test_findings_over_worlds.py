"""`kswarms findings`: verdicts in the default world and in worlds of a calibration."""

from pathlib import Path

import pandas as pd
import pytest

from kswarms.scenarios.cli import invoke

pytestmark = pytest.mark.usefixtures("empty_directory")

FINDINGS = """
[[findings]]
id = "fast-pucks"
statement = "Two avoiding swarms of three gather something."
[findings.claim]
kind = "compare"
left = { scenario = "fig-6.1a" }
relation = ">"
right = 0
densities = [6]
"""
WORLDS = "friction,push_share\n0.7,1.0\n0.5,0.5\n"
COMMAND = ["findings", "--findings", "mine.toml", "--densities", "6", "--seeds", "2", "--jobs", "1"]


@pytest.fixture(autouse=True)
def _files(empty_directory: Path) -> None:
    Path("mine.toml").write_text(FINDINGS)
    Path("calibration").mkdir()
    Path("calibration/ensemble.csv").write_text(WORLDS)


def test_verdicts_count_the_worlds(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([*COMMAND, "--worlds", "1", "--calibration", "calibration"]) == 0
    assert "1 of 1 worlds" in capsys.readouterr().out
    (row,) = pd.read_csv("findings/findings.csv").to_dict("records")
    assert (row["finding"], row["holds"], row["worlds"], row["depends"]) == ("fast-pucks", 1, 1, False)
    played = {path.name: pd.read_parquet(path / "runs.parquet") for path in Path("findings").glob("*/")}
    assert set(played) == {"default", "world-01"}
    assert set(played["world-01"]["run"]) & set(played["default"]["run"]) == set()
    assert set(played["default"]["seed"]) == {3000, 3001}


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--worlds", "3", "--calibration", "calibration"], "worlds=3: must be at most 2, the worlds of the"),
        (["--worlds", "1", "--calibration", "none"], "calibration='none': must be the dir"),
        (["--densities", "7"], "densities='7': must suit at least one scenario"),
    ],
)
def test_invalid_options_are_refused_and_nothing_is_written(
    words: list[str], error: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke([*COMMAND, *words]) == 2
    assert capsys.readouterr().err.startswith(f"kswarms: {error}")
    assert not Path("findings").exists()
