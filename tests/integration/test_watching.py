"""The commands that show a game: `film`, `conflicts`, and errors of `explore`."""

from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from PIL import Image

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.cli import explore as explore_command
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.contribution.table import SCHEMA
from kswarms.scenarios.runs.run import digest
from kswarms.scenarios.watch.conflicts import HEADINGS, conflicts_of
from kswarms.scenarios.watch.recorded_run import recorded_run

pytestmark = pytest.mark.usefixtures("empty_directory")


def _film(arguments: str) -> int:
    return invoke(["film", *arguments.split()])


def test_part_of_a_game_becomes_a_film(capsys: pytest.CaptureFixture[str]) -> None:
    assert _film("fig-6.1c --n 6 --from 10 --to 12 --speed 2 --fps 10 --size 100 --out a.gif") == 0
    assert capsys.readouterr().out == "film: a.gif\n"
    with Image.open("a.gif") as gif:
        # 2 s at twice the speed, 10 frames per second, and the last instant.
        assert gif.n_frames == 11  # type: ignore[attr-defined]
        assert gif.width == 100


def test_a_film_ends_with_its_game() -> None:
    Path("quick.toml").write_text(
        'id = "quick"\ntitle = "One puck"\ndensities = [6]\n'
        '[[conditions]]\npuck_limit = 1\nduration = 3600.0\n[[conditions.swarms]]\npolicy = "avoid"\n'
    )
    assert _film("quick.toml --speed 50 --fps 1 --size 64 --out a.gif") == 0
    with Image.open("a.gif") as gif:
        assert 1 < gif.n_frames < 20  # type: ignore[attr-defined]


def test_a_contact_sheet_is_named_by_its_game(capsys: pytest.CaptureFixture[str]) -> None:
    game = "fig-7.4 --condition delta=0.1 --n 6 --seed 4"
    assert _film(f"{game} --from -2900 --to -2800 --sheet 3 --size 100") == 0
    assert capsys.readouterr().out == "sheet: fig-7.4-delta=0.1-n6-seed4.png\n"
    assert [path.name for path in Path().iterdir()] == ["fig-7.4-delta=0.1-n6-seed4.png"]
    assert _film("fig-6.1c --n 6 --to 5 --sheet 1 --size 100 --out one.png") == 0
    with Image.open("one.png") as sheet:
        assert sheet.width == 100


def test_a_recorded_run_is_filmed_and_its_conflicts_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    command = "run fig-6.1c --densities 6 --seeds 1 --first-seed 3 --jobs 1 --no-figures"
    assert invoke(command.split()) == 0
    name = str(pq.read_table("results/runs.parquet")["run"][0])
    capsys.readouterr()
    assert _film(f"--run {name} results --seed 4") == 2
    assert "seed=4: must not be given with --run" in capsys.readouterr().err
    assert _film(f"--run {name} results --to 1 --size 64 --out a.gif") == 0
    assert invoke(["conflicts", "--run", name, "results", "--robot", "2", "--to", "300"]) == 0
    header, *lines = capsys.readouterr().out.splitlines()[1:]
    assert header.split("  ")[0] == HEADINGS[0]
    run = recorded_run(Path("results"), name)
    assert run.seed == 3
    own = [each.row["start"] for each in conflicts_of(run) if each.row["robot"] == 2]
    expected = [start for start in own if start <= 300]
    assert [float(line.split()[0]) for line in lines] == pytest.approx(expected)
    assert expected


def test_conflicts_are_listed_from_an_instant(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["conflicts", "fig-6.1c", "--n", "6", "--from", "300"]) == 0
    lines = capsys.readouterr().out.splitlines()[1:]
    assert min(float(line.split()[0]) for line in lines) >= 300


LATE = """
class Late:
    def __init__(self, setting):
        self.action, self.met = setting.actions[0], 0
    def choose(self, opponent):
        self.met += 1
        if self.met > 20:
            raise ZeroDivisionError("met\\ntoo many")
        return self.action
"""
"""A policy that fails at a late conflict, after the first frames of a film."""


