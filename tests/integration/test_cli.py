"""The command line: output, files and errors."""

import subprocess
import sys
import tomllib
from operator import itemgetter
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.cli import invoke, playing
from kswarms.scenarios.cli.playing import Plan
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.run import expand
from tests.helpers.tiny_study import TINY

pytestmark = pytest.mark.usefixtures("empty_directory")

CONDITIONS = {each.replace(name="") for scenario in CATALOGUE.values() for each in scenario.conditions}
QUICK = ["--densities", "6", "--seeds", "1", "--jobs", "1", "--no-figures"]


def test_list_shows_all_entries_with_their_cost_and_counts_shared_runs_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert invoke(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["id", *CATALOGUE, *TABLES, "--all"]
    entries = (*CATALOGUE.values(), *TABLES.values())
    assert all(line.endswith(f"  {entry.title}") for entry, line in zip(entries, lines[1:-1], strict=True))
    sizes = {line.split()[0]: line.split()[1:4] for line in lines}
    assert sizes["fig-6.1a"] == ["1", "200", "16.8"]  # s: 200 games × 600 s × 28 robots × 5 µs
    assert sizes["fig-6.12"][:2] == ["6", "1,200"]
    assert sizes["table-6.1"][:2] == ["2", "400"]
    runs = expand(CATALOGUE.values())
    assert sizes["--all"][:2] == [str(len(CONDITIONS)), f"{len(runs):,}"]
    hours, minutes = map(int, sizes["--all"][2].split(":"))
    assert 60 * hours + minutes == pytest.approx(sum(run.effort for run in runs) / 60, abs=1)


@pytest.mark.parametrize(
    ("command", "modules"),
    [
        ("list", "mesa numba pandas pyarrow scipy seaborn simpy"),
        ("--help", "numpy kswarms.scenarios.catalogue kswarms.scenarios.cli.run"),
        ("--version", "numpy kswarms.scenarios.catalogue kswarms.scenarios.cli.run"),
    ],
)
def test_list_help_and_version_import_nothing_heavy(command: str, modules: str) -> None:
    code = (
        f"import sys; from kswarms.scenarios.cli import invoke; invoke(['{command}']); "
        f"print(*sorted(set('{modules}'.split()) & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == ""


def test_show_prints_a_scenario_or_those_of_a_table_as_toml(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["show", "fig-7.10"]) == 0
    assert Scenario(**tomllib.loads(capsys.readouterr().out)) == CATALOGUE["fig-7.10"]
    for table_id, table in TABLES.items():
        assert invoke(["show", table_id]) == 0
        shown = tomllib.loads(capsys.readouterr().out)["scenarios"]
        assert [Scenario(**each) for each in shown] == [CATALOGUE[name] for name in table.scenarios]


def test_version_and_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["--version"]) == 0
    assert capsys.readouterr().out.startswith("kswarms 0.")
    assert invoke([]) == 0
    text = capsys.readouterr().out
    assert "0 done, 1 failed, 2 bad input; interrupted: 130 Ctrl-C, 143" in text
    listed = text.split("Commands:")[1].split("Example:")[0].splitlines()
    assert all(line.endswith(".") and not line.endswith("...") for line in listed if line.strip())
    commands = [line.split()[0] for line in listed if line.strip()]
    assert {"list", "show", "run", "film", "explore", "contribution", "report"} < set(commands)
    for words in ([], *([command] for command in commands)):
        assert invoke([*words, "--help"]) == 0
        assert f"Example: kswarms {' '.join(words)}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ("run", "id='': must be one or more of `kswarms list`, or none with --all"),
        ("run fig-6.1a --all", "id='fig-6.1a': must be one or more of"),
        ("run fig-6.1a fgi-7.12", "id='fgi-7.12': must be a scenario or table; did you mean fig"),
        ("run fig-6.1a --seeds 0", "seeds=0: must be greater than or equal to 1"),
        ("run fig-6.1a --seeds 1.5", "seeds='1.5': must be a valid integer"),
        ("run fig-6.1a --record robots,", "record='': must be among conflicts, robots, trajectory"),
        ("run fig-6.1a --out taken/below", "out='taken/below': must be a writable directory"),
        ("run fig-6.1a --speed 3", "option='--speed': must be one of --all, --allow-mixed, "),
        ("run fig-6.1a --progress dots", "progress='dots': must be one of 'bar', 'json', 'none'"),
        ("status nowhere", "results='nowhere': must be a directory with a ledger.sqlite of kswarms"),
        ("show", "id=None: is required"),
        ("replay results", "run=None: is required"),
        ("show fig-6.1a fig-6.1b", "arguments='fig-6.1b': must not be given; Usage: kswarms show"),
        ("film fig-6.1a --fps", "fps=None: needs a value"),
        ("run fig-6.1a --quiet=yes", "quiet='yes': takes no value"),
        ("list -x", "option='-x': must be one of --help"),
        ("--verbose", "option='--verbose': must be one of --help, "),
        ("play", "command='play': must be one of list, show, run, "),
        ("xyz", "command='xyz': must be one of list, show, run, "),
    ],
)
def test_bad_input_is_refused_in_one_line_and_nothing_is_written(
    arguments: str, line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("taken").write_text("a file")
    assert invoke(arguments.split()) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"kswarms: {line}")
    assert printed.err.count("\n") == 1
    assert {path.name for path in tmp_path.iterdir()} == {"taken"}


