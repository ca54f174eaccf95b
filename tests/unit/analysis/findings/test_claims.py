"""Findings as data: valid and invalid TOML files, and the findings of the thesis."""

from pathlib import Path

import pandas as pd
import pytest

from kswarms.agents.common.errors import InputError
from kswarms.analysis.findings import FINDINGS, HOLDS, judge, read_findings
from kswarms.analysis.findings.claims import Compare
from kswarms.analysis.findings.data import sample
from kswarms.analysis.findings.quantity import UNITS, Quantity
from kswarms.analysis.results.runs import Results
from kswarms.scenarios.catalogue import CATALOGUE

HEAD = """
[[findings]]
id = "mine"
statement = "It is so."
[findings.claim]
"""
COMPARE = """
kind = "compare"
left = { scenario = "a", swarm = 1 }
relation = ">"
right = { scenario = "b", swarm = 1 }
"""
OVERTAKE = """
kind = "overtake"
ahead = { scenario = "a" }
behind = { scenario = "b" }
between = [30, 40]
"""


TREND = HEAD + 'kind = "trend"\nquantity = { scenario = "a", '


def write(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_user_defined_finding_is_loaded(tmp_path: Path) -> None:
    (finding,) = read_findings(write(tmp_path, HEAD + COMPARE + "margin = 2\n"))
    assert (finding.id, finding.source, finding.confidence) == ("mine", "", 0.95)
    assert finding.scenarios == ("a", "b")
    assert finding.claim == Compare(
        left=Quantity(scenario="a", swarm=1), relation=">", right=Quantity(scenario="b", swarm=1), margin=2.0
    )


def test_a_finding_can_be_changed() -> None:
    finding = FINDINGS[0]
    changed = finding.replace(claim=finding.claim.replace(margin=0.0))
    assert changed.claim.quantities == finding.claim.quantities
    with pytest.raises(InputError, match=r"confidence=2\.0"):
        finding.replace(confidence=2.0)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("findings = 3", r"findings=3: must be a valid tuple"),
        ("", r"findings=None: is required"),
        (f"findings = {'[' * 3000}", r"must be a TOML file \(maximum recursion"),
        ("findings = []", r"findings=\[\]"),
        ("not TOML", r"findings='.*mine\.toml': must be a TOML file \(Expected '='"),
        (
            HEAD + COMPARE + "above = 3",
            r"claim\.compare\.above=3: unknown field; allowed: densities, kind, left",
        ),
        (HEAD + COMPARE + "[notes]", r"notes=\{\}: unknown field; allowed: findings"),
        (HEAD + COMPARE.replace(">", "≈"), r"relation='≈': must be '>', '>=', '<', '<=' or 'within'"),
        (HEAD + COMPARE.replace("compare", "guess"), r"findings\.0\.claim=.*'compare', 'overtake'"),
        (HEAD + COMPARE + "margin = -1", r"margin=-1: must be greater than or equal to 0"),
        (HEAD + COMPARE + "densities = [6, 30, 16]", r"densities=\[6, 30, 16\]: must ascend"),
        (HEAD + COMPARE + 'over = "all N"', r"over='all N': must be 'each N', 'mean over N' or 'sum over N'"),
        (2 * (HEAD + COMPARE), r"findings\.id='mine': must be given once"),
        (HEAD.replace("mine", "My own") + COMPARE, r"findings\.0\.id='My own'"),
        (
            HEAD + 'kind = "share above"\nabove = 99\nquantity = { scenario = "a", swarm = 2 }',
            r"quantity\.measure='pucks': must be one of learned_attack, learned_flight_within",
        ),
        (TREND + 'measure = "speed" }', rf"quantity\.measure='speed': must be one of {', '.join(UNITS)}"),
        (
            TREND + 'measure = "learned_attack" }',
            r"quantity\.swarm=None: must be given: learned_attack is a measure of one swarm",
        ),
        (TREND + 'measure = "sud" }', r"quantity\.swarm=None: must be given: sud has no sum"),
        (TREND + "opponent = 2 }", r"quantity\.opponent=2: must be omitted: only learned_attack has"),
        (
            HEAD + COMPARE.replace('"b"', '"b", measure = "time_inter"'),
            r"right\.measure='time_inter': must have the unit of left, pucks",
        ),
        (HEAD + OVERTAKE.replace("40", "20"), r"between=\[30, 20\]: must ascend"),
        (
            HEAD + OVERTAKE.replace('"b"', '"b", measure = "time_inter"'),
            r"behind\.measure='time_inter': must have the unit of ahead, pucks",
        ),
        (
            HEAD + 'kind = "agree with the published table"\nmargin = 5\ncells = [{ scenario = "fig-6.1a" }]',
            r"cells=\[.*\]: must be columns of Tables 6\.1 to 6\.3",
        ),
    ],
)
def test_invalid_findings_are_refused(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        read_findings(write(tmp_path, text))


def test_an_unreadable_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "latin.toml").write_bytes(b'id = "\xe9"')
    for name in ("absent.toml", "latin.toml", "."):
        with pytest.raises(InputError, match=r"must be a (readable|regular) file|must be a TOML file"):
            read_findings(tmp_path / name)