@pytest.mark.parametrize(
    "command",
    [
        "film mine.toml --size 64 --out a.gif",
        "film mine.toml --size 64 --out a.mp4",
        "film mine.toml --size 64 --sheet 2 --out a.png",
        "conflicts mine.toml",
    ],
)
def test_a_failing_policy_is_reported_with_its_traceback_and_nothing_is_written(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if "mp4" in command:
        pytest.importorskip("imageio_ffmpeg", reason="needs the extra `explore`")
    Path("late.py").write_text(LATE)
    Path("mine.toml").write_text(
        'id = "mine"\ntitle = "Late"\ndensities = [6]\n[[conditions]]\n'
        'swarms = [{ policy = "avoid" }, { policy = "late.py:Late" }]\n'
    )
    assert invoke(command.split()) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    trace, last = printed.err.splitlines()[:-1], printed.err.splitlines()[-1]
    run = "run scenario='mine' condition='' n=6 seed=0"
    assert last == f"kswarms: {run} failed: ZeroDivisionError: met too many"
    assert trace[0] == "Traceback (most recent call last):"
    assert any(line.endswith("in choose") and "late.py" in line for line in trace)
    assert sorted(path.name for path in Path().iterdir() if path.is_file()) == ["late.py", "mine.toml"]
    assert [path.name for path in Path().iterdir() if path.is_dir()] in ([], ["__pycache__"])


@pytest.mark.parametrize("absent_from", ["learning", "game"])
def test_a_game_with_an_absent_robot_is_filmed_and_its_conflicts_are_listed(
    absent_from: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command = f"contribution fig-6.1c --n 6 --robots 2 --seeds 1 --first-seed 3 --absent-from {absent_from}"
    assert invoke([*command.split(), "--jobs", "1"]) == 0
    (row,) = pq.read_table("results/contribution.parquet").to_pylist()
    capsys.readouterr()
    whole, without = (recorded_run(Path("results"), row[name]) for name in ("run", "run_without"))
    assert (whole.seed, whole.game.absent) == (3, ())
    assert (without.seed, without.game.absent, without.labels) == (3, (2,), (("fig-6.1c", ""),))
    assert _film(f"--run {without.digest} results --to 1 --size 64 --out a.gif") == 0
    assert invoke(["conflicts", "--run", without.digest, "results"]) == 0
    lines = capsys.readouterr().out.splitlines()[2:]
    assert {line.split()[1] for line in lines} == set("01345")


def test_a_compared_run_of_an_unknown_scenario_is_refused() -> None:
    game = CATALOGUE["fig-6.1c"].game("", 6)
    row = {"run": digest(game, 0), "run_without": "0123", "seed": 0, "robot": 0, "n": 6}
    labels = (("mine", ""), ("fig-6.1c", "other"), ("fig-6.1c", ""))
    for (scenario, condition), name in zip(labels, (row["run"], row["run"], "0123"), strict=True):
        other = {field.name: "" if field.type == pa.string() else 1 for field in SCHEMA}
        whole = other | row | {"scenario": scenario, "condition": condition, "absent_from": "game"}
        pq.write_table(pa.Table.from_pylist([whole], schema=SCHEMA), "contribution.parquet")
        with pytest.raises(InputError, match=f"run='{name}': must be a run of this version of kswarms"):
            recorded_run(Path(), str(name))
        with pytest.raises(InputError, match="must be a directory with a ledger"):
            recorded_run(Path(), "4567")
    Path("contribution.parquet").write_text("no table")
    with pytest.raises(InputError, match=r"contribution[.]parquet': must be a readable Parquet file"):
        recorded_run(Path(), "0123")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ("film fig-6.1c --condition x", "condition='x': must be one of ''"),
        ("film fig-6.1c --from -1", "from=-1.0: must be at least 0.0, below 600.0"),
        ("film fig-6.1c --from 9 --to 9", "to=9.0: must be greater than 9.0, and at most 600.0"),
        ("film fig-6.1c --speed 0", "speed=0.0: must be greater than 0"),
        ("film fig-6.1c --out a.avi", "out='a.avi': must end with .mp4 or .gif"),
        ("film fig-6.1c --sheet 2 --out a.gif", "out='a.gif': must end with .png"),
        ("film fig-6.1c --out nowhere/a.gif", "out='nowhere/a.gif': must be a writable file (No such file"),
        ("film --run 0123", "run='0123': needs a results directory, DIR"),
        ("film --run 0123 nowhere", "results='nowhere': must be a directory"),
        ("conflicts fig-6.1c --n 6 --robot 6", "robot=6: must be in 0 to 5"),
        ("explore fig-9", "id='fig-9': must be a scenario"),
        ("explore --port 99999", "port='99999': must be less than or equal to 65535"),
    ],
)
def test_bad_input_is_refused_in_one_line_and_nothing_is_written(
    arguments: str, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if arguments.startswith("explore"):
        pytest.importorskip("solara", reason="needs the extra `explore`")
    assert invoke(arguments.split()) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"kswarms: {line}")
    assert len(printed.err.splitlines()) == 1
    assert list(Path().iterdir()) == []


def test_without_its_extra_explore_prints_how_to_install_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(explore_command, "find_spec", lambda _: None)
    assert invoke(["explore"]) == 2
    expected = "kswarms: explore='solara': is not installed: pip install 'kswarms[explore]'\n"
    assert capsys.readouterr().err == expected
