"""Recorded tables of large games."""

import gc
import tracemalloc

import numpy as np

from kswarms.scenarios.study.parquet import pack
from tests.games import make_game, play


def test_the_trajectory_has_the_places_of_the_robots_in_arrays() -> None:
    model = play(make_game("avoid", "attack", duration=20.0), record="trajectory")
    records, lists = model.recorder.records()["trajectory"], model.tables()["trajectory"]
    assert {name: column.tolist() for name, column in records.items()} == lists
    assert lists["robot"][-12:] == list(range(12))
    assert lists["x"][-12:] == [float(robot.position[0]) for robot in model.robots]
    assert lists["state"][-12:] == [robot.state for robot in model.robots]
    assert lists["puck"][-12:] == [robot.carrying for robot in model.robots]


def test_a_sample_of_a_trajectory_takes_arrays_and_no_object_for_each_robot() -> None:
    model = play(make_game("avoid", "attack", size=500, side=9.0, duration=0.1), record="trajectory")
    gc.collect()
    tracemalloc.start()
    before, objects = tracemalloc.get_traced_memory()[0], len(gc.get_objects())
    for _ in range(20):
        model.steps += 1
        model.recorder.sample(model.datacollector)
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert len(gc.get_objects()) - objects < 1000
    assert grown < 20 * 1000 * 60  # bytes: 45 for each robot and sample


def test_arrays_and_lists_are_packed_alike() -> None:
    model = play(make_game("avoid", "attack", duration=20.0), record="trajectory")
    assert pack(model.recorder.records()) == pack(model.tables())


def test_times_of_a_swarm_are_the_sums_of_its_robots() -> None:
    model = play(make_game("avoid", "attack", duration=60.0), record="")
    model.remove(model.robots[2])
    for k in range(2):
        t_a, t_p = model.times(k)
        of_robots = [robot.times() for robot in model.players(k)]
        assert t_a == np.sum([own for own, _ in of_robots], axis=0).tolist()
        assert t_p == sum(own for _, own in of_robots)
