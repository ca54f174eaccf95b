"""``kswarms contribution``: output, files and errors."""

from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.scenarios.cli import invoke

pytestmark = pytest.mark.usefixtures("empty_directory")

FEW = ["--n", "6", "--seeds", "2", "--jobs", "1"]


def test_it_writes_a_table_and_a_figure_and_prints_the_results(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["contribution", "fig-6.1c", *FEW, "--robots", "S2,0", "--first-seed", "3"]) == 0
    out = capsys.readouterr().out
    table, figure = Path("results/contribution.parquet"), Path("results/figures/contribution-fig-6.1c.png")
    assert out.splitlines()[:2] == [f"table:  {table}", f"figure: {figure}"]
    assert figure.read_bytes().startswith(b"\x89PNG")
    rows = pq.read_table(table).to_pylist()
    expected = [(3, 0), (3, 3), (3, 4), (3, 5), (4, 0), (4, 3), (4, 4), (4, 5)]
    assert [(row["seed"], row["robot"]) for row in rows] == expected
    assert {row["absent_from"] for row in rows} == {"learning"}
    assert all(row["time_sud"] == row["time_sud"] != row["time_sud_without"] for row in rows)
    for heading in ("contribution and reward of each robot", "rank correlation", "seconds of other robots"):
        assert heading in out
    assert "mean of S2" in out


def test_rows_of_several_conditions_are_kept() -> None:
    for condition in ("delta=0.25", "random"):
        options = ["--condition", condition, "--robots", "5", "--absent-from", "game", "--seeds", "1"]
        assert invoke(["contribution", "fig-6.12", *FEW, *options, "--out", "here"]) == 0
    rows = pq.read_table("here/contribution.parquet").to_pylist()
    found = [(row["condition"], row["absent_from"]) for row in rows]
    assert found == [("delta=0.25", "game"), ("random", "game")]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ("table-6.1", "id='table-6.1': must be one scenario: fig-6.4a, fig-6.4b"),
        ("fig-6.12", "condition=None: must be one of 'delta=0.02', "),
        ("fig-6.12 --condition dleta=0.02", "condition='dleta=0.02': must be one of 'delta=0.02', "),
        ("fig-6.4b --n 6 --robots 6", "robots='6': must be robots, 0 to 5, or swarms, S1, S2"),
        ("fig-6.4b --absent-from dinner", "absent_from='dinner': must be one of 'learning', 'game'\n"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    arguments: str, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["contribution", *arguments.split()]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(f"kswarms: {line}")
    assert captured.err.count("\n") == 1
    assert not list(Path().iterdir())
