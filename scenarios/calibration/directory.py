"""The directory of a calibration: its games, its trace, and the worlds that it found."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from kswarms.agents.common.atomic_files import remove_temporary_files
from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import read_worlds, write_worlds
from kswarms.scenarios.calibration.calibration import ensemble_of
from kswarms.scenarios.calibration.evidence import Evidence, Play, require_evidence
from kswarms.scenarios.runs.outcome import environment
from kswarms.scenarios.runs.run import code_version
from kswarms.scenarios.study.directory import GAMES_FILE, make_directory, write_json

TRACE: Final = "calibration.json"
"""File of the settings, the targets and the waves."""
WORLDS: Final = "ensemble.csv"
"""File of the ensemble: one world for each row, those nearest to all targets first."""


class Directory:
    """An open directory of a calibration, with the games in `evidence`."""

    def __init__(self, out: Path, about: Mapping[str, Any], evidence: Evidence) -> None:
        self.trace, self.worlds, self.evidence = out / TRACE, out / WORLDS, evidence
        self._content: dict[str, Any] = {**about, "waves": []}

    def write(self, wave: Mapping[str, Any]) -> None:
        """Write the trace with one more wave."""
        self._content["waves"].append(wave)
        write_json(self.trace, self._content)

    def finish(self, size: int) -> dict[str, Any]:
        """Write the trace with the ensemble of `size` worlds, and its free parameters as a table.

        Returns
        -------
        dict
            The ensemble (`ensemble_of`).
        """
        found = self._content["ensemble"] = ensemble_of(self._content["waves"], size)
        write_json(self.trace, self._content)
        if found["worlds"]:
            write_worlds(self.worlds, [world["parameters"] for world in found["worlds"]])
        return found


def read_ensemble(out: Path) -> tuple[Parameters, ...]:
    """Return the worlds that a calibration found.

    Raises
    ------
    InputError
        The directory has no finished calibration.
    """
    if not (out / WORLDS).is_file():
        raise InputError("calibration", str(out), "must be the directory of a finished `kswarms calibrate`")
    return read_worlds(out / WORLDS)


def open_calibration(out: Path, about: Mapping[str, Any], play: Play, fresh: bool = False) -> Directory:
    """Create the directory, or open that of a calibration with the same settings, code and versions.

    Parameters
    ----------
    about : mapping
        Settings and targets, as JSON.
    play : callable
        Plays the runs that are not in the directory.
    fresh : bool
        Whether to delete an earlier calibration in the directory.

    Raises
    ------
    InputError
        The directory has other files, or games of other settings, code or versions.
    """
    make_directory(out, GAMES_FILE, [TRACE, WORLDS])
    games = out / GAMES_FILE
    if fresh and games.exists():
        require_evidence(games)
        for path in (games, out / TRACE, out / WORLDS):
            path.unlink(missing_ok=True)
    about = {**about, "code": code_version(), "environment": environment()}  # results depend on them
    evidence = Evidence(games, about, play)
    remove_temporary_files(out)
    return Directory(out, about, evidence)
