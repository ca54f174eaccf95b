"""A game described by numbers and texts, as `mesa.batch_run` passes them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from kswarms.agents.common.descriptions import parse_number
from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.spec import PolicyLike
from kswarms.agents.user_code.syntax import split_outside
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.game_model import GameModel
from kswarms.model.mesa_base import Rng, hide_seed


class ForagingModel(GameModel):
    """A game whose arguments are numbers and texts, so that `mesa.batch_run` can sweep each of them.

    Parameters
    ----------
    n : int
        Number of robots.
    policies : str or sequence
        Policy of each swarm: texts separated by commas, or a sequence whose elements are texts, classes,
        callables, or lists of these. Their number is the number of swarms.
    shares : str
        Proportions of the sizes of the swarms, for example ``7:6``; equal if empty.
    drives : str
        Drive of each swarm in state P as a fraction of the top speed, separated by commas; ``0.7/0.65`` also
        sets the drive in state A. Defaults if empty.
    seed, record, rng
        As in `kswarms.model.game_model.GameModel`.
    **kwargs
        Further fields of `kswarms.model.description.game.Game`, such as ``duration`` or ``layout``.

    Raises
    ------
    InputError
        If a value is not allowed.
    """

    @hide_seed
    def __init__(
        self,
        /,  # so that a field named self is reported as unknown
        n: int = 20,
        policies: str | Sequence[PolicyLike] = "avoid,attack",
        shares: str = "",
        drives: str = "",
        seed: float | str | None = None,
        record: str = "model",
        rng: Rng | None = None,
        **kwargs: Any,
    ) -> None:
        for name, text in (("shares", shares), ("drives", drives), ("record", record)):
            if not isinstance(text, str):
                raise InputError(name, text, "must be a text")
        if "swarms" in kwargs:
            raise InputError("swarms", kwargs["swarms"], "unknown field; use n, policies, shares and drives")
        super().__init__(Game(swarms=_swarms(n, policies, shares, drives), **kwargs), seed, record, rng)


def _swarms(n: int, policies: str | Sequence[PolicyLike], shares: str, drives: str) -> tuple[Swarm, ...]:
    if not isinstance(policies, Sequence) or not policies:
        raise InputError("policies", policies, "must be a text or a sequence, one policy per swarm")
    names = split_outside(policies, ",") if isinstance(policies, str) else policies
    try:
        parts = [int(part) for part in shares.split(":")] if shares else [1] * len(names)
    except ValueError:
        parts = []
    if len(parts) != len(names) or min(parts) < 1:
        raise InputError("shares", shares, f"must be {len(names)} whole numbers ≥ 1 separated by ':'")
    pairs = [drive.partition("/") for drive in drives.split(",")] if drives else [("", "", "")] * len(names)
    if len(pairs) != len(names):
        raise InputError("drives", drives, f"must be {len(names)} numbers separated by ','")
    if not isinstance(n, int | np.integer) or isinstance(n, bool) or n < len(names):
        raise InputError("n", n, f"must be a whole number ≥ {len(names)}, one robot for each swarm")
    swarms = []
    for name, size, (drive, _, drive_action) in zip(names, apportion(int(n), parts), pairs, strict=True):
        given = {"drive": drive, "drive_action": drive_action}
        swarms.append(
            Swarm(policy=name, size=size, **{key: parse_number(text) for key, text in given.items() if text})
        )
    return tuple(swarms)
