"""Editing of policy texts."""

from typing import Any

from kswarms.agents.policies.spec import parse_policies
from kswarms.agents.user_code.syntax import Call


def with_learning(policy: str, part: str, text: str | None = None, /, **arguments: Any) -> str:
    """Return a policy text in which the ``reward`` or ``rule`` (`part`) of all learners is changed.

    `text` is the new reward or rule. Without it, the current one is kept and its `arguments` are changed.

    Examples
    --------
    >>> with_learning("avoid+inter-learner(rule='greedy')", "reward", delta=0.2)
    "avoid+inter-learner(rule='greedy', reward='wlu(delta=0.2)')"
    """
    specs = [*parse_policies(policy)]
    for k, spec in enumerate(specs):
        if (call := spec.learner_part(part)) is not None:
            changed = str(Call(call.name, call.arguments | arguments)) if text is None else text
            specs[k] = spec.with_arguments(**{part: changed})
    return policy if specs == [*parse_policies(policy)] else "+".join(map(str, specs))
