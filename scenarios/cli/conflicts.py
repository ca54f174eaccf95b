"""``conflicts``: the conflicts of a game."""

import math
from typing import Annotated

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.options import ConditionName, Robots, RunDigest, Seed, Source, Trust, resolve_run
from kswarms.scenarios.cli.printing import print_columns


def conflicts(
    source: Source = None,
    run: RunDigest = "",
    trust: Trust = False,
    condition: ConditionName = None,
    n: Robots = None,
    seed: Seed = None,
    robot: Annotated[int | None, typer.Option(help="Robot, from 0. [default: all]")] = None,
    begin: Annotated[
        float,
        typer.Option(
            "--from", show_default="start of learning", help="First instant (s of the measured game)."
        ),
    ] = -math.inf,
    end: Annotated[float, typer.Option("--to", show_default="the end", help="Last instant (s).")] = math.inf,
) -> None:
    """Play a game again and list its conflicts: robots, place, knowledge, action and reward.

    Example: kswarms conflicts fig-6.4b --n 6 --robot 3 --from 0
    """
    found = resolve_run(source, run, trust, condition, n, seed)
    if robot is not None and not 0 <= robot < found.n:
        raise InputError("robot", robot, f"must be in 0 to {found.n - 1}")
    if math.isnan(begin):
        raise InputError("from", begin, "must be a number of seconds")
    if not begin <= end:
        raise InputError("to", end, f"must be a number of seconds, at least {begin:g}")
    from kswarms.scenarios.watch.conflicts import HEADINGS, conflict_cells, conflicts_of

    rows = [
        conflict_cells(conflict, found.game.learning)
        for conflict in conflicts_of(found)
        if (robot is None or conflict.row["robot"] == robot)
        and begin <= conflict.row["start"] - found.game.learning <= end
    ]
    print_columns([HEADINGS, *rows], left=range(len(HEADINGS)))
