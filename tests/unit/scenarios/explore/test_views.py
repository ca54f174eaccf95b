"""The scene, the frames and the charts of the page."""

import pytest

from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.explore.views import charts_of, frame_of, scene_of


def test_the_browser_gets_json() -> None:
    player = Session("fig-6.1c").player
    scene = scene_of(player)
    assert len(scene["bases"]) == len(scene["colours"]) == 2
    frame = frame_of(player, 3, 5, sectors=False, sensors=True)
    assert (frame["number"], frame["time"], frame["pucks"], frame["supply"]) == (3, 0.0, (0, 0), [-1, -1])
    assert (frame["swarm"], frame["robots"]) == ([0] * 10 + [1] * 10, tuple(range(20)))
    assert len(frame["sensors"]) == 8
    positions = player.snapshot().positions
    assert frame["x"] == pytest.approx(positions[:, 0], abs=1e-4)
    assert frame_of(player, 3, 5, sectors=True, sensors=False)["sensors"] is None
    charts = charts_of(player.history)
    assert [len(chart["series"]) for chart in charts.values()] == [2, 2, 4]


def test_the_chart_of_learning_has_a_line_for_each_pair_of_swarms() -> None:
    charts = charts_of(Session("fig-6.8").player.history)
    learned = charts["Share of learners whose best action is to fight"]
    assert [line["name"] for line in learned["series"]] == ["S2 against S1", "S2 within"]
    assert learned["yAxis"]["max"] == 1.0


def test_after_the_learning_phase_only_the_chart_of_learning_shows_it() -> None:
    session = Session("fig-6.4b")
    session.change(n=6, learning=20.0)

    def first_times() -> dict[str, float]:
        charts = charts_of(session.player.history)
        return {name: chart["series"][0]["data"][0][0] for name, chart in charts.items()}

    assert set(first_times().values()) == {-20.0}
    session.player.seek(30.0)
    first = first_times()
    assert first.pop("Share of learners whose best action is to fight") == -20.0
    assert set(first.values()) == {0.0}


def test_an_empty_chart_starts_where_its_game_starts() -> None:
    session = Session("fig-6.4b")

    def axes() -> set[tuple[float, float]]:
        axes = (chart["xAxis"] for chart in charts_of(session.player.history).values())
        return {(axis["min"], axis["max"]) for axis in axes}

    assert axes() == {(-3000.0, -2990.0)}
    session.player.advance(60.0)
    assert axes() == {(-3000.0, -2940.0)}
