"""Code and files that the controls of a page may name: those of its start, and others with `--allow-code`."""

from collections.abc import Callable
from pathlib import Path

import pytest

from kswarms.agents.policies.saved import save_learned
from kswarms.model.description.game import Game, Swarm
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.explore.session import Session
from kswarms.scenarios.runs.run import Run, digest

MARKING = """
from pathlib import Path
Path({mark!r}).touch()
class Coward:
    def __init__(self, setting, patience=1):
        self.flight = setting.actions[0]
    def choose(self, opponent):
        return self.flight
class Other(Coward):
    pass
"""
REFUSED = "must not name code or a file; to allow it, start `kswarms explore` with --allow-code"


@pytest.fixture(autouse=True)
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two files that leave a mark when they are executed, in the current directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in ("own", "evil"):
        Path(f"{name}.py").write_text(MARKING.format(mark=f"{name} was executed"))
    return tmp_path


def was_executed(name: str) -> bool:
    return Path(f"{name} was executed").exists()


@pytest.mark.parametrize(
    "policy",
    [
        "evil.py:Coward",
        "evil:Coward",
        "./evil.py:Coward(patience=2)",
        " evil.py:Coward",
        "attack + evil.py:Coward",
        "inter-learner(reward='evil.py:Coward')",
        "learner(rule='evil:Coward(x=1)')",
        "learned(file='evil.py')",
        "learned(file=b'evil.py')",
        "learned(file='/dev/zero')",
        "attack(file='evil.py')",
        "missing.py:Coward",
        "os:system",
    ],
)
@pytest.mark.parametrize("start", ["fig-6.1c", "fig-6.4b"])
def test_a_control_that_names_code_is_refused_and_nothing_is_executed(start: str, policy: str) -> None:
    session = Session(start)
    player = session.player
    session.change_swarm(0, policy=policy)
    assert session.error.startswith("policy=")
    assert session.error.endswith(REFUSED)
    assert session.player is player
    session.change(seed=3)  # the invalid control stays
    assert session.error.endswith(REFUSED)
    assert not was_executed("evil")
    session.change_swarm(0, policy="avoid")
    assert session.error == ""


@pytest.mark.parametrize("part", ["reward", "rule"])
def test_the_controls_of_learning_cannot_name_code(part: str) -> None:
    session = Session("fig-6.4b")
    session.change_learning(part, "evil.py:Coward")
    assert session.error.endswith(REFUSED)
    assert not was_executed("evil")


@pytest.mark.parametrize("source", ["evil.toml", "./evil.toml", "/dev/stdin.toml", "missing.toml"])
def test_a_file_of_scenarios_that_is_not_the_start_is_not_read(source: str) -> None:
    Path("evil.toml").write_text("not = 'a scenario'")
    session = Session("fig-6.1c")
    session.load(source)
    assert session.error.startswith("id=")
    assert session.error.endswith(REFUSED)
    session.load("fig-6.1a")
    assert (session.error, session.source) == ("", "fig-6.1a")


def own_scenario() -> Path:
    file = Path("own.toml")
    text = CATALOGUE["fig-6.4b"].replace(id="own").to_toml()
    file.write_text(text.replace('"attack"', '"own.py:Coward"'))
    assert "own.py:Coward" in file.read_text()
    return file


def own_run() -> Run:
    game = Game(swarms=(Swarm(policy="own.py:Coward", size=2), Swarm(policy="inter-learner", size=2)))
    return Run(digest(game, 0), game, 0, (("own", ""),))


@pytest.mark.parametrize("start", [lambda: str(own_scenario()), own_run], ids=["scenario", "run"])
def test_the_code_of_the_start_plays_and_its_controls_can_be_changed(start: Callable[[], str | Run]) -> None:
    session = Session(start())
    assert was_executed("own")
    for change in (
        lambda: session.change(seed=4),
        lambda: session.change_swarm(0, policy="own.py:Coward(patience=2)"),
        lambda: session.change_swarm(1, policy="own.py:Coward"),
        session.reset,
        session.step,
    ):
        change()
        assert session.error == ""
    for policy in ("own.py:Other", "evil.py:Coward"):
        session.change_swarm(1, policy=policy)
        assert session.error.endswith(REFUSED)
    assert not was_executed("evil")


def test_the_file_of_the_start_can_be_loaded_again_after_an_edit() -> None:
    file = own_scenario()
    session = Session(str(file))
    session.load("fig-6.1c")
    file.write_text(file.read_text().replace("own.py:Coward", "own.py:Other"))
    session.load(str(file))
    assert session.error == ""
    assert session.player.game.swarms[0].policy == "own.py:Other"


def test_a_file_of_the_start_is_read_and_no_other() -> None:
    policy = "learned(file='learned.json')"
    for name in ("learned.json", "other.json"):
        save_learned(Path(name), 1, [[], []])
    game = Game(swarms=(Swarm(policy=policy, size=2), Swarm(policy="avoid", size=2)))
    session = Session(Run(digest(game, 0), game, 0, (("own", ""),)))
    session.change_swarm(0, policy=f"{policy} + attack")
    assert session.error == ""
    session.change_swarm(0, policy="learned(file='other.json')")
    assert session.error.endswith(REFUSED)


def test_with_the_option_the_controls_name_any_code() -> None:
    session = Session("fig-6.1c", allow_code=True)
    session.change_swarm(0, policy="evil.py:Coward")
    assert (session.error, was_executed("evil")) == ("", True)
    session.load(str(own_scenario()))
    assert (session.error, was_executed("own")) == ("", True)