def test_a_run_writes_tables_and_prints_the_next_command(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--out", "my results", "--record", "robots,conflicts,trajectory"]
    assert invoke(["run", "fig-6.1c", *QUICK, *options]) == 0
    *tables, next_command = capsys.readouterr().out.splitlines()
    names = ("runs", "conflicts", "robots", "trajectory")
    assert tables == [f"table:  my results/{name}.parquet" for name in names]
    assert next_command == "next:   kswarms report 'my results'  (all results in one HTML file)"
    rows = pq.read_table("my results/runs.parquet").to_pylist()
    assert [(row["n"], row["seed"], row["policy"]) for row in rows] == [(6, 0, "avoid"), (6, 0, "attack")]
    assert [row["ended"] for row in rows] == ["time", "time"]
    assert rows[0]["sud"] == rows[0]["pucks"] - rows[1]["pucks"]
    robots = pq.read_table("my results/robots.parquet").to_pylist()
    assert [row["run"] for row in robots] == [rows[0]["run"]] * 6
    for swarm in (1, 2):
        mine = [row for row in robots if row["swarm"] == swarm]
        assert sum(row["pucks"] for row in mine) == rows[swarm - 1]["pucks"]
        assert sum(row["t_a"] + row["t_p"] for row in mine) == pytest.approx(3 * 600)
    started = pq.read_table("my results/conflicts.parquet").num_rows
    assert started == sum(row["conflicts_intra"] + row["conflicts_inter"] for row in rows)
    trajectory = pq.read_table("my results/trajectory.parquet").to_pydict()
    assert sorted(set(trajectory["time"])) == [10.0 * k for k in range(61)]
    assert (set(trajectory["robot"]), set(trajectory["state"])) == (set(range(6)), {"A", "P"})


def test_seeds_and_first_seed_select_the_seeds() -> None:
    words = ["run", "fig-7.12", "--densities", "13", "--seeds", "2", "--first-seed", "7", "--no-figures"]
    assert invoke([*words, "--jobs", "1"]) == 0
    rows = pq.read_table("results/runs.parquet").to_pylist()
    found = [(row["seed"], row["swarm"], row["size"]) for row in rows]
    assert found == [(7, 1, 7), (7, 2, 6), (8, 1, 7), (8, 2, 6)]


@pytest.mark.slow
def test_a_table_is_played_and_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "table-6.1", *QUICK, "--record", "robots,conflicts"]) == 0
    lines = capsys.readouterr().out.splitlines()
    tables = ("runs", "policies", "conflicts", "robots")
    assert lines[:4] == [f"table:  results/{name}.parquet" for name in tables]
    assert lines[4:6] == ["", f"table-6.1: {TABLES['table-6.1'].title}"]
    (row,) = (line for line in lines if line.startswith("│"))
    cells = [cell.strip() for cell in row.strip("│").split("│")]
    assert (cells[0], cells[1], cells[3]) == ("6", "1.6", "1.6")  # N, and published numbers
    runs = pq.read_table("results/runs.parquet").to_pylist()
    assert {(row["scenario"], row["duration"]) for row in runs} == {("fig-6.4a", 600.0), ("fig-6.4b", 600.0)}
    policies = pq.read_table("results/policies.parquet").to_pylist()
    attack = {row["scenario"]: row["attack_share"] for row in policies}
    assert [cells[2], cells[4]] == [f"{100 * attack[name]:.1f}" for name in ("fig-6.4a", "fig-6.4b")]
    assert "mean absolute error" in lines[-2]

    robots = pq.read_table("results/robots.parquet").to_pylist()
    fights = 0
    for row in policies:
        if row["action"] == "fight":
            learners = [robot for robot in robots if robot["run"] == row["run"] and robot["swarm"] == 2]
            best = [max(robot["arms"], key=itemgetter("q"))["action"] for robot in learners]
            assert row["share"] == pytest.approx(best.count("fight") / len(best))
            fights += len(best)
    assert fights == 6
    conflicts = pq.read_table("results/conflicts.parquet").to_pylist()
    assert {conflict["phase"] for conflict in conflicts} == {"learning", "game"}


