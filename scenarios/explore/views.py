"""The game as plain data for the browser: the arena's scene and frames, the curves' options."""

from collections.abc import Callable, Sequence
from typing import Any, Final

from analysis.arena import SWARM_COLOURS
from scenarios.explore.player import Player, Sample
from scenarios.explore.robot import look_into

Json = dict[str, Any]


def colour_of(swarm: int) -> str:
    """Return the colour of a swarm, counted from 0."""
    return SWARM_COLOURS[swarm % len(SWARM_COLOURS)]


def scene_of(player: Player) -> Json:
    """Return what of the picture does not change during a game; lengths in metres, angles in radians."""
    model, game = player.model, player.game
    arena, body, parameters = model.arena, game.body_preset, game.parameters
    return {
        "half": arena.half,
        "stations": arena.stations.tolist(),
        "bases": arena.bases.tolist(),
        "stationRadius": arena.station_radius,
        "baseRadius": arena.base_radius,
        "radius": body.radius,
        "conflictReach": body.radius + body.sensing_scale * parameters.conflict_distance,
        "frontHalfAngle": parameters.front_half_angle,
        "swarm": list(model.fleet.swarm),
        "colours": [colour_of(k) for k in range(len(game.swarms))],
    }


def frame_of(player: Player, number: int, chosen: int, sectors: bool, sensors: bool) -> Json:
    """Return what changes: positions to 0.1 mm, headings to 0.001 rad."""
    picture = player.picture()
    ring = [list(sensor) for sensor in look_into(player.model, chosen).sensors] if sensors else None
    return {
        "number": number,
        "time": round(picture.time, 3),
        "ended": player.ended,
        "pucks": picture.pucks,
        "supply": player.model.supply,
        "x": picture.positions[:, 0].round(4).tolist(),
        "y": picture.positions[:, 1].round(4).tolist(),
        "heading": picture.heading.round(3).tolist(),
        "action": picture.in_action.astype(int).tolist(),
        "puck": picture.carrying.astype(int).tolist(),
        "chosen": chosen,
        "sectors": sectors,
        "sensors": ring,
    }


_DASHES: Final = ("solid", "dashed", "dotted")


def curves_of(history: Sequence[Sample]) -> dict[str, Json]:
    """Return, by the heading of each chart, its option for ECharts."""
    swarms = range(len(history[0].pucks))

    def each(of: Callable[[Sample, int], float]) -> list[Json]:
        return [_line(f"S{k + 1}", k, history, lambda sample, k=k: of(sample, k)) for k in swarms]

    shares: list[Json] = []
    for k in swarms:
        shares.append(_line(f"S{k + 1} inter", k, history, lambda sample, k=k: sample.inter[k]))
        shares.append(_line(f"S{k + 1} intra", k, history, lambda sample, k=k: sample.intra[k], "dotted"))
    charts = {
        "Pucks": _chart(each(lambda sample, k: sample.pucks[k])),
        "SUD (pucks)": _chart(each(lambda sample, k: sample.sud[k])),
        "Share of time in conflict": _chart(shares, most=1.0),
    }
    pairs = history[-1].fights
    if pairs:
        learned = [
            _line(
                f"S{own} against S{other}" if own != other else f"S{own} within",
                own - 1,
                history,
                lambda sample, pair=(own, other): sample.fights[pair],
                _DASHES[number % len(_DASHES)],
            )
            for number, (own, other) in enumerate(pairs)
        ]
        charts["Share of robots whose best action is to fight"] = _chart(learned, most=1.0)
    return charts


def _line(
    name: str, swarm: int, history: Sequence[Sample], value: Callable[[Sample], float], dash: str = "solid"
) -> Json:
    return {
        "name": name,
        "type": "line",
        "symbol": "none",
        "animation": False,
        "color": colour_of(swarm),
        "lineStyle": {"type": dash, "width": 2},
        "data": [[round(sample.time, 1), round(value(sample), 4)] for sample in history],
    }


def _chart(lines: list[Json], most: float | None = None) -> Json:
    return {
        "animation": False,
        "grid": {"left": 48, "right": 16, "top": 34, "bottom": 36},
        "legend": {"top": 0, "itemWidth": 28, "type": "scroll"},
        "tooltip": {"trigger": "axis"},
        "xAxis": {"type": "value", "name": "t (s)", "nameLocation": "middle", "nameGap": 22}
        | {"min": "dataMin", "max": "dataMax"},
        "yAxis": {"type": "value"} | ({"max": most, "min": 0} if most else {}),
        "series": lines,
    }
