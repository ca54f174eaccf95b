"""Games in which robots cover two thirds of the arena and shove each other reach their end."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from kswarms.model.description.game import Game
from kswarms.model.game_model import GameModel
from tests.games import check_times_and_pucks, make_game
from tests.reference.states import crowded_games

# The relaxation of its 98th period needs more than 200 searches for close pairs, but few passes for each.
SHOVES = make_game(
    "mixed",
    size=140,
    body="krembot",
    side=0.845092579204801,
    learning=9.628974993618757,
    duration=1.0,
    parameters="argos, conflict_distance=0.5, front_half_angle=1.09, flight_duration=10, fight_duration=10, "
    "turning_rate=2.96, leg_mean=100, wander_turn=1.5, wall_half_angle=0.7, friction=1, push_share=1, "
    "clearance=0, station_radius=0.059156480544336074, base_radius=0.059156480544336074",
)
SHOVES = SHOVES.replace(swarms=[SHOVES.swarms[0].replace(drive_action=1.0)])


@pytest.mark.slow
@settings(max_examples=8)
@given(crowded_games(), st.integers(0, 2**32))
@example(SHOVES, 1417)
def test_crowds_that_shove_stay_apart_and_inside_to_the_end(game: Game, seed: int) -> None:
    model = GameModel(game.replace(sample_period=10 * game.parameters.period), seed)
    limit = model.arena.half - game.body.radius
    while not model.ended:
        model.step()
        assert pdist(model.states.positions).min() > 2 * game.body.radius - 1e-4
        assert np.abs(model.states.positions).max() <= limit + 1e-12
    check_times_and_pucks(model)
    assert model.ended == "time"
