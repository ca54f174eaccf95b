"""Ways of Mesa 3.5: time and observers, running to a time, its page. Most work with Mesa 3.3 too."""

import inspect
from typing import Any

import pytest

from kswarms import ForagingModel, InputError
from tests.games import game_under_way
from tests.helpers.mesa_versions import HAS_RNG


def small_model(**arguments: Any) -> ForagingModel:
    return ForagingModel(**{"n": 6, "seed": 1, "duration": 60.0, **arguments})


def test_the_time_is_that_of_the_clock() -> None:
    model = small_model()
    seen = [model.time]
    model.env.timeout(33).callbacks.append(lambda _: seen.append(model.time))
    model.step()
    assert [*seen, model.time] == [0.0, 3.3, 10.0]
    with pytest.raises(AttributeError, match="cannot be set"):
        model.time = 4.0
    assert model.time == 10.0


@pytest.mark.skipif(not HAS_RNG, reason="Mesa 3.5 and later")
def test_steps_notify_the_observers_of_the_time() -> None:
    model = small_model()
    seen = []

    def note(message: Any) -> None:
        seen.append((message.additional_kwargs["old"], message.additional_kwargs["new"], model.time))

    model.observe("time", "changed", note)
    model.play()
    model.step()
    assert seen == [(10.0 * k, 10.0 * (k + 1), 10.0 * (k + 1)) for k in range(6)]


def test_a_model_can_be_run_to_a_time_in_parts() -> None:
    model, twin = small_model(), small_model()
    twin.play()
    model.run_until(0.0)
    assert model.time == 0.0
    model.run_until(20.0)
    assert (model.time, model.steps, model.sample_times) == (20.0, 2, [0.0, 10.0, 20.0])
    model.run_for(14.5)
    assert (model.time, model.steps, model.sample_times[-1]) == (34.5, 3, 30.0)
    model.run_for(5.5)
    assert (model.time, model.sample_times[-1]) == (40.0, 40.0)
    model.run_until(1e9)
    assert (model.time, model.running) == (60.0, False)
    assert model.datacollector.model_vars == twin.datacollector.model_vars
    assert model.results() == twin.results()


@pytest.mark.parametrize("end", [9.9, float("nan"), float("inf")])
def test_a_model_cannot_be_run_to_a_time_in_the_past_or_without_end(end: float) -> None:
    model = small_model()
    model.step()
    with pytest.raises(InputError, match=r"end_time=.* must be a time \(s\) from 10 on"):
        model.run_until(end)
    assert model.time == 10.0


def test_events_are_scheduled_on_the_one_clock() -> None:
    model = game_under_way()
    for schedule in (model.schedule_event, model.schedule_recurring):
        with pytest.raises(TypeError, match=r"model\.env"):
            schedule(model.step, after=3.0)


def test_the_signature_shows_batch_run_no_seed() -> None:
    # `mesa.batch_run` of Mesa 3.5 would overwrite the seeds of a sweep by None.
    parameters = inspect.signature(ForagingModel).parameters
    assert {"n", "policies", "rng", "kwargs"} < parameters.keys()
    assert "seed" not in parameters
