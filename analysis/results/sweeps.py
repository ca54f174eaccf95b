"""Tables of results from games in memory: rows of `mesa.batch_run`, samples of a DataCollector, models."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final, Protocol

import pandas as pd

from kswarms.agents.common.columns import column_names
from kswarms.agents.common.errors import InputError
from kswarms.analysis.results.tables import check_frame

_KEY_COLUMNS: Final = ("run", "scenario", "condition", "n", "seed")
_GAME_COLUMNS: Final = {*_KEY_COLUMNS, "swarm", "duration", "ended"}
_SWARM_COLUMNS: Final = [name for name in column_names("runs") if name not in _GAME_COLUMNS]
_MESA_COLUMNS: Final = {"RunId", "iteration", "Step", "AgentID"}
_MODEL_REPORTERS: Final = {"time", "game_time", "ended", "run_seed"}
_ENDS: Final = ("time", "pucks", "cap")
_AGENT_REPORTERS: Final = {"swarm", "state", "puck", "x", "y", "heading"}
_NOT_PARAMETERS: Final = {*_KEY_COLUMNS, *_MESA_COLUMNS, *_MODEL_REPORTERS, *_AGENT_REPORTERS}


class PlayedModel(Protocol):
    """A model at the end of its game, such as `kswarms.model.foraging.ForagingModel`."""

    seed: int
    game: Any
    """Description of the game, with its ``duration`` (s)."""

    def results(self) -> list[dict[str, Any]]:
        """Return one row per swarm, with the columns of the table ``runs`` from ``swarm`` to the last."""

    def policy_results(self) -> list[dict[str, Any]]:
        """Return rows of the table ``policies`` from ``swarm`` to the last column; [] without learners."""


Sweep = pd.DataFrame | Iterable[Mapping[str, Any]] | PlayedModel | Iterable[PlayedModel]
"""Rows of `mesa.batch_run`, samples of one game, a model, or several models."""


def tables_of_sweep(
    source: Sweep, scenario: str, by: Sequence[str] | None
) -> tuple[pd.DataFrame, pd.DataFrame | None]:
    """Return the tables ``runs`` and ``policies`` of a sweep, as `read_results` describes them."""
    models: list[Any] = []
    games: dict[object, dict[str, Any]] = {}
    for item in _items(source):
        if isinstance(item, Mapping):
            games[item.get("RunId", 0)] = dict(item)  # the last row of a game replaces earlier rows
        else:
            games[len(models)] = _end_of_game(item)
            models.append(item)
    if not games:
        raise InputError("source", "no games", "must hold at least one game")
    conditions = _conditions(list(games.values()), by)
    runs, policies = [], []
    for index, (run, game) in enumerate(games.items()):
        swarms = _swarms(game)
        n = game["n"] if "n" in game else sum(swarm["size"] for swarm in swarms)
        values = (str(run), scenario, conditions[index], n, game.get("run_seed", 0))
        key = dict(zip(_KEY_COLUMNS, values, strict=True))
        runs += [key | swarm for swarm in swarms]
        policies += [key | row for row in (models[index].policy_results() if models else ())]
    if pd.DataFrame(runs, columns=["condition", "n", "seed", "swarm"]).astype(str).duplicated().any():
        raise InputError(
            "by", by, "must distinguish all games: two games have the same condition, N and seed"
        )
    table = _make_table(runs, "runs")
    return table, _make_table(policies, "policies") if policies else None


def _items(source: Any) -> list[Any]:
    """Return rows of games or models; `InputError` if `source` is anything else."""
    if isinstance(source, pd.DataFrame):
        return source.to_dict("records")
    items = list(source) if isinstance(source, Iterable) and not isinstance(source, Mapping) else [source]
    for item in items:
        if not isinstance(item, Mapping) and not hasattr(item, "policy_results"):
            rule = "must be a directory, rows of mesa.batch_run, or models whose games have ended"
            raise InputError("source", type(item).__name__, rule)
    return items


def _end_of_game(model: PlayedModel) -> dict[str, Any]:
    """Return the outcome of a model as a row of `mesa.batch_run`."""
    swarms = model.results()
    game = {f"{name}_{swarm['swarm']}": swarm[name] for swarm in swarms for name in _SWARM_COLUMNS}
    game |= {"game_time": swarms[0]["duration"], "ended": swarms[0]["ended"], "run_seed": model.seed}
    return game | {"policies": ",".join(swarm["policy"] for swarm in swarms), "duration": model.game.duration}


def _swarms(game: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the values of each swarm at the end of a game; ``duration`` is the played time."""
    if not {"game_time", "ended", "pucks_1"} <= game.keys():
        raise InputError("source", sorted(map(str, game)), 'must have model reporters (record="model")')
    if game["ended"] not in _ENDS:
        rule = f"must be one of {', '.join(_ENDS)}: a game was stopped before its end"
        raise InputError("ended", game["ended"], rule)
    of_game = {"duration": game["game_time"], "ended": game["ended"]}
    swarms: list[dict[str, Any]] = []
    # A data frame has NaN for swarms that this game lacks.
    while pd.notna(game.get(f"pucks_{len(swarms) + 1}")):
        k = len(swarms) + 1
        absent = [f"{name}_{k}" for name in _SWARM_COLUMNS if f"{name}_{k}" not in game]
        if absent:
            raise InputError("source", absent, "must have these model reporters too")
        swarms.append({"swarm": k} | {name: game[f"{name}_{k}"] for name in _SWARM_COLUMNS} | of_game)
    return swarms


def _conditions(games: Sequence[Mapping[str, Any]], by: Sequence[str] | None) -> list[str]:
    """Return the condition of each game, such as ``side=2.0``; `by` defaults to the varying parameters."""
    if by is None:
        reported = {f"{name}_{k}" for name in (*_SWARM_COLUMNS, "share_a", "share_p") for k in range(1, 100)}
        candidates = [name for name in games[0] if name not in _NOT_PARAMETERS | reported]
        by = [name for name in candidates if len({_text(game.get(name)) for game in games}) > 1]
    return [", ".join(f"{name}={_text(game.get(name))}" for name in by) for game in games]


def _text(value: Any) -> str:
    """Return a parameter as text: the name of a class or function, the elements of a list."""
    if isinstance(value, list | tuple):
        return ",".join(map(_text, value))
    return " ".join(str(getattr(value, "__name__", value)).split())


def _make_table(rows: Sequence[Mapping[str, Any]], table: str) -> pd.DataFrame:
    return check_frame(pd.DataFrame(rows, columns=list(column_names(table))), table)