@pytest.mark.slow
def test_a_table_without_published_numbers_is_printed_and_each_scenario_has_a_figure(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["run", "table-7.1", "table-6.2", "table-7.1", *QUICK[:-1]]
    assert invoke(words) == 0
    printed = capsys.readouterr().out
    pictures = [f"results/figures/fig-{number}.png" for number in ("7.4", "6.8")]
    assert "\n".join([*(f"figure: {each}" for each in pictures), "", "table-7.1: "]) in printed
    assert all(Path(each).read_bytes().startswith(b"\x89PNG") for each in pictures)
    assert printed.count("table-7.1: ") == printed.count("table-6.2: ") == 1
    first, second = printed.split("table-6.2: ")
    assert "published" not in first
    assert "delta=0.145" in first
    assert "published" in second


def test_order_and_portions_do_not_change_the_tables() -> None:
    # `test_cluster.py` varies the number of workers.
    for name in ("tiny", "other"):
        Path(f"{name}.toml").write_text(TINY.replace(id=name).to_toml())
    words = ["--densities", "6,10", "--seeds", "2", "--jobs", "1", "--no-figures"]
    assert invoke(["run", "tiny.toml", "other.toml", *words, "--out", "one"]) == 0
    assert invoke(["run", "other.toml", "tiny.toml", *words, "--out", "two"]) == 0
    for seed in ("1", "0"):
        words[3] = "1"
        again = ["--first-seed", seed, "--out", "three"]
        assert invoke(["run", "other.toml", "tiny.toml", *words, *again]) == 0
    for name in ("runs.parquet", "policies.parquet"):
        one, two, three = (Path(place, name).read_bytes() for place in ("one", "two", "three"))
        assert one == two == three


def test_all_plays_the_scenarios_that_the_densities_suit(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    played = []

    def note(_out: Path, plan: Plan, *_rest: object) -> tuple[list[Path], int]:
        played.extend((label[0], run.n) for run in expand(plan.scenarios) for label in run.labels)
        return [], 0

    monkeypatch.setattr(playing, "play_study", note)
    assert invoke(["run", "--all", "--densities", "6,13", "--seeds", "1", "--no-figures"]) == 0
    sizes = {name: {n for played_name, n in played if played_name == name} for name in CATALOGUE}
    exceptions = {"fig-6.15": {6, 13}, "fig-7.12": {13}, "fig-7.13a": {13}, "fig-7.13b": {13}}
    assert sizes == {name: exceptions.get(name, {6}) for name in CATALOGUE}
    printed = capsys.readouterr()
    assert printed.out == "next:   kswarms report results  (all results in one HTML file)\n"
    assert printed.err == ""
    assert invoke(["run", "--all", "--densities", "6", "--seeds", "1", "--no-figures"]) == 0
    left_out = "kswarms: left out, since no density suits them: fig-7.12, fig-7.13a, fig-7.13b\n"
    assert capsys.readouterr().err == left_out


def test_a_failing_run_and_a_full_disk_are_reported_and_nothing_is_written(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(error: Exception) -> None:
        def play(*_rest: object) -> None:
            raise error

        monkeypatch.setattr(playing, "play_study", play)

    fail(RunError("run n=6 seed=0 failed: ZeroDivisionError: division by zero", "Traceback: here"))
    assert invoke(["run", "fig-6.1a", *QUICK]) == 1
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "Traceback: here"
    assert lines[-1].startswith("kswarms: run n=6 seed=0 failed")
    fail(OSError(28, "No space left on device"))
    assert invoke(["run", "fig-6.1a", *QUICK]) == 1
    assert capsys.readouterr().err == "kswarms: [Errno 28] No space left on device\n"
    assert list(Path().iterdir()) == []
