"""Events of the model on SimPy's clock, and garbage collection while it runs."""

import gc

import pytest

from kswarms.model.clock import rare_garbage_collection
from tests.games import make_game, play


def test_garbage_collection_is_rare_only_within_the_block() -> None:
    before = gc.get_threshold()
    with rare_garbage_collection(10**6):
        assert gc.get_threshold() == (10**6, *before[1:])
    assert gc.get_threshold() == before
    with pytest.raises(ValueError, match="stop"), rare_garbage_collection(10**6):
        raise ValueError("stop")
    assert gc.get_threshold() == before


def test_no_threshold_is_lowered_and_no_collection_is_turned_on() -> None:
    before = gc.get_threshold()
    try:
        with rare_garbage_collection(1):
            assert gc.get_threshold() == before
        gc.set_threshold(0)
        with rare_garbage_collection(10**6):
            assert gc.get_threshold()[0] == 0
    finally:
        gc.set_threshold(*before)


def test_the_robots_of_a_game_are_not_searched_for_garbage_again_and_again() -> None:
    collections = []

    def count(phase: str, info: dict[str, int]) -> None:
        collections.append((phase, info["generation"]))

    play(make_game("avoid", size=2, duration=1.0), record="")
    gc.collect()
    gc.callbacks.append(count)
    try:
        play(make_game("avoid", "attack", size=1000, side=13.0, duration=5.0), record="")
    finally:
        gc.callbacks.remove(count)
    assert len([phase for phase, _ in collections if phase == "start"]) <= 3
