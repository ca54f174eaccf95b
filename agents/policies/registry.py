"""The policies that there are, and how a text names one: fixed, learning, learned, or a user's own."""

from collections.abc import Callable
from functools import partial
from typing import Any, Final, NamedTuple

from kswarms.agents.actions import AWAY, TOWARDS
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies import user_policy as own
from kswarms.agents.policies.fixed import FixedPolicy, RandomPolicy
from kswarms.agents.policies.interface import Policy, Setting
from kswarms.agents.policies.learner import Learner
from kswarms.agents.policies.saved import LearnedPolicy
from kswarms.agents.user_code.loading import blaming, is_reference
from kswarms.agents.user_code.syntax import parse_call, require_known, split_outside


def _fixed(setting: Setting, within: int, against: int) -> FixedPolicy:
    return FixedPolicy(setting.swarm, setting.first(within), setting.first(against))


class Kind(NamedTuple):
    """A kind of policy.

    Attributes
    ----------
    make : callable
        Called with a `Setting` and the arguments that the user wrote.
    arguments : tuple of str
        The arguments that a user may write.
    """

    make: Callable[..., Policy]
    arguments: tuple[str, ...] = ()


_LEARNING: Final = ("reward", "rule", "otherwise")

POLICIES: Final[dict[str, Kind]] = {
    "avoid": Kind(partial(_fixed, within=AWAY, against=AWAY)),
    "attack": Kind(partial(_fixed, within=AWAY, against=TOWARDS)),
    "aggressive": Kind(partial(_fixed, within=TOWARDS, against=TOWARDS)),
    "random": Kind(RandomPolicy),
    "learner": Kind(Learner, ("about", *_LEARNING)),
    "inter-learner": Kind(partial(Learner, about="inter"), _LEARNING),
    "intra-learner": Kind(partial(Learner, about="intra"), _LEARNING),
    "learned": Kind(LearnedPolicy, ("file",)),
}
"""Every kind of policy by its name."""

ALIASES: Final = {"mixed": "avoid+aggressive"}
"""Names that stand for several policies."""


def make_policy(text: str, setting: Setting) -> Policy:
    """Build the policy of one robot.

    Parameters
    ----------
    text : str
        One of `POLICIES`, with arguments where it takes any; the name of an action, which is then always
        taken; or a class of a user's own as ``path/to/my_file.py:MyPolicy``, with its arguments
        (`kswarms.agents.user_code.loading`).
    setting : Setting
        What it is built for.

    Raises
    ------
    InputError
        If there is no such policy, or it cannot be built so.
    """
    for action in setting.actions:
        if action.name == text:
            return FixedPolicy(setting.swarm, action, action)
    call = parse_call("policy", text)
    if call.name in (action.name for action in setting.actions):
        raise InputError("policy", text, "an action takes no arguments")
    if call.name in ALIASES:
        raise InputError("policy", text, f"stands for {ALIASES[call.name]}, and takes no arguments")
    if is_reference(call.name):
        kind = Kind(own.policy_class(call))
    elif call.name in POLICIES:
        kind = POLICIES[call.name]
        require_known("policy", call, kind.arguments)
    else:
        known = ", ".join([*POLICIES, *ALIASES, *(action.name for action in setting.actions)])
        raise InputError(
            *("policy", call.name),
            f"must be one of {known}, or several joined by '+', or a class as my_file.py:MyPolicy",
        )
    with blaming("policy", call.name, "its constructor"):
        try:
            return kind.make(setting, **call.arguments)
        except InputError as error:
            raise InputError(f"policy.{error.field}", error.value, error.allowed) from None


def deal(policy: str, size: int) -> list[str]:
    """Deal the policies of a swarm out to its robots.

    Parameters
    ----------
    policy : str
        A policy for all, or several joined by ``+``: equal shares in that order, the robots
        that are left over going to the first. ``mixed`` is ``avoid+aggressive``, among others too.
    size : int
        Robots in the swarm.

    Returns
    -------
    list of str, length `size`
        Each robot's policy.

    Examples
    --------
    >>> deal("mixed", 5)
    ['avoid', 'avoid', 'avoid', 'aggressive', 'aggressive']
    >>> deal("attack+mixed", 3)
    ['attack', 'avoid', 'aggressive']
    """
    names = parts(policy)
    share, extra = divmod(size, len(names))
    return [name for k, name in enumerate(names) for _ in range(share + (k < extra))]


def parts(policy: str) -> list[str]:
    """Return the policies that are dealt out under one name."""
    return [
        name for text in split_outside(policy, "+") for name in split_outside(ALIASES.get(text, text), "+")
    ]


def describe(policy: Policy) -> list[dict[str, Any]]:
    """Return what a policy has learned, as `Learner.snapshot` does; nothing if it has no such method."""
    snapshot: Callable[[], list[dict[str, Any]]] | None = getattr(policy, "snapshot", None)
    return [] if snapshot is None else snapshot()
