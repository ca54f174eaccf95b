"""The same game from plain values and names, as `mesa.batch_run` passes them."""

import numpy as np

from kswarms.agents.common.errors import InputError
from kswarms.agents.user_code.syntax import split_outside
from kswarms.model.description.game import Game, Swarm, apportion
from kswarms.model.description.parameters import parse_parameters
from kswarms.model.game_model import GameModel


class ForagingModel(GameModel):
    """A game whose every argument is a number or a name, so that `mesa.batch_run` sweeps it unchanged.

    Parameters
    ----------
    n : int
        Robots in all.
    policies : str
        Policy of each swarm, separated by commas: as many as there are swarms.
    shares : str
        Proportions of the swarms' sizes, like ``7:6``; equal if empty.
    drives : str
        Drive of each swarm in state P as a part of the top speed, separated by commas; ``0.7/0.65`` gives
        that of state A too, which is else 0.6; 0.6 for all if empty.
    layout, body : str
        As in `kswarms.model.description.game.Game`.
    parameters : str
        As in `kswarms.model.description.parameters.parse_parameters`.
    duration, learning, side : float
        As in `kswarms.model.description.game.Game` (s, s, m).
    puck_limit, supply : int
        As in `kswarms.model.description.game.Game`; 0 for none.
    seed, record, sample_period
        As in `kswarms.model.game_model.GameModel`.

    Raises
    ------
    InputError
        If a value is not allowed.
    """

    def __init__(
        self,
        n: int = 20,
        policies: str = "avoid,attack",
        shares: str = "",
        drives: str = "",
        layout: str = "symmetric",
        body: str = "krembot-sim",
        parameters: str = "fitted",
        duration: float = 600.0,
        side: float = 2.0,
        puck_limit: int = 0,
        supply: int = 0,
        learning: float = 0.0,
        seed: int = 0,
        record: str = "model",
        sample_period: float = 10.0,
    ) -> None:
        for field, text in (
            *(("policies", policies), ("shares", shares), ("drives", drives)),
            *(("parameters", parameters), ("record", record)),
        ):
            if not isinstance(text, str):
                raise InputError(field, text, "must be a text")
        game = Game(
            swarms=_swarms(n, policies, shares, drives),
            layout=layout,
            body=body,
            parameters=parse_parameters(parameters),
            duration=duration,
            side=side,
            puck_limit=puck_limit or None,
            supply=supply or None,
            learning=learning,
        )
        super().__init__(game, seed=seed, record=record, sample_period=sample_period)


def _swarms(n: int, policies: str, shares: str, drives: str) -> tuple[Swarm, ...]:
    names = split_outside(policies, ",")
    try:
        parts = [int(part) for part in shares.split(":")] if shares else [1] * len(names)
    except ValueError:
        parts = []
    if len(parts) != len(names) or min(parts) < 1:
        raise InputError("shares", shares, f"must be {len(names)} whole numbers ≥ 1 separated by ':'")
    pairs = (
        [drive.partition("/") for drive in drives.split(",")] if drives else [("0.6", "", "")] * len(names)
    )
    if len(pairs) != len(names):
        raise InputError("drives", drives, f"must be {len(names)} numbers separated by ','")
    if not isinstance(n, int | np.integer) or n < len(names):
        raise InputError("n", n, f"must be a whole number ≥ {len(names)}, one robot for each swarm")
    sizes = apportion(int(n), parts)
    return tuple(
        Swarm(policy=name, size=size, drive=drive, drive_action=drive_action or 0.6)
        for name, size, (drive, _, drive_action) in zip(names, sizes, pairs, strict=True)
    )
