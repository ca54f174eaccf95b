"""Progress of a sweep."""

import json
from collections.abc import Iterator

import pytest

from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.cli import progress
from kswarms.scenarios.cli.printing import format_duration
from kswarms.scenarios.cli.progress import Count, show_progress, track
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.runs.sweep import Failure, Outcome, Result

SCENARIO = CATALOGUE["fig-6.1a"].replace(densities=(6, 30), seeds=2)
RUNS = sorted(expand([SCENARIO]), key=lambda run: run.effort, reverse=True)


ENDED: list[Result] = [
    (run, Failure("it broke") if k == 1 else Outcome([], [], {}), 0.1) for k, run in enumerate(RUNS)
]


def test_the_time_left_is_estimated_from_work_not_from_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    count = Count(RUNS)
    assert count.left == float("inf")
    now[0] += 5.0
    count.add(RUNS[0], failed=False)  # 30 of 30 + 30 + 6 + 6 robots
    assert count.left == pytest.approx(5.0 * 42 / 30)
    assert count.rate == pytest.approx(0.2)
    count.worked = count.work + 1e-9  # a rounding error
    assert count.left == 0.0


def test_lines_are_json_and_the_last_one_is_complete(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])

    def played() -> Iterator[Result]:
        for result in ENDED:
            now[0] += 0.6
            yield result

    assert [count.done for count in show_progress(played(), RUNS, "json")] == [1, 2, 3, 4]
    lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    counts = [(line["done"], line["failed"], line["total"]) for line in lines]
    assert counts == [(1, 0, 4), (3, 1, 4), (4, 1, 4)]
    assert (lines[-1]["scenario"], lines[-1]["seconds_left"]) == ("fig-6.1a", 0)
    assert lines[-1]["runs_per_second"] == pytest.approx(4 / 2.4, abs=1e-3)


def test_a_bar_names_the_scenario_and_counts_failures(capsys: pytest.CaptureFixture[str]) -> None:
    assert [count.failed for count in show_progress(ENDED, RUNS, "bar")][-1] == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "\x1b" not in printed.err  # no terminal, no control characters
    assert "fig-6.1a" in printed.err
    assert "4/4 (1 failed) runs" in " ".join(printed.err.split())


@pytest.mark.parametrize("kind", ["none", "bar", "json"])
def test_without_runs_nothing_is_shown(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert list(show_progress([], [], kind)) == []
    assert capsys.readouterr().err == ""


def test_a_bar_of_steps_is_shown_on_a_terminal_only(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert list(track("abc", "spelling", 3)) == ["a", "b", "c"]
    assert capsys.readouterr() == ("", "")
    monkeypatch.setenv("FORCE_COLOR", "1")  # makes rich assume a terminal
    assert list(track("abc", "spelling", 3)) == ["a", "b", "c"]
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "spelling" in printed.err


def test_durations_are_in_seconds_minutes_or_hours() -> None:
    shown = [format_duration(seconds) for seconds in (0.24, 59.9, 60, 3599.4, 3599.6, 8337)]
    assert shown == ["0.2 s", "59.9 s", "1:00 min", "59:59 min", "1:00 h", "2:19 h"]
