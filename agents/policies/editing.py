"""Changes of the texts of policies."""

from typing import Any

from kswarms.agents.policies.spec import parse_policies
from kswarms.agents.user_code.syntax import Call


def with_learning(policy: str, part: str, text: str | None = None, /, **arguments: Any) -> str:
    """Return one or several policies with the reward or the rule (`part`) of the learners changed.

    `text` is the new reward or rule. By default the current one is kept, with `arguments` changed.

    Examples
    --------
    >>> with_learning("avoid+inter-learner(rule='greedy')", "reward", delta=0.2)
    "avoid+inter-learner(rule='greedy', reward='wlu(delta=0.2)')"
    """
    specs = [*parse_policies(policy)]
    for k, spec in enumerate(specs):
        if (call := spec.learns_by(part)) is not None:
            changed = str(Call(call.name, call.arguments | arguments)) if text is None else text
            specs[k] = spec.with_arguments(**{part: changed})
    return policy if specs == [*parse_policies(policy)] else "+".join(map(str, specs))
