"""The controls of the page, without a browser: each changes the game and reports invalid values."""

from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("solara", reason="needs the extra `explore`")

import ipyvuetify  # comes with solara

from kswarms.agents.learning.selection_rules import GAMMA
from tests.helpers.rendered_page import RenderedPage, unfold, wait


def test_learning_can_be_skipped_and_its_controls_change_it(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.4b")
    session = shown.session
    shown.write("Time to learn", 100.0)
    assert session.player.time == -100.0
    assert "Share of learners" in shown.texts()
    shown.click("Skip learning")
    wait(lambda: shown.arena().frame["time"] == 0.0)
    wait(lambda: "Skip learning" not in shown.texts())
    shown.find(ipyvuetify.Slider, "Δ = 0.125").v_model = 0.2
    shown.find(ipyvuetify.Slider, f"γ = {GAMMA:g}").v_model = 0.5
    policy = "inter-learner(reward='wlu(delta=0.2)', rule='ucb(gamma=0.5)')"
    assert session.player.game.swarms[1].policy == policy
    shown.find(ipyvuetify.Select, "Reward").v_model = "individual"
    shown.find(ipyvuetify.Select, "Selection rule").v_model = "greedy"
    assert session.player.game.swarms[1].policy == "inter-learner(reward='individual', rule='greedy')"


def test_a_value_between_two_steps_of_a_slider_is_kept(
    show: Callable[[str], RenderedPage], tmp_path: Path
) -> None:
    (tmp_path / "off.toml").write_text(
        """
        id = "off"
        title = "Between the steps of the sliders"
        densities = [20]
        [[conditions]]
        learning = 10
        parameters = "fitted, friction=0.1234"
        swarms = [{ policy = "attack", drive = 0.63 }, { policy = "inter-learner(rule='ucb(gamma=0.1211)')" }]
        """
    )
    shown = show(str(tmp_path / "off.toml"))
    described = shown.session.form
    # Vuetify reports these values when it has drawn the sliders.
    for label, nearest in (("Drive in P 0.63", 0.65), ("γ", 0.12), ("Friction", 0.12)):
        shown.find(ipyvuetify.Slider, label).v_model = nearest
    assert shown.session.form == described
    shown.find(ipyvuetify.Slider, "γ").v_model = 0.2
    assert shown.session.form.swarms[1]["policy"] == "inter-learner(rule='ucb(gamma=0.2)')"


def test_every_control_changes_the_game(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.10a")
    session = shown.session
    shown.find(ipyvuetify.Select, "Condition").v_model = list(session.conditions)[1]
    assert session.condition == list(session.conditions)[1]
    shown.find(ipyvuetify.Slider, "Robots N").v_model = 8
    shown.write("Seed", 5)
    shown.find(ipyvuetify.Combobox, "S1: policy").v_model = "random"
    shown.write("Share of the robots", 3)
    shown.find(ipyvuetify.Slider, "Drive in P").v_model = 0.7
    shown.find(ipyvuetify.Slider, "Drive in A").v_model = 0.5
    game = session.player.game
    assert (game.size, session.player.seed) == (8, 5)
    assert game.swarms[0].model_dump() == {"policy": "random", "size": 6, "drive": 0.7, "drive_action": 0.5}
    shown.click("Add a swarm")
    assert len(session.player.game.swarms) == 3
    shown.click("Remove S3")
    player = session.player
    shown.find(ipyvuetify.TextField, "Seed").fire_event("focusout", {})
    assert session.player is player  # nothing was changed
    shown.find(ipyvuetify.Combobox, "Scenario").v_model = "fig-6.1a"
    assert session.conditions.keys() == {""}
    assert session.player.game.swarms[1].policy == "avoid"
    shown.find(ipyvuetify.Combobox, "Scenario").v_model = None
    assert "id='': must be a scenario" in shown.texts()


def test_the_world_can_be_changed_by_sliders_and_text(show: Callable[[str], RenderedPage]) -> None:
    shown = show("fig-6.1c")
    session = shown.session
    unfold(shown, "World")
    shown.find(ipyvuetify.Slider, "Friction").v_model = 0.5
    shown.find(ipyvuetify.Slider, "Fight (s)").v_model = 2.0
    assert session.form.fields["parameters"] == "fitted, fight_duration=2.0, friction=0.5"
    assert session.player.game.parameters.friction == 0.5
    shown.find(ipyvuetify.Select, "Layout").v_model = "nearer-station"
    shown.write("Side of the arena", 3.0)
    shown.write("Length of the game", 20.0)
    shown.write("Pucks that end the game", 3)
    shown.write("Pucks at each station", 9)
    game = session.player.game
    assert (game.layout, game.side, game.duration, game.puck_limit) == ("nearer-station", 3.0, 20.0, 3)
    assert game.supply == 9
    shown.write("Parameters", "fited")
    assert "parameters='fited': must begin with one of fitted, argos" in shown.texts()
    assert session.player.game == game
    assert "Friction" not in shown.texts()
    shown.write("Parameters", "argos")
    shown.find(ipyvuetify.Select, "Body").v_model = "krembot"
    assert "must begin" not in shown.texts()
    assert session.player.game.body.name == "krembot"
