"""Verdicts in several worlds."""

import math

import pytest

from kswarms.analysis.findings import Finding
from kswarms.analysis.findings.claims import Compare
from kswarms.analysis.findings.quantity import Quantity
from kswarms.analysis.findings.worlds.judging import holds_on_average, judge_over_worlds, worlds_table
from kswarms.analysis.results.runs import Results
from tests.helpers.synthetic_results import S1, S2, runs

LEADS = Compare(left=S2, relation=">", right=S1, over="mean over N")
FINDING = Finding(id="leads", statement="S2 leads.", claim=LEADS)


def world(lead: float, friction: float, other: float = 1.0) -> tuple[dict[str, float], Results]:
    made = Results(runs([[3.0] * 5, [3.0 + lead] * 5], seeds=4, scale=0.01))
    return {"friction": friction, "other": other, "fixed": 2.0}, made


def test_a_finding_that_flips_names_the_parameter_that_explains_it() -> None:
    worlds = [world(-2, 0.1), world(-1, 0.2, 3.0), world(1, 0.4, 2.0), world(2, 0.5)]
    (row,) = judge_over_worlds([FINDING], world(5, 0.3)[1], worlds).to_dict("records")
    assert (row["holds"], row["worlds"], row["depends"], row["parameter"]) == (2, 4, True, "friction")
    assert row["correlation"] == pytest.approx(1.0)
    assert row["verdict"] == "undecided"  # four seeds have no interval


def test_a_finding_that_holds_everywhere_depends_on_no_parameter() -> None:
    frame = judge_over_worlds([FINDING], world(5, 0.3)[1], [world(1, 0.1), world(2, 0.2), world(3, 0.3)])
    (row,) = frame.to_dict("records")
    assert (row["holds"], row["worlds"], row["depends"], row["parameter"]) == (3, 3, False, "")
    assert math.isnan(row["correlation"])
    assert worlds_table(frame).rows == [["leads", "S2 leads.", "undecided", "3 of 3 worlds", "–"]]


def test_two_worlds_that_differ_have_no_correlation() -> None:
    frame = judge_over_worlds([FINDING], world(5, 0.3)[1], [world(-1, 0.1), world(2, 0.2)])
    assert worlds_table(frame).rows[0][3:] == ["1 of 2 worlds", "the world"]


def test_worlds_without_the_games_are_not_counted() -> None:
    absent = FINDING.replace(id="absent", claim=LEADS.replace(left=Quantity(scenario="none", swarm=1)))
    (row,) = judge_over_worlds([absent], world(1, 0.1)[1], [world(1, 0.1)] * 3).to_dict("records")
    assert (row["verdict"], row["holds"], row["worlds"], row["depends"]) == ("no data", 0, 0, False)
    assert holds_on_average(absent.claim, world(1, 0.1)[1]) is None
