"""Random streams are identified by seed, robot and purpose."""

import itertools

import numpy as np

from kswarms.agents.streams import ENVIRONMENT, Purpose, Seeds, Streams, stream


def first_draws(seed: int, robot: int, purpose: Purpose) -> tuple[float, ...]:
    return tuple(stream(seed, robot, purpose).random(4))


def test_a_stream_gives_the_same_draws_again() -> None:
    assert first_draws(5, 3, Purpose.LEG) == first_draws(5, 3, Purpose.LEG)


def test_different_streams_give_different_draws() -> None:
    names = list(itertools.product((0, 1, 2**40), (0, 1, ENVIRONMENT), Purpose))
    assert len({first_draws(*name) for name in names}) == len(names)


def test_drawing_from_one_stream_does_not_change_others() -> None:
    first, second = stream(0, 0, Purpose.LEG), stream(0, 1, Purpose.LEG)
    first.random(1000)
    assert tuple(second.random(4)) == first_draws(0, 1, Purpose.LEG)


def test_neighbouring_streams_are_not_correlated() -> None:
    draws = np.array([stream(0, robot, Purpose.WANDER).random(2000) for robot in range(20)])
    correlations = np.corrcoef(draws)[np.triu_indices(20, 1)]
    assert np.abs(correlations).max() < 4.5 / np.sqrt(2000)


def test_the_value_of_a_purpose_never_changes() -> None:
    names = ["POSITION", "HEADING", "LEG", "WANDER", "WALL", "VACANT", "STATIONS", "EXPLORE", "POLICY"]
    assert [Purpose[name] for name in names] == list(range(9))


def test_draws_in_blocks_are_those_of_single_draws() -> None:
    calls = {"random": (), "exponential": (5.0,), "uniform": (-3.0, 1.0)}
    for method, arguments in calls.items():
        draws = Streams(4, 2).draws(Purpose.VACANT, method, *arguments)
        single = getattr(stream(4, 2, Purpose.VACANT), method)
        assert list(itertools.islice(draws, 300)) == [single(*arguments) for _ in range(300)]


def test_streams_of_a_game_equal_single_streams() -> None:
    for seed in (0, 7, 2**40, 2**200 + 1):
        seeds = Seeds(seed, 3)
        for robot, purpose in itertools.product(range(3), Purpose):
            fast, slow = Streams(seed, robot, seeds).generator(purpose), stream(seed, robot, purpose)
            assert fast.random(3).tolist() == slow.random(3).tolist()
            assert fast.spawn(2)[1].random() == slow.spawn(2)[1].random()
            fast_seeds, slow_seeds = (each.bit_generator.seed_seq for each in (fast, slow))
            assert fast_seeds.generate_state(3).tolist() == slow_seeds.generate_state(3).tolist()
