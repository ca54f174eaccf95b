"""Checks that rewards and selection rules share: both are subclasses of `FrozenModel`."""

import copy
import pickle
from collections.abc import Callable
from typing import Any

from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError

Make = Callable[..., Any]
"""A class, or a callable that builds one: ``functools.partial(MyReward, weight=2.0)``."""
Use = Callable[[Any], Any]
"""Uses the object as a game does, and returns the results."""


class CheckError(AssertionError):
    """A check failed. Unlike ``assert``, it is raised in optimized mode too."""


def require(condition: bool, message: str) -> None:
    """Raise a `CheckError` unless a condition holds."""
    if not condition:
        raise CheckError(message)


def check_copies(make: Make, use: Use) -> None:
    """Check that copies and pickled copies are equal and give the same results."""
    one = make()
    twins = {
        "another": make(),
        "a copy": copy.copy(one),
        "a deep copy": copy.deepcopy(one),
        "a pickled copy": pickle.loads(pickle.dumps(one)),
        "one built from its fields": one.replace(),
    }
    for name, twin in twins.items():
        require(twin == one, f"{name} is not equal")
        require(hash(twin) == hash(one), f"{name} has another hash")
        require(use(twin) == use(one), f"{name} gives other results")


def check_frozen(make: Make, use: Use) -> None:
    """Check that neither use nor assignment changes the object."""
    one: FrozenModel = make()
    before = repr(one), dict(vars(one))
    use(one)
    require((repr(one), dict(vars(one))) == before, "its use changes it")
    for field in type(one).model_fields:
        try:
            setattr(one, field, getattr(one, field))
        except ValueError:
            continue
        raise CheckError(f"{field} can be assigned to")


def check_unknown_arguments(make: Make) -> None:
    """Check that an unknown argument raises an `InputError`."""
    try:
        make(no_such_argument=1)
    except InputError:
        return
    raise CheckError("it accepts an unknown argument")
