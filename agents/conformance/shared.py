"""What rewards and rules have in common: they are frozen, checked descriptions."""

import copy
import pickle
from collections.abc import Callable
from typing import Any

from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError

Make = Callable[..., Any]
"""A class, or what calls it with arguments: ``functools.partial(MyReward, weight=2.0)``."""
Use = Callable[[Any], Any]
"""Does with a description what a game does, and returns what came of it."""


def check_copies_are_alike(make: Make, use: Use) -> None:
    """Check that two of the same arguments, copies of it and pickled ones are equal and do the same."""
    one = make()
    twins = {
        "another": make(),
        "a copy": copy.copy(one),
        "a deep copy": copy.deepcopy(one),
        "a pickled one": pickle.loads(pickle.dumps(one)),
        "one built from its fields": one.replace(),
    }
    for what, twin in twins.items():
        assert twin == one, f"{what} is not equal"
        assert hash(twin) == hash(one), f"{what} has another hash"
        assert use(twin) == use(one), f"{what} does something else"


def check_it_is_frozen(make: Make, use: Use) -> None:
    """Check that neither use nor an assignment changes it."""
    one: Checked = make()
    before = repr(one), dict(vars(one))
    use(one)
    assert (repr(one), dict(vars(one))) == before, "it is changed by its use"
    for field in type(one).model_fields:
        try:
            setattr(one, field, getattr(one, field))
        except ValueError:
            continue
        raise AssertionError(f"{field} can be assigned to")


def check_it_knows_no_other_arguments(make: Make) -> None:
    """Check that an argument that it does not have is refused."""
    try:
        make(no_such_argument=1)
    except InputError:
        return
    raise AssertionError("it takes an argument that it does not have")
