"""User-defined code plays from the command line, in workers and in `mesa.batch_run`."""

import json
import os
import subprocess
import sys
from pathlib import Path

import mesa
import pyarrow.parquet as pq
import pytest

from kswarms.model.foraging import ForagingModel
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.toml_files import read_scenarios
from kswarms.scenarios.runs.play import play
from kswarms.scenarios.runs.run import expand

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
TEXTS = [
    "cautious.py:Cautious(patience=1)",
    "code/win_stay.py:WinStay",
    "inter-learner(reward='haste.py:Haste', rule='haste.py:EpsilonGreedy(epsilon=0.2)')",
]
SWEEP = """
import json, sys
import mesa
from kswarms.model.foraging import ForagingModel

if __name__ == "__main__":
    sweep = json.loads(sys.argv[1])
    rows = mesa.batch_run(ForagingModel, sweep, 2, data_collection_period=-1, display_progress=False)
    print(json.dumps(rows))
"""


@pytest.fixture(autouse=True)
def _change_to_a_directory_with_user_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Change to a directory with user code; workers still find the package."""
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path or str(Path.cwd()) for path in sys.path))
    monkeypatch.chdir(tmp_path)
    Path("code").mkdir()
    for name, where in (("cautious.py", ""), ("haste.py", ""), ("win_stay.py", "code")):
        Path(where, name).write_text((EXAMPLES / name).read_text())
    condition = """
        [[conditions]]
        name = "{}"
        duration = 40
        learning = 60
        swarms = [{{ policy = "avoid" }}, {{ policy = "{}" }}]
    """
    curves = (condition.format(k, text) for k, text in enumerate(TEXTS))
    head = "id = 'mine'\ntitle = 'Own code'\ndensities = [6]\nseeds = 1\n"
    Path("mine.toml").write_text(head + "".join(curves))


@pytest.mark.slow
def test_a_worker_process_gives_the_same_results() -> None:
    assert invoke(["run", "mine.toml", "--jobs", "1", "--no-figures"]) == 0  # a worker, since it is user code
    table = pq.read_table("results/runs.parquet")
    here = [row for run in expand(read_scenarios(Path("mine.toml"))) for row in play(run).swarms]
    assert len(here) == table.num_rows == 6
    written = [{name: row[name] for name in here[0]} for row in table.to_pylist()]
    assert sorted(written, key=repr) == sorted(here, key=repr)
    assert set(table["policy"].to_pylist()) == {"avoid", *TEXTS}
    assert set(pq.read_table("results/policies.parquet")["condition"].to_pylist()) == {"2"}


def test_an_error_in_user_code_is_one_line_and_nothing_is_written(capsys: pytest.CaptureFixture[str]) -> None:
    code = Path("cautious.py").read_text()
    Path("cautious.py").write_text(code.replace("return self.flight", "return self.flee", 1))
    assert invoke(["run", "mine.toml", "--out", "results"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "policy='cautious.py:Cautious(patience=1)': its trial raises AttributeError: " in line
    assert "(cautious.py, line " in line
    assert not Path("results").exists()


@pytest.mark.slow
def test_batch_run_with_two_processes_gives_the_same_results() -> None:
    sweep = {"policies": [f"avoid,{text}" for text in TEXTS], "n": 8, "seed": [0, 1], "duration": 40.0}
    here = mesa.batch_run(ForagingModel, sweep, 1, data_collection_period=-1, display_progress=False)
    Path("sweep.py").write_text(SWEEP)
    command = [sys.executable, "-W", "error", "sweep.py", json.dumps(sweep)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(json.loads(done.stdout), key=lambda row: row["RunId"]) == json.loads(json.dumps(here))
    assert {row["policies"] for row in here} == set(sweep["policies"])
