"""Editing of policy texts."""

from kswarms.agents.policies.editing import with_learning
from kswarms.agents.user_code.syntax import parse_call


def test_learning_is_changed_in_the_text_of_the_policy() -> None:
    text = with_learning("inter-learner(otherwise='fight')", "reward", delta=0.2)
    assert parse_call("policy", text).arguments == {"otherwise": "fight", "reward": "wlu(delta=0.2)"}
    text = with_learning(text, "reward", delta=0.02)
    assert parse_call("policy", text).arguments["reward"] == "wlu(delta=0.02)"
    text = with_learning(text, "rule", "greedy")
    assert parse_call("policy", text).arguments["rule"] == "greedy"
    assert with_learning(text, "reward", "individual").count("individual") == 1


def test_only_learners_are_changed() -> None:
    assert with_learning("mixed", "reward", delta=0.2) == "mixed"
    changed = with_learning("avoid+learner(reward='wlu(b=2.0)')", "reward", delta=0.2)
    assert changed == "avoid+learner(reward='wlu(b=2.0, delta=0.2)')"
