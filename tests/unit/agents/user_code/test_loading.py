"""Loading of user-defined classes, and errors with file and line."""

import sys
from pathlib import Path

import pytest

from kswarms.agents.common.errors import InputError
from kswarms.agents.policies.saved import snapshot_of
from kswarms.agents.policies.spec import parse_policies
from kswarms.agents.user_code.loading import load_class, sources
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.model.recorder import policy_rows, save_policies
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.runs.play import play
from kswarms.scenarios.runs.run import Run, digest

# Not imported: loaded by its reference.
OWN = (Path(__file__).parents[3] / "helpers" / "user_code.py").read_text()


@pytest.fixture(autouse=True)
def _change_to_a_directory_with_user_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("own.py").write_text(OWN)


def game(policy: str, **rest: object) -> Game:
    swarms = (Swarm(policy="avoid", size=3), Swarm(policy=policy, size=3))
    return Game(swarms=swarms, **{"duration": 40.0, **rest})


def files(policy: str) -> list[Path]:
    (spec,) = parse_policies(policy)
    return spec.files()


def play_out(policy: str) -> GameModel:
    model = GameModel(game(policy, learning=60.0), seed=0, record="conflicts,robots")
    model.play()
    return model


VALID = [
    "own.py:Cautious",
    "own.py:Cautious(patience=2, mood='low')",
    "./own.py:Cautious",
    "avoid + own.py:Cautious(patience=1)",
    "own.py:Needy(patience=2)",
    "own.py:Anything(a=1, b='x,y+z')",
    "own.py:Frozen",
    "own.py:Subclass(reward='own.py:Flat')",
    "inter-learner(reward='own.py:Flat(level=2.0)', rule='own.py:First(arm=1)')",
]


@pytest.mark.parametrize("text", VALID)
def test_a_user_defined_class_plays(text: str) -> None:
    model = play_out(text)
    assert model.ended == "time"
    assert model.results()[1]["policy"] == text
    assert sum(model.members[1][-1].conflicts) > 0


def at(code: str) -> str:
    """Return the place of some code of the file, as in an error."""
    return f"(own.py, line {next(k for k, line in enumerate(OWN.splitlines(), 1) if code in line)})"


