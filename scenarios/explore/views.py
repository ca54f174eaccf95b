"""The game as JSON for the browser: the scene and the frames of the arena, and the charts."""

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Any, Final

from kswarms.agents.theory.times import share_of_time
from kswarms.analysis.colours import swarm_colour
from kswarms.scenarios.watch.player import Player, Sample

Json = dict[str, Any]


def scene_of(player: Player) -> Json:
    """Return the constant part of the drawing; lengths in metres, angles in radians."""
    model, game = player.model, player.game
    arena, body, parameters = model.arena, game.body, game.parameters
    return {
        "half": arena.half,
        "stations": arena.stations.tolist(),
        "bases": arena.bases.tolist(),
        "stationRadius": arena.station_radius,
        "baseRadius": arena.base_radius,
        "radius": body.radius,
        "conflictReach": body.radius + body.sensing_scale * parameters.conflict_distance,
        "frontHalfAngle": parameters.front_half_angle,
        "colours": [swarm_colour(k + 1) for k in range(len(game.swarms))],
    }


def frame_of(player: Player, number: int, selected: int, sectors: bool, sensors: bool) -> Json:
    """Return the changing part of the drawing: positions to 0.1 mm, headings to 0.001 rad."""
    now = player.snapshot()
    view = player.view_robot(selected)
    return {
        "number": number,
        "time": round(now.time, 3),
        "ended": player.ended,
        "pucks": now.pucks,
        "supply": player.model.supply,
        "robots": now.robots,
        "swarm": now.swarm.tolist(),
        "x": now.positions[:, 0].round(4).tolist(),
        "y": now.positions[:, 1].round(4).tolist(),
        "heading": now.heading.round(3).tolist(),
        "action": now.in_action.astype(int).tolist(),
        "puck": now.carrying.astype(int).tolist(),
        "selected": selected,
        "sectors": sectors,
        "sensors": [list(sensor) for sensor in view.sensors] if view and sensors else None,
    }


_DASHES: Final = ("solid", "dashed", "dotted")
_SHORTEST_AXIS: Final = 10.0
"""Minimum length of the time axis of a chart (s)."""


def charts_of(history: Sequence[Sample]) -> dict[str, Json]:
    """Return the options for ECharts of each chart, by heading.

    Once the measured game has begun, charts omit the learning phase, except the chart of learned actions.
    """
    full_history = history
    if history[-1].time > 0:
        history = [sample for sample in history if sample.time >= 0]
    times = [sample.time for sample in history]
    began, now = times[0], times[-1]

    def lines(of: Callable[[Json], float], suffix: str = "", dash: str = "solid") -> list[Json]:
        return [
            _line(f"S{k + 1}{suffix}", k, times, [of(sample.swarms[k]) for sample in history], dash)
            for k in range(len(history[0].swarms))
        ]

    inter = lines(lambda row: _share_of_time(row, "t_a_inter"), " inter")
    intra = lines(lambda row: _share_of_time(row, "t_a_intra"), " intra", "dotted")
    charts = {
        "Pucks": _chart(lines(itemgetter("pucks")), began, now),
        "SUD (pucks)": _chart(lines(itemgetter("sud")), began, now),
        "Share of time in conflict": _chart(inter + intra, began, now, most=1.0),
    }
    learned = []
    for number, (own, other) in enumerate(full_history[0].fights):
        known = [
            sample for sample in full_history if (own, other) in sample.fights
        ]  # a pair ends when its robots leave
        learned.append(
            _line(
                f"S{own} against S{other}" if own != other else f"S{own} within",
                own - 1,
                [sample.time for sample in known],
                [sample.fights[own, other] for sample in known],
                _DASHES[number % len(_DASHES)],
            )
        )
    if learned:
        heading = "Share of learners whose best action is to fight"
        charts[heading] = _chart(learned, full_history[0].time, now, most=1.0)
    return charts


def _share_of_time(row: Json, name: str) -> float:
    return float(share_of_time(row[name], row["t_a_intra"] + row["t_a_inter"], row["t_p"]))


def _line(name: str, swarm: int, times: Sequence[float], values: Sequence[float], dash: str) -> Json:
    return {
        "name": name,
        "type": "line",
        "symbol": "none",
        "animation": False,
        "color": swarm_colour(swarm + 1),
        "lineStyle": {"type": dash, "width": 2},
        "data": [[round(time, 1), round(value, 4)] for time, value in zip(times, values, strict=True)],
    }


def _chart(lines: list[Json], began: float, now: float, most: float | None = None) -> Json:
    return {
        "animation": False,
        "grid": {"left": 48, "right": 28, "top": 34, "bottom": 36},
        "legend": {"top": 0, "itemWidth": 28, "type": "scroll"},
        "tooltip": {"trigger": "axis"},
        "xAxis": {
            "type": "value",
            "name": "t (s)",
            "nameLocation": "middle",
            "nameGap": 22,
            "min": began,
            "max": max(now, began + _SHORTEST_AXIS),  # ECharts ignores the limits of an empty axis
            "axisLabel": {"hideOverlap": True},
        },
        # Numbers of pucks are integers.
        "yAxis": {"type": "value"} | ({"max": most, "min": 0} if most else {"minInterval": 1}),
        "series": lines,
    }
