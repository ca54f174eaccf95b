"""Inputs of the fuzz test: calls of the public names of `kswarms` with arguments that nobody means."""

import inspect
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any, Final

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import kswarms
from kswarms import CATALOGUE, FINDINGS, Action, Game, GameModel, Setting, read_results
from kswarms.agents.streams import Streams
from tests.fuzz.command_lines import SCENARIO
from tests.fuzz.harness import Input
from tests.fuzz.values import BYTES, JUNK, mutate

OBJECTS: Final = (
    *JUNK,
    *BYTES,
    *(
        np.int64(3),
        np.float32(-0.0),
        np.bool_(True),
        np.nan,
        np.arange(3),
        np.array(["x"]),
        np.datetime64("2020"),
    ),
    *(
        1 + 2j,
        object(),
        object,
        print,
        lambda: None,
        lambda *_: None,
        iter([]),
        range(10**9),
        Path("x"),
        b"avoid",
    ),
    *(
        pd.DataFrame(),
        pd.DataFrame({"n": [1]}),
        Figure(),
        Streams(0, 0),
        kswarms.Parameters(),
        {1, 2},
        (True,),
    ),
)
ACTIONS: Final = (
    Action(name="flight", direction=-1, duration=1.0),
    Action(name="fight", direction=1, duration=1.0),
)
SETTING: Final = Setting(0, 2, ACTIONS, Streams(0, 0))
WORLD: Final[dict[str, Any]] = {
    key: value for key, value in SCENARIO["conditions"][1].items() if key not in ("name", "swarms")
}
SWARMS: Final = [{"policy": "avoid", "size": 2}, {"policy": "attack", "size": 2, "drive": 0.5}]


def _results(directory: Path) -> Any:
    return read_results(directory / "study")


def _calls(directory: Path) -> dict[str, dict[str, Any]]:
    """Return valid keyword arguments of each public callable; paths are of the working directory."""
    study = directory / "study"
    results = _results(directory)
    scenario = results.runs["scenario"].iloc[0]
    return {
        "Action": {"name": "x", "direction": 1, "duration": 1.0},
        "Bandit": {"arms": 2},
        "Body": {"name": "b", "radius": 0.1, "sensor_range": 0.5, "top_speed": 0.2},
        "Condition": {**WORLD, "swarms": [{"policy": "avoid"}, {"policy": "attack"}], "multiple_of": 2},
        "Finding": {**FINDINGS[0].model_dump()},
        "ForagingModel": {
            "n": 4,
            "policies": "avoid,attack",
            "shares": "1:1",
            "drives": "0.6,0.5/0.7",
            "seed": 1,
            "record": "model",
            "duration": 2.0,
            "side": 2.0,
        },
        "Game": {**WORLD, "swarms": SWARMS, "absent": [1], "absent_from": "game"},
        "GameModel": {"game": Game(swarms=SWARMS, duration=2.0), "seed": 1, "record": "robots"},
        "Learner": {
            "setting": SETTING,
            "about": "both",
            "reward": "wlu(delta=0.1)",
            "rule": "ucb",
            "otherwise": "",
        },
        "Parameters": dict(kswarms.Parameters()),
        "Results": {"runs": results.runs, "policies": results.policies},
        "Scenario": {**SCENARIO},
        "Setting": {"swarm": 0, "swarms": 2, "actions": ACTIONS, "streams": Streams(0, 0), "place": 0},
        "Study": {"directory": study, "command": "x"},
        "Swarm": {"policy": "avoid", "size": 2, "drive": 0.5, "drive_action": 0.5},
        "SwarmRule": {"policy": "avoid", "share": 2, "drive": 0.5, "drive_action": 0.5},
        "figure_of": {"runs": results.runs, "scenario": scenario, "title": "x", "detail": True},
        "judge": {"finding": FINDINGS[0], "results": results},
        "judge_all": {"results": results, "findings": FINDINGS[:2]},
        "make_policy": {"policy": "learner(rule='ucb')", "setting": SETTING},
        "read_conflicts": {"directory": study, "runs": None, "seen": False},
        "read_findings": {"path": directory / "findings.toml"},
        "read_results": {"source": study, "scenario": "sweep"},
        "read_scenarios": {"path": directory / "tiny.toml"},
        "save_figure": {"figure": Figure(), "path": directory / "figures" / "x.png"},
    }


def python_call(rng: Random, directory: Path) -> Input:
    """Return a call of a public name with arguments replaced, removed and added."""
    name, keywords = rng.choice(sorted(_calls(directory).items()))
    changed = dict(keywords)
    for _ in range(rng.choice((1, 1, 2))):
        key = rng.choice(sorted(changed)) if changed else ""
        how = rng.choice(("replace", "replace", "replace", "mutate", "remove", "add"))
        if how == "mutate" and isinstance(changed.get(key), dict | list):
            changed[key] = mutate(rng, changed[key], OBJECTS)
        elif how == "remove":
            changed.pop(key, None)
        elif how == "add":
            changed[rng.choice(("x", "self", "n", "side", "duration", "seed"))] = rng.choice(OBJECTS)
        else:
            changed[key] = rng.choice(OBJECTS)
    description = ", ".join(
        f"{key}={value!r:.200}" for key, value in changed.items() if value is not keywords.get(key)
    )
    removed = keywords.keys() - changed.keys()
    return Input(f"{name}({description}) without {sorted(removed)}", call=lambda: _call(name, changed))


def _call(name: str, keywords: dict[str, Any]) -> None:
    function: Callable[..., Any] = getattr(kswarms, name)
    try:
        if not isinstance(function, type) or not hasattr(function, "model_fields"):
            inspect.signature(function).bind(**keywords)
    except TypeError:  # Python itself refuses missing and unknown arguments
        return
    result = function(**keywords)
    if isinstance(result, GameModel):
        periods = (result.game.learning + result.game.duration) / result.game.parameters.period
        samples = (result.game.learning + result.game.duration) / result.game.sample_period
        if result.game.size * (periods + samples) < 5000:
            result.play()
    assert name != "CATALOGUE" or CATALOGUE


GENERATORS: Final[dict[str, Callable[[Random, Path], Input]]] = {"python": python_call}
