"""The directory of a calibration: its games, its trace, and the worlds that it found."""

import json
from pathlib import Path
from typing import Any, Final

from kswarms.agents.common.atomic_files import remove_temporary_files
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.input_files import read_json
from kswarms.scenarios.calibration.evidence import Evidence, Play
from kswarms.scenarios.study.directory import GAMES_FILE, make_directory, write_json

TRACE: Final = "calibration.json"
"""File of the settings, the targets and the waves."""
ENSEMBLE: Final = "ensemble.json"
"""File of the worlds of the last wave."""


class Directory:
    """An open directory of a calibration."""

    def __init__(self, out: Path, about: dict[str, Any], evidence: Evidence) -> None:
        self._out, self._trace, self.evidence = out, {**about, "waves": []}, evidence
        self.ensemble = out / ENSEMBLE

    def write(self, wave: dict[str, Any]) -> None:
        """Write the trace with one more wave, and the worlds of the wave."""
        self._trace["waves"].append(wave)
        write_json(self._out / TRACE, self._trace)
        write_json(self.ensemble, {"factor": wave["factor"], "worlds": wave["worlds"]})


def open_calibration(out: Path, about: dict[str, Any], play: Play, fresh: bool) -> Directory:
    """Create the directory, or open that of a calibration with the same settings and targets.

    Raises
    ------
    InputError
        The directory has another calibration (and not `fresh`), or other files.
    """
    make_directory(out, GAMES_FILE, [TRACE, ENSEMBLE])
    if fresh:
        for name in (GAMES_FILE, TRACE, ENSEMBLE):
            (out / name).unlink(missing_ok=True)
    remove_temporary_files(out)
    if (out / TRACE).exists():
        before = read_json("out", out / TRACE)
        if {name: before.get(name) for name in about} != json.loads(json.dumps(about)):
            raise InputError("out", str(out), "has another calibration; use another directory, or --fresh")
    evidence = Evidence(out / GAMES_FILE, play)
    (out / GAMES_FILE).touch()
    write_json(out / TRACE, {**about, "waves": []})
    return Directory(out, about, evidence)
