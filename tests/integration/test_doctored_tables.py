"""Commands and functions with damaged or doctored tables: one line, no figure of nonsense."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.figures.heat_maps import heat_map_figure
from kswarms.analysis.figures.over_n import figure_of, write_figures
from kswarms.analysis.figures.over_time import pucks_over_time
from kswarms.analysis.findings import FINDINGS, judge, judge_all
from kswarms.analysis.measures.conflict_density import conflict_density
from kswarms.analysis.measures.contribution import select_contributions
from kswarms.analysis.measures.emergence import choices, preferences
from kswarms.analysis.measures.learned import learned_shares
from kswarms.analysis.measures.networks import jams, meeting_network
from kswarms.analysis.measures.utilities import robot_utilities
from kswarms.analysis.results.runs import Results, read_results
from kswarms.analysis.tables.fidelity import compare_with_argos
from kswarms.analysis.tables.scores import scores
from kswarms.scenarios.cli import invoke
from tests.helpers.contribution_rows import contribution_rows
from tests.helpers.result_rows import MET, learning_conflicts, robots, runs_of

RUNS = runs_of("fig-6.1a", densities=[6], seeds=2)
RUN = RUNS["run"].iloc[0]
DOCTORED = {
    "runs pucks=inf: must be an integer ≥ 0": RUNS.assign(pucks=math.inf),
    "runs size=-3: must be an integer ≥ 0": RUNS.assign(size=-3),
    "runs t_p='large_string': must be a column of numbers": RUNS.assign(t_p="600"),
    "runs key='scenario=fig-6.1a": pd.concat([RUNS, RUNS[:1]]),
    "runs scenario='x\\x1b[2J': must be one line": RUNS.assign(scenario="x\x1b[2J"),
    "runs n='timestamp[us]': must be a column of integers": RUNS.assign(n=pd.Timestamp(2026, 1, 1)),
    "conflicts x=None: must be given in every row": MET.assign(run=RUN, x=math.nan),
    "conflicts t_a=-1.0: must be a finite number ≥ 0": MET.assign(run=RUN, t_a=-1.0),
    "conflicts phase='other': must be one of learning, game": MET.assign(run=RUN, phase="other"),
    "robots pucks=0.5: must be an integer ≥ 0": robots((RUN,)).assign(pucks=0.5),
    "policies key='run=": RUNS.assign(
        condition="other", opponent=1, action="flight", share=0.5, attack_share=0.0
    ),
    "policies share=2.0: must be a finite number 0 to 1": RUNS.assign(
        opponent=1, action="flight", share=2.0, attack_share=0.0
    ),
}


@pytest.mark.parametrize(("message", "frame"), DOCTORED.items(), ids=DOCTORED)
def test_a_report_on_a_doctored_table_is_one_line_and_writes_nothing(
    message: str, frame: pd.DataFrame, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, rest = message.split(" ", 1)
    RUNS.to_parquet(tmp_path / "runs.parquet")
    frame.to_parquet(tmp_path / f"{table}.parquet")
    before = set(tmp_path.iterdir())
    assert invoke(["report", str(tmp_path)]) == 2
    printed = capsys.readouterr()
    (line,) = [each for each in printed.err.splitlines() if each.startswith("kswarms: ")]
    kind = "" if rest.startswith("key") else "column "
    assert line.startswith(f"kswarms: {table}.parquet {kind}{rest}")
    assert set(tmp_path.iterdir()) == before


CONFLICTS = MET.assign(seen=[[[0], []]] * len(MET))
FUNCTIONS: dict[str, tuple[Callable[[Any], object], pd.DataFrame, str]] = {
    "figure_of": (lambda rows: figure_of(rows, "fig-6.1a"), RUNS, "pucks"),
    "scores": (lambda rows: scores(rows, "fig-6.1a"), RUNS, "sud"),
    "choices": (choices, learning_conflicts(), "start"),
    "preferences": (preferences, robots(), "swarm"),
    "meeting_network": (meeting_network, MET, "opponent"),
    "jams": (jams, MET, "t_a"),
    "conflict_density": (conflict_density, MET, "x"),
    "heat_map_figure": (heat_map_figure, MET, "y"),
    "robot_utilities": (robot_utilities, CONFLICTS, "t_p"),
    "select_contributions": (select_contributions, contribution_rows(2, 3), "reward"),
    "learned_shares": (
        lambda rows: learned_shares(rows, ["fig-6.1a"]),
        RUNS.assign(opponent=1, action="flight", share=1.0, attack_share=0.5),
        "attack_share",
    ),
}


@pytest.mark.parametrize(("function", "rows", "column"), FUNCTIONS.values(), ids=FUNCTIONS)
def test_functions_check_the_rows_that_a_user_gives(
    function: Callable[[Any], object], rows: pd.DataFrame, column: str
) -> None:
    function(rows)
    before = rows.copy(deep=True)
    for value in (math.inf, "many", None, [1], 1j):
        with pytest.raises(InputError, match=f"column {column}"):
            function(rows.assign(**{column: [value] * len(rows)}))
    with pytest.raises(InputError, match=f"'{column}'"):
        function(rows.drop(columns=column))
    with pytest.raises(InputError, match=f"'{column}': must have one column of this name"):
        function(pd.concat([rows, rows[[column]]], axis=1))
    for other in (None, 5, "results", rows.to_dict("records")):
        with pytest.raises(InputError, match=r"must be a pandas\.DataFrame"):
            function(other)
    pd.testing.assert_frame_equal(rows, before)


def test_functions_without_a_full_schema_need_their_columns() -> None:
    for rows in (None, RUNS.drop(columns="pucks")):
        with pytest.raises(InputError, match="must"):
            compare_with_argos(rows)
        with pytest.raises(InputError, match="must"):
            judge(FINDINGS[0], Results(rows))
    for changes in ({"n": math.nan}, {"pucks": math.inf}, {"t_p": "many"}, {"seed": -1}):
        with pytest.raises(InputError, match=f"column {next(iter(changes))}"):
            judge_all(Results(RUNS.assign(**changes)))
    for samples in (None, pd.DataFrame({"time": ["a"], "pucks_1": [1]})):
        with pytest.raises(InputError, match="samples"):
            pucks_over_time(samples)


NO_GAMES = [None, 42, [1, 2], {"a": 1}, [], pd.DataFrame(), [{"pucks_1": 1}], object()]


@pytest.mark.parametrize("source", NO_GAMES, ids=lambda source: type(source).__name__)
def test_sources_that_are_no_games_are_refused(source: Any) -> None:
    with pytest.raises(InputError, match="source="):
        read_results(source)


def test_huge_positions_and_times_need_little_memory() -> None:
    far = MET.assign(x=1e15)
    assert conflict_density(far, 1e15).shape == (1000, 1000)
    with pytest.raises(InputError, match=r"every=1.0: must be greater"):
        jams(MET.assign(t_a=1e15))
    assert len(jams(MET.assign(robot=10**15))) == 10


def test_figures_of_doctored_runs_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="runs column pucks="):
        write_figures(Results(RUNS.assign(pucks=math.nan)), tmp_path / "figures")
    assert not list(tmp_path.iterdir())
