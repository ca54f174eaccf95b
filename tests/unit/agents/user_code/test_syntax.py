"""Parsing of names with arguments, and its errors."""

import keyword

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.rewards import REWARDS, WLU, Reward
from kswarms.agents.learning.selection_rules import RULES, PeriodicRandom, Rule
from kswarms.agents.user_code.syntax import Call, build, parse_call, split_outside

NUMBERS = st.integers() | st.floats(allow_nan=False, allow_infinity=False)
VALUES = st.none() | st.booleans() | NUMBERS | st.text()
ARGUMENTS = st.dictionaries(
    st.from_regex("[a-z_]{1,8}", fullmatch=True).filter(lambda name: name.isidentifier()),
    VALUES | st.dictionaries(st.integers(), VALUES, max_size=3),
    max_size=4,
)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ucb", Call("ucb", {})),
        (" ucb ( ) ", Call("ucb", {})),
        ("wlu(delta=0.145)", Call("wlu", {"delta": 0.145})),
        ("wlu(delta={1: 0.02, 3: 0.125}, b=-1)", Call("wlu", {"delta": {1: 0.02, 3: 0.125}, "b": -1})),
        (
            "learner(reward='wlu(delta=0.02)', rule=\"ucb\")",
            Call("learner", {"reward": "wlu(delta=0.02)", "rule": "ucb"}),
        ),
    ],
)
def test_valid_texts_are_parsed(text: str, expected: Call) -> None:
    assert parse_call("policy", text) == expected


@given(ARGUMENTS)
def test_a_printed_call_is_parsed_back(arguments: dict[str, object]) -> None:
    arguments = {name: value for name, value in arguments.items() if not keyword.iskeyword(name)}
    call = Call("name", arguments)
    assert parse_call("policy", str(call)) == call


@pytest.mark.parametrize(
    "text",
    [
        *[f"wlu{rest}" for rest in ("(", ")(", "(delta=0.1", "(delta=0.1))", "(0.1)", "(delta)", "(delta=)")],
        *[f"wlu(delta=0.1{rest}" for rest in (", delta=0.2)", ").of", ") + 1", ")(b=2)")],
        *[f"wlu({rest})" for rest in ("*[1]", "**{'delta': 1}", "\0")],
        *[f"wlu(delta={value})" for value in ("nan", "float('nan')", "1 + 1 + x", "__import__('os')")],
        *[f"wlu(delta={value})" for value in ("(x for x in [1])", "{[1]: 2}")],
        *[f"wlu(delta={value})" for value in ("(" * 1000 + "1" + ")" * 1000, "-" * 5000 + "1")],
    ],
)
def test_invalid_texts_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"must be name or name\(key=value, …\) with plain values") as caught:
        parse_call("reward", text)
    assert (caught.value.field, caught.value.value) == ("reward", text)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("value", [5, None, 0.5, ["wlu"], {"wlu": 1}])
def test_other_types_are_refused(value: object) -> None:
    with pytest.raises(InputError) as caught:
        build("reward", value, REWARDS, Reward)  # type: ignore[arg-type]
    assert caught.value.field == "reward"
    assert caught.value.value == value


def test_build() -> None:
    assert build("reward", "wlu(delta={1: 0.5}, b=2)", REWARDS, Reward) == WLU(delta={1: 0.5}, b=2.0)
    assert build("rule", "periodic-random(every=20)", RULES, Rule) == PeriodicRandom(every=20)


def test_errors_of_unknown_names_list_the_known_names() -> None:
    with pytest.raises(InputError) as caught:
        build("reward", "wlo(delta=0.1)", REWARDS, Reward)
    known = "wlu, individual, single-swarm, or a class as my_file.py:MyClass"
    assert str(caught.value) == f"reward='wlo': must be one of {known}"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("ucb(gamma=-1)", "rule.gamma=-1: must be greater than or equal to 0"),
        ("ucb(epsilon=1)", "rule.epsilon=1: unknown field; allowed: gamma"),
        ("discounted-ucb(discount=1.5)", "rule.discount=1.5: must be less than or equal to 1"),
        ("periodic-random(every=0)", "rule.every=0: must be greater than or equal to 1"),
    ],
)
def test_invalid_arguments_are_named_with_their_path(text: str, line: str) -> None:
    with pytest.raises(InputError) as caught:
        build("rule", text, RULES, Rule)
    assert str(caught.value) == line


def test_an_argument_named_self_is_unknown() -> None:
    with pytest.raises(InputError):
        build("rule", "ucb(self=1)", RULES, Rule)


@pytest.mark.parametrize(
    ("text", "separator", "expected"),
    [
        ("", ",", [""]),
        ("avoid, attack", ",", ["avoid", "attack"]),
        ("avoid,", ",", ["avoid", ""]),
        ("a+b", ",", ["a+b"]),
        ("x(a=1, b={1: 2, 3: 4}),y", ",", ["x(a=1, b={1: 2, 3: 4})", "y"]),
        ("x(a='b,c'),'d,e',f", ",", ["x(a='b,c')", "'d,e'", "f"]),
        ("learner(reward='wlu(b=1)')+avoid", "+", ["learner(reward='wlu(b=1)')", "avoid"]),
        ("x(a='(')+y", "+", ["x(a='(')", "y"]),
        ("""x(a="it's + so")+y""", "+", ["""x(a="it's + so")""", "y"]),
    ],
)
def test_split_outside_brackets_and_quotes(text: str, separator: str, expected: list[str]) -> None:
    assert split_outside(text, separator) == expected
