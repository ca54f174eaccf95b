"""Named worlds: presets of the parameters, and the ensemble of worlds that calibration found."""

import csv
import math
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Final

from kswarms.agents.common.atomic_files import atomic_path
from kswarms.agents.common.descriptions import parse_number
from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import Parameters

PRESETS: Final = {
    "fitted": Parameters(),
    # The controller of the ARGoS measurements and the friction of its engine; the push share is fitted.
    "argos": Parameters(
        conflict_distance=0.10,
        front_half_angle=math.radians(67.5),
        flight_duration=1.0,
        fight_duration=1.0,
        turning_rate=3.927,
        flight_range=0.667,
        active_range=0.30,
        leg_mean=3.0,
        wander_turn=math.radians(120),
        wall_distance=0.10,
        wall_half_angle=math.pi / 4,
        wall_escape="away",
        station_radius=0.12,
        base_radius=0.12,
        base_range=0.667,
        friction=0.7,
        push_share=1.0,
    ),
}


_ENSEMBLE: Final = "ensemble:"


@cache
def ensemble() -> tuple[Parameters, ...]:
    """Return the worlds of the published calibration, those nearest to all targets first.

    Parameters that were not free have their defaults.
    """
    return read_worlds(Path(__file__).with_name("ensemble.csv"))


def read_worlds(path: Path) -> tuple[Parameters, ...]:
    """Return the worlds in the rows of a CSV file, whose header has names of parameters.

    Raises
    ------
    InputError
        The file cannot be read, or has other content.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file, strict=True))
        return tuple(Parameters(**{name: float(value) for name, value in row.items()}) for row in rows)
    except InputError:
        raise
    except (OSError, ValueError, TypeError, csv.Error):
        raise InputError(
            "worlds", str(path), "must be a CSV file of parameters, as of `kswarms calibrate`"
        ) from None


def write_worlds(path: Path, worlds: Sequence[Mapping[str, float]]) -> None:
    """Write the parameters of worlds, at least one, as a CSV file for `read_worlds`."""
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(worlds[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(worlds)


def parse_parameters(text: str) -> Parameters:
    """Parse the name of a preset, followed by changes of single parameters: ``"fitted, friction=0.3"``.

    ``"ensemble:7"`` is the seventh world of `ensemble`.
    """
    preset, *changes = (part.strip() for part in text.split(","))
    base = _named(preset)
    values: dict[str, str] = {}
    for change in changes:
        name, sign, value = (part.strip() for part in change.partition("="))
        if not sign:
            raise InputError("parameters", name, "after the preset, must be name=value")
        if values.setdefault(name, value) != value:
            raise InputError(f"parameters.{name}", value, "must be given once")
    return base.replace(**{name: parse_number(value) for name, value in values.items()})


def text_of(parameters: Parameters) -> str:
    """Return the shortest text that `parse_parameters` parses to these parameters."""
    texts = []
    for preset, defaults in PRESETS.items():
        changes = [f"{name}={value}" for name, value in parameters if value != getattr(defaults, name)]
        texts.append(", ".join([preset, *changes]))
    return min(texts, key=len)


def _named(name: str) -> Parameters:
    if name in PRESETS:
        return PRESETS[name]
    if not name.startswith(_ENSEMBLE):
        raise InputError(
            "parameters", name, f"must begin with one of {', '.join(PRESETS)}, or with {_ENSEMBLE}1"
        )
    worlds = ensemble()
    number = name.removeprefix(_ENSEMBLE)
    if not (number.isascii() and number.isdecimal() and 1 <= int(number[:9]) <= len(worlds)):
        raise InputError("parameters", name, f"must be {_ENSEMBLE}1 to {_ENSEMBLE}{len(worlds)}")
    return worlds[int(number) - 1]
