"""Figure and tables of contributions."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.contribution import contribution_figure, write_contribution_figure
from kswarms.analysis.measures.contribution import mean_contributions, select_contributions
from kswarms.analysis.results.records import read_contributions
from kswarms.analysis.tables.contribution import contribution_tables
from tests.helpers.contribution_rows import ROBOTS, SEEDS, contribution_rows, noise
from tests.helpers.legends import legend_texts


def rows_of_two_swarms() -> pd.DataFrame:
    better = np.arange(ROBOTS)
    first = contribution_rows(swarm=1, policy="attack", time_sud=noise(), reward=3 + noise(0.1, 1), sud=2)
    second = contribution_rows(swarm=2, time_sud=better + noise(seed=2), reward=better + noise(0.1, 3))
    return select_contributions(pd.concat([first, second]))


def test_the_scatter_chart_shows_each_robot_at_its_means() -> None:
    rows = rows_of_two_swarms()
    figure = contribution_figure(rows, "a title")
    pucks, time = figure.axes
    assert (pucks.get_ylabel()[-7:], time.get_ylabel()[-3:]) == ("(pucks)", "(s)")
    assert "fig-6.4b: a title, N = 16" in figure.get_suptitle()
    assert legend_texts(figure) == ["S1: attack", "S2: inter-learner"]
    found = mean_contributions(rows)
    for swarm, bars in zip((1, 2), time.containers, strict=True):
        robots = found[(found["swarm"] == swarm) & (found["robot"] >= 0)]
        assert bars.lines[0].get_xydata().tolist() == robots[["reward", "time"]].to_numpy().tolist()
    assert time.get_title().count("rank correlation of robots") == 2


def test_the_tables_name_robots_swarms_and_intervals() -> None:
    (_, robots), (_, ranks), (_, freed) = contribution_tables(rows_of_two_swarms())
    of_s1, of_s2 = map(str, range(10, 18)), map(str, range(20, 28))
    assert [line[0] for line in robots[1:]] == [*of_s1, "mean of S1", *of_s2, "mean of S2"]
    assert robots[1][2] == "2.00 (2.00 … 2.00)"
    assert [line[:2] for line in ranks[1:]] == [["S1", "pucks"], ["S1", "s"], ["S2", "pucks"], ["S2", "s"]]
    assert ranks[1][2:] == ["–", "–"]
    assert freed[1] == ["S1", "mates", "100.0", "100.0", "100.0", "100.0", "100.0", "0.00 (0.00 … 0.00)"]
    assert contribution_tables(select_contributions(contribution_rows(seeds=1)))[0][1][1][2] == "0.00"


def test_a_figure_is_written_from_the_table(tmp_path: Path) -> None:
    rows = pd.concat([contribution_rows(reward=noise()), contribution_rows(n=26)])
    rows.to_parquet(tmp_path / "contribution.parquet")
    assert len(read_contributions(tmp_path)) == 2 * SEEDS * ROBOTS
    path = write_contribution_figure(tmp_path, n=16)
    assert path == tmp_path / "figures" / "contribution-fig-6.4b.png"
    assert path.read_bytes().startswith(b"\x89PNG")
    assert list(path.parent.iterdir()) == [path]


def test_unreadable_tables_and_unwritable_figures_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must be a directory that holds contribution\.parquet"):
        read_contributions(tmp_path)
    (tmp_path / "contribution.parquet").write_bytes(b"no table")
    with pytest.raises(InputError, match="must be a readable Parquet file"):
        read_contributions(tmp_path)
    contribution_rows().to_parquet(tmp_path / "contribution.parquet")
    (tmp_path / "figures").write_text("in the way")
    with pytest.raises(InputError, match="must be a writable file"):
        write_contribution_figure(tmp_path)