def test_the_findings_of_the_thesis_refer_to_the_catalogue() -> None:
    assert len({finding.id for finding in FINDINGS}) == len(FINDINGS) > 15
    for finding in FINDINGS:
        for quantity in finding.claim.quantities:
            scenario = CATALOGUE[quantity.scenario]
            (condition,) = (each for each in scenario.conditions if each.name == quantity.condition)
            assert quantity.swarm is None or quantity.swarm <= len(condition.swarms)
            if quantity.measure.startswith("learned"):
                assert quantity.swarm is not None
                assert condition.learning > 0
                assert "learner" in condition.swarms[quantity.swarm - 1].policy
            assert set(finding.claim.densities) <= set(scenario.densities)


def test_each_measure_is_read_from_the_results() -> None:
    row = {"scenario": "a", "condition": "", "n": 6, "seed": 0, "swarm": 1, "size": 3, "pucks": 7, "sud": -2}
    row |= {"t_a_intra": 30.0, "t_a_inter": 60.0, "t_p": 210.0, "conflicts_intra": 4, "conflicts_inter": 9}
    row |= {"duration": 100.0}
    shares = [{"opponent": 2, "attack_share": 0.25}, {"opponent": 1, "attack_share": 0.1}]
    results = Results(pd.DataFrame([row]), pd.DataFrame([row | share for share in shares]))
    expected = {"pucks": 7, "sud": -2, "duration": 100, "time_in_conflict": 30, "time_inter": 20}
    expected |= {"time_intra": 10, "conflicts_inter": 9, "conflicts_intra": 4}
    expected |= {"learned_attack": 25, "learned_flight_within": 90}
    assert expected.keys() == UNITS.keys()
    for measure, value in expected.items():
        found = sample(results, Quantity(measure=measure, scenario="a", swarm=1))
        assert found.loc[0, 6] == pytest.approx(value), measure


def test_a_learned_measure_without_policies_has_no_samples() -> None:
    row = {"scenario": "a", "condition": "", "n": 6, "seed": 0, "swarm": 1}
    quantity = Quantity(measure="learned_attack", scenario="a", swarm=1)
    assert sample(Results(pd.DataFrame([row])), quantity).empty


def test_a_finding_from_a_file_is_judged(tmp_path: Path) -> None:
    rows = [
        {"scenario": scenario, "condition": "", "n": 20, "seed": seed, "swarm": 1, "pucks": pucks + seed % 3}
        | {"t_a_intra": 1.0, "t_a_inter": 1.0, "t_p": 1.0, "conflicts_intra": 1, "conflicts_inter": 1}
        | {"size": 10, "sud": 0, "duration": 1.0}
        for scenario, pucks in (("a", 20), ("b", 10))
        for seed in range(8)
    ]
    (finding,) = read_findings(write(tmp_path, HEAD + COMPARE))
    verdict = judge(finding, Results(pd.DataFrame(rows)))
    assert (verdict.verdict, verdict.effect, verdict.unit) == (HOLDS, 10.0, "pucks")
