"""Scenarios from TOML files: written scenarios can be read, and errors name file and field."""

from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selection import select_scenarios
from kswarms.scenarios.description.scenario import toml_of
from kswarms.scenarios.description.toml_files import read_scenarios

HUNT = """
id = "hunt"
title = "Two avoid one"
densities = [9]
seeds = 3

[[conditions]]
duration = 60
swarms = [{policy = "avoid", share = 2}, {policy = "aggressive"}]
"""


def test_written_scenarios_can_be_read(tmp_path: Path) -> None:
    file = tmp_path / "shown.toml"
    for scenario in CATALOGUE.values():
        file.write_text(scenario.to_toml())
        assert read_scenarios(file) == [scenario]
    several = [CATALOGUE[name] for name in TABLES["table-7.2"].scenarios]
    file.write_text(toml_of(several))
    assert read_scenarios(file) == several


def test_fields_at_their_defaults_may_be_left_out(tmp_path: Path) -> None:
    (tmp_path / "hunt.toml").write_text(HUNT)
    (hunt,) = select_scenarios([str(tmp_path / "hunt.toml")])
    assert [rule.policy for rule in hunt.conditions[0].swarms] == ["avoid", "aggressive"]
    assert hunt.conditions[0].sizes(9) == [6, 3]
    assert hunt.conditions[0].layout == CATALOGUE["fig-6.1a"].conditions[0].layout


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("[9]", "[9", "id='FILE': must be a TOML file (Unclosed array"),
        ('"hunt"', '"Hunt me"', "hunt.toml: id='Hunt me': "),
        ("[9]", "[10]", "hunt.toml: n=10: must be a multiple of 3"),
        (
            "duration = 60",
            'duration = "long"',
            "hunt.toml: conditions.0.duration='long': must be a num",
        ),
        ("duration", "length", "hunt.toml: conditions.0.length=60: unknown field; allowed: layout, "),
        ('"avoid"', '"atack"', "hunt.toml: policy='atack': must be one of avoid"),
        ("seeds = 3", "self = 1", "hunt.toml: self=1: unknown field; allowed: id, title, "),
        ("seeds = 3", '"a-b" = 1', "hunt.toml: a-b=1: unknown field; allowed: id, title, "),
        ("duration = 60", "self = 1", "hunt.toml: conditions.0.self=1: unknown field; allowed: layout, "),
        ("share = 2", "self = 1", "hunt.toml: conditions.0.swarms.0.self=1: unknown field; allowed: pol"),
        ('title = "Two avoid one"', "", "hunt.toml: title=None: is required"),
        ('id = "hunt"', "scenarios = []\nid = 'hunt'", "hunt.toml: scenarios=[]: must not be empty, and"),
        (HUNT, "scenarios = []", "hunt.toml: scenarios=[]: must not be empty, and"),
        (HUNT, "scenarios = [3]", "hunt.toml: scenarios.0=3: must be a table"),
        (HUNT, "[[scenarios]]\nid = 3", "hunt.toml: scenarios.0: id=3: must be a valid string"),
        ('"hunt"', f'"{"a" * 101}"', "hunt.toml: id='aaa"),
        ("Two avoid one", "Two avoid\\u0000one", "hunt.toml: title='Two avoid\\x00one': "),
        ("duration = 60", 'name = "a\\nb"', "hunt.toml: conditions.0.name='a\\nb': "),
        ("seeds = 3", "seeds = true", "hunt.toml: seeds=True: must be a number"),
        ("seeds = 3", "seeds = 1000001", "hunt.toml: seeds=1000001: must be less than"),
        (HUNT, f"id = {'[' * 3000}", "id='FILE': must be a TOML file (maximum recursion"),
        (HUNT, "", "hunt.toml: id=None: is required"),
    ],
)
def test_an_error_names_the_file_and_the_field(before: str, after: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "hunt.toml"
    assert before in HUNT
    file.write_text(HUNT.replace(before, after))
    with pytest.raises(InputError) as refusal:
        read_scenarios(file)
    assert str(refusal.value).startswith(message.replace("FILE", str(file)))
    assert "\n" not in str(refusal.value)


def test_a_file_that_is_not_text_is_refused(tmp_path: Path) -> None:
    (tmp_path / "noise.toml").write_bytes(b"\xff\xfe\x00")
    for path, rule in (("noise.toml", "a TOML file"), ("absent.toml", "a readable file"), (".", "a regular")):
        with pytest.raises(InputError, match=f"must be {rule}"):
            read_scenarios(tmp_path / path)


def test_a_byte_order_mark_is_accepted(tmp_path: Path) -> None:
    file = tmp_path / "hunt.toml"
    file.write_text(HUNT, encoding="utf-8-sig")
    assert read_scenarios(file)[0].id == "hunt"


def test_scenarios_with_the_same_id_must_be_equal(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(CATALOGUE["fig-6.1c"].to_toml())
    first, second = select_scenarios(["fig-6.1c", str(file), "fig-6.1a"])
    assert (first, second) == (CATALOGUE["fig-6.1c"], CATALOGUE["fig-6.1a"])
    file.write_text(CATALOGUE["fig-6.1c"].replace(seeds=3).to_toml())
    with pytest.raises(InputError, match=r"id='fig-6.1c': names two different scenarios"):
        select_scenarios(["fig-6.1c", str(file)])