INVALID = [
    ("no.py:X", "policy='no.py': must be a readable file (No such file or directory)", ""),
    ("my\0own.py:X", "policy='my\\x00own.py': must be a readable file (", ")"),
    ("learner(reward='my\\0own.py:X')", "policy.reward='my\\x00own.py': must be a readable file (", ")"),
    ("own.py:Cautio", "policy='own.py:Cautio': own.py has no class Cautio; its classes: Cautious, Needy", ""),
    ("own.py:NUMBER", "policy='own.py:NUMBER': own.py has no class NUMBER; its classes:", ""),
    ("own.py:", "policy='own.py:': must be path/to/my_file.py:MyClass or package.module:MyClass", ""),
    (":Cautious", "policy=':Cautious': must be path/to", ""),
    ("own.py:A.B", "policy='own.py:A.B': must be path/to", ""),
    ("own.py:NoPolicy", "policy='own.py:NoPolicy': is no policy: it lacks choose", ""),
    ("own.py:Endless", "policy='own.py:Endless': is no policy: it lacks freeze, since it learns", ""),
    ("own.py:Alone", "policy='own.py:Alone': must take a Setting as its first argument", ""),
    ("own.py:Cautious(p=1)", "policy.p=1: unknown field; allowed: patience, mood", ""),
    ("own.py:Cautious(3)", "policy='own.py:Cautious(3)': must be name or name(key=value, …)", ""),
    ("own.py:Needy", "policy.patience=None: is required", ""),
    ("own.py:Fussy", "policy='own.py:Fussy': its constructor raises ValueError: ", at("math.sqrt(")),
    ("own.py:Wordy", "policy='own.py:Wordy': choose(0) must return an action of the game, not 'fight'", ""),
    ("own.py:Broken", "policy='own.py:Broken': its trial raises AttributeError: ", at("self.fights")),
    ("own.py:Library", "policy='own.py:Library': its trial raises ValueError: ", at("np.concatenate")),
    ("own.py:Silent", "policy='own.py:Silent': learn(…) must return two floats, R and Q, not None", ""),
    ("own.py:Stuck", "policy='own.py:Stuck': its trial raises RuntimeError: cannot stop ", at("cannot")),
    ("own.py:Boastful", "policy='own.py:Boastful': snapshot() must be like Learner.snapshot() (", "'count')"),
    ("learner(reward='own.py:Void')", "policy.reward='own.py:Void': Void must define of", ""),
    ("learner(reward='own.py:First')", "policy.reward='own.py:First': must be a subclass of kswarms.", ""),
    ("learner(reward='own.py:NaN')", "policy.reward='own.py:NaN': of(2.3, 0.0, ", "not nan"),
    ("learner(reward='own.py:Nothing')", "policy.reward='own.py:Nothing': of(2.3, 0.0, ", "not None"),
    ("learner(reward='own.py:Zero')", "policy.reward='own.py:Zero': its trial raises Zero", at("t_a / t_p")),
    ("learner(reward='own.py:Flat(level=\"x\")')", "policy.reward.level='x': must be a number", ""),
    ("learner(reward='own.py:Flat(up=1)')", "policy.reward.up=1: unknown field; allowed: level", ""),
    ("learner(reward='own.py:Needing')", "policy.reward.gain=None: is required", ""),
    ("learner(rule='own.py:Flat')", "policy.rule='own.py:Flat': must be a ", "selection_rules.Rule"),
    ("learner(rule='own.py:First(arm=2)')", "policy.rule='own.py:First': prefer(…) must return 0 to 1", ""),
    ("learner(rule='own.py:Lost')", "policy.rule='own.py:Lost': its trial raises Attr", at("bandit.counts")),
    ("learner(rule='own.py:Greater')", "policy.rule='own.py:Greater': factor must be ", "2.0"),
    ("own.py:Subclass(reward='x.py:Y')", "policy.reward='x.py': must be a readable", ""),
    ("nowhere.at_all:X", "policy='nowhere.at_all:X': importing nowhere.at_all", "named 'nowhere'"),
    ("sys:X", "policy='sys:X': sys has no class X; its classes: none", ""),
    ("json:JSONDecoder", "policy='json:JSONDecoder': is no policy: it lacks choose", ""),
]


@pytest.mark.parametrize(("text", "begin", "end"), INVALID, ids=[row[0] for row in INVALID])
def test_errors_surface_when_the_model_is_created(text: str, begin: str, end: str) -> None:
    with pytest.raises(InputError) as caught:
        GameModel(game(text))
    line = str(caught.value).removeprefix("swarms.1.")
    assert line.startswith(begin)
    assert line.endswith(end)
    assert len(line.splitlines()) == 1


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("x = 1\n\ny = x / 0\n", r"importing bad\.py raises ZeroDivisionError: .* \(bad\.py, line 3\)$"),
        ("def x(:\n", r"importing bad\.py raises SyntaxError: .* \(bad\.py, line 1\)$"),
        ("import not_there\n", r"raises ModuleNotFoundError: No module named 'not_.*' \(bad\.py, line 1\)$"),
        ("import sys\nsys.exit('no')\n", r"importing bad\.py raises SystemExit: no \(bad\.py, line 2\)$"),
        ("raise ValueError\n", r"importing bad\.py raises ValueError \(bad\.py, line 1\)$"),
    ],
)
def test_errors_of_an_import_have_a_line(code: str, message: str) -> None:
    Path("bad.py").write_text(code)
    described = game("bad.py:X")
    with pytest.raises(InputError, match=message):
        GameModel(described)


def test_a_file_is_executed_once_for_each_content() -> None:
    counting = OWN + "\nwith open('executed', 'a') as log:\n    log.write('x')\n"
    Path("own.py").write_text(counting)
    first, again = (load_class("policy", "own.py:Cautious") for _ in range(2))
    assert first is again
    assert play_out("own.py:Cautious").ended
    assert Path("executed").read_text() == "x"
    Path("own.py").write_text(counting + "# changed\n")
    assert load_class("policy", "own.py:Cautious") is not first
    assert Path("executed").read_text() == "xx"


