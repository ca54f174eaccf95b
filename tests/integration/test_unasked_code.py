"""User-defined code runs only if the user asks for it: not to describe, compare or refuse a game."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.model.description.game import Game, Swarm
from kswarms.scenarios.cli import invoke
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.description.toml_files import read_scenarios
from kswarms.scenarios.runs.run import digest, hash_file
from kswarms.scenarios.study.study import Study
from kswarms.scenarios.watch.recorded_run import recorded_run

CODE = """
from pathlib import Path

from kswarms.agents.learning.rewards import Reward
from kswarms.agents.learning.selection_rules import Rule

Path(MARK).touch()


class Mine:
    def __init__(self, setting):
        self.action = setting.actions[0]

    def choose(self, opponent):
        return self.action


class MyReward(Reward):
    def of(self, t_a, t_p, n_active, direction, inter, opponent):
        return t_p


class MyRule(Rule):
    def prefer(self, bandit, rng):
        return 0
"""
FILES = ("code.py", "code_module.py", "code_package/__init__.py", "code_package/deep/own.py")
POLICIES = {
    "code.py:Mine": "code.py",
    "avoid+./code.py:Mine(patience=3)": "code.py",
    "code_module:Mine": "code_module.py",
    "code_package.deep.own:Mine": "code_package/deep/own.py",
    "learner(reward='code.py:MyReward')": "code.py",
    "inter-learner(rule='code_module:MyRule(gain=2)', reward='individual')": "code_module.py",
}
"""Policies, and a file of the code of each."""


@pytest.fixture(autouse=True)
def _change_to_a_directory_with_user_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Change to a directory with user code that leaves a mark when it is executed; expect no mark."""
    monkeypatch.chdir(tmp_path)
    mark = tmp_path / "executed"
    for name in FILES:
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(CODE.replace("MARK", repr(str(mark))))
    yield
    assert not mark.exists(), "code was executed"


def scenario(policy: str) -> Scenario:
    swarms = ({"policy": "avoid"}, {"policy": policy})
    condition = {"duration": 5.0, "swarms": swarms}
    return Scenario(id="mine", title="Own code", densities=(6,), seeds=1, conditions=(condition,))


def planned_run(policy: str) -> str:
    """Plan a study in `results`; return the digest of its run."""
    with Study(Path("results")) as study:
        (run,) = study.plan([scenario(policy)])
    return run.digest


@pytest.mark.parametrize(("policy", "file"), POLICIES.items())
def test_describing_a_game_executes_nothing(policy: str, file: str) -> None:
    Path("mine.toml").write_text(scenario(policy).to_toml())
    assert invoke(["show", "mine.toml"]) == 0
    (found,) = read_scenarios(Path("mine.toml"))
    game = found.game("", 6)
    before = digest(game, 0)
    Path(file).write_text("# another version")
    assert digest(game, 0) != before


COMMANDS = {
    "replay": "replay results RUN",
    "film": "film results --run RUN --to 1 --size 64 --out a.gif",
    "conflicts": "conflicts results --run RUN",
    "explore": "explore results --run RUN --no-browser",
}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS.keys())
@pytest.mark.parametrize("policy", ["code.py:Mine", "code_module:Mine", "learner(reward='code.py:MyReward')"])
def test_a_run_of_a_directory_that_names_code_is_refused(
    policy: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if command.startswith("explore"):
        pytest.importorskip("solara", reason="needs the extra `explore`")
    run = planned_run(policy)
    assert invoke(command.replace("RUN", run).split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"kswarms: run='{run}': executes user-defined code; add --trust if you trust it: ")
    file = Path(POLICIES[policy])
    assert line.endswith(f"{file.name}' (SHA-256 {hash_file(file)[:16]})")
    assert not Path("a.gif").exists()


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS.keys())
def test_a_run_whose_code_has_changed_is_refused_also_with_trust(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if command.startswith("explore"):
        pytest.importorskip("solara", reason="needs the extra `explore`")
    run = planned_run("code.py:Mine")
    Path("code.py").write_text(Path("code.py").read_text() + "# another version\n")
    assert invoke([*command.replace("RUN", run).split(), "--trust"]) == 2
    assert "loads a file that has changed since it was played" in capsys.readouterr().err


def test_a_message_lists_a_limited_number_of_files() -> None:
    for k in range(20):
        Path(f"code_package/other_{k}.py").touch()
    run = planned_run("code_package.deep.own:Mine")
    with pytest.raises(InputError, match=r"12 more$") as error:
        recorded_run(Path("results"), run)
    assert str(error.value).count("SHA-256") == 10


@pytest.mark.parametrize("policy", ["code.py:Mine", "learner(rule='code.py:MyRule')"])
@pytest.mark.parametrize("command", ["replay", "film", "conflicts"])
def test_a_trusted_run_plays(policy: str, command: str) -> None:
    Path("code.py").write_text(CODE.replace("Path(MARK).touch()", ""))
    run = planned_run(policy)
    assert invoke([*COMMANDS[command].replace("RUN", run).split(), "--trust"]) == 0


@pytest.mark.parametrize(
    ("reference", "rule"),
    [
        ("my code:Mine", "must be path/to/my_file.py:MyClass or package.module:MyClass"),
        ("/etc/x:Mine", "must be path/to/my_file.py:MyClass or package.module:MyClass"),
        ("code_package..own:Mine", "must be path/to/my_file.py:MyClass or package.module:MyClass"),
        ("code.py:Mine-Own", "must be path/to/my_file.py:MyClass or package.module:MyClass"),
    ],
)
@pytest.mark.parametrize("policy", ["REFERENCE", "learner(reward='REFERENCE')", "learner(rule='REFERENCE')"])
def test_the_form_of_a_reference_is_checked(policy: str, reference: str, rule: str) -> None:
    with pytest.raises(InputError, match=rule) as error:
        Game(swarms=(Swarm(policy=policy.replace("REFERENCE", reference), size=2),))
    assert error.value.value == reference


def test_arguments_of_a_built_in_learner_are_checked_beside_a_reference() -> None:
    for argument, rule in (
        ("about='all'", "must be inter, intra or both"),
        ("otherwise='dance'", "must be one of flight, fight"),
        ("rule='ucb(gamma=-1)'", "must be greater than or equal to 0"),
        ("speed=1", "unknown field"),
    ):
        policy = f"learner(reward='code.py:MyReward', {argument})"
        with pytest.raises(InputError, match=rule):
            Game(swarms=(Swarm(policy=policy, size=2), Swarm(policy="avoid", size=2)))


@pytest.mark.parametrize("reference", ["nowhere.deep:Mine", "nowhere:Mine"])
def test_a_module_that_does_not_exist_is_refused_before_an_import(reference: str) -> None:
    game = Game(swarms=(Swarm(policy=reference, size=2),))
    with pytest.raises(InputError, match="must name a module; there is no nowhere"):
        digest(game, 0)