def test_files_of_the_same_name_in_two_directories_are_distinguished(monkeypatch: pytest.MonkeyPatch) -> None:
    here = load_class("policy", "own.py:Cautious")
    Path("below").mkdir()
    Path("below/own.py").write_text(OWN)
    there = load_class("policy", "below/own.py:Cautious")
    monkeypatch.chdir("below")
    assert load_class("policy", "own.py:Cautious") is there
    assert there is not here


def test_a_module_of_a_package_in_the_current_directory_plays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [entry for entry in sys.path if entry != ""])
    Path("my_pack_1/deep").mkdir(parents=True)
    for name in ("__init__.py", "deep/__init__.py", "other.py"):
        Path("my_pack_1", name).touch()
    Path("my_pack_1/deep/own.py").write_text(OWN)
    text = "my_pack_1.deep.own:Cautious(patience=1)"
    assert play_out(text).members[1][0].policy.patience == 1
    found = [path.relative_to(Path.cwd() / "my_pack_1").as_posix() for path in files(text)]
    assert found == ["__init__.py", "deep/__init__.py", "deep/own.py", "other.py"]
    Path("my_single_1.py").write_text(OWN)
    assert [path.name for path in sources("policy", "my_single_1:Cautious")] == ["my_single_1.py"]


def test_a_learner_with_a_snapshot_is_recorded_and_saved() -> None:
    model = play_out("own.py:Tally")
    assert policy_rows(model) == [
        {"swarm": 2, "opponent": 1, "action": action, "share": share, "attack_share": 1.0}
        for action, share in (("flight", 0.0), ("fight", 1.0))
    ]
    closed = [row for row in rows_of(model) if row["swarm"] == 2 and row["phase"] == "learning"]
    assert {row["reward"] for row in closed} >= {1.0}
    save_policies(model, 2, Path("tally.json"))
    again = play_out("learned(file='tally.json')")
    against = [row for row in rows_of(again) if (row["swarm"], row["opponent_swarm"]) == (2, 1)]
    assert {row["action"] for row in against} == {"fight"}


def rows_of(model: GameModel) -> list[dict[str, object]]:
    columns = model.tables()["conflicts"]
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def test_a_learner_without_a_snapshot_has_no_rows() -> None:
    model = play_out("own.py:Frozen")
    assert policy_rows(model) == []
    assert [snapshot_of(robot.policy) for robot in model.robots] == [[]] * 6
    with pytest.raises(InputError, match="swarm=2: must be a swarm of learners"):
        save_policies(model, 2, Path("frozen.json"))


def test_learning_ends_with_the_learning_phase() -> None:
    model = GameModel(game("own.py:Tally", learning=60.0), seed=0)
    model.env.run(until=600)
    before = [snapshot_of(robot.policy) for robot in model.members[1]]
    assert sum(arm["count"] for arms in before for arm in arms) > 0
    model.play()
    assert [snapshot_of(robot.policy) for robot in model.members[1]] == before


def test_files_of_a_policy() -> None:
    Path("data.json").write_text("{}")
    assert files("avoid") == files("flight") == files("learner(reward='wlu', rule='ucb')") == []
    assert files("own.py:Anything(file='data.json')") == [Path("own.py"), Path("data.json")]
    assert files("own.py:Anything(file='other.json', note='a:b')") == [Path("own.py")]
    assert files("learner(reward='own.py:Flat', rule='./own.py:First(arm=1)')") == [Path("own.py")] * 2


def test_the_digest_of_a_run_covers_user_code() -> None:
    described = game("own.py:Cautious")
    before = digest(described, 0)
    assert digest(described, 0) == before
    Path("own.py").write_text(OWN.replace("patience=3", "patience=4"))
    changed = digest(described, 0)
    assert changed != before
    Path("own.py").write_text(OWN)
    assert digest(described, 0) == before


@pytest.mark.parametrize("policy", ["own.py:Cautious", "learner(rule='own.py:First')"])
def test_a_run_is_refused_after_its_code_has_changed(policy: str) -> None:
    described = game(policy)
    run = Run(digest(described, 0), described, 0, (("mine", ""),))
    assert len(play(run).swarms) == 2
    Path("own.py").write_text(OWN + "\n# another version\n")
    with pytest.raises(RunError, match=r"policy='own.py': must not change while its games are played"):
        play(run)
