"""Fits the free parameters of section 2.7 to Table 6.1: CMA-ES on what the robots of Fig. 6.4 learn.

The table is reached by few seeds, so every error is noisy. All points of a generation are measured on the
same seeds, each generation on seeds of its own, and what is taken in the end is the mean of the search
distribution, an average over many points, not the point that was luckiest. It is then compared with the
start values on seeds that the fit has not used.

The search is a function of its setup and of the shares measured, so nothing of it is kept but these: to go
on after an interruption is to search again and to find most games played.
"""

import math
from collections.abc import Callable, Generator, Mapping
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from pydantic import Field, model_validator

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.atomic_files import remove_temporary_files
from kswarms.agents.common.descriptions import Checked
from kswarms.agents.common.errors import InputError
from kswarms.analysis.statistics.intervals import bootstrap_interval
from kswarms.scenarios.calibration.games import START, Cell, Play, Point, Shares, texts, to_place, to_point
from kswarms.scenarios.description.scenario import DENSITIES
from kswarms.scenarios.study.directory import make_directory, write_json

SPREAD: Final = 0.15
"""Standard deviation of the first generation, as a part of the range searched."""
VALIDATION_SEED: Final = 1000
"""First seed of the validation; the catalogue's own seeds, from 0, are left to those who judge the result."""
FIT_SEED: Final = 10_000
"""First seed of the first generation."""

_SHARES: Final = "shares.json"
TRACE: Final = "calibration.json"
"""The file that a fit can be read from."""


class Setup(Checked):
    """What is fitted, and to what.

    Attributes
    ----------
    free : tuple of str
        The parameters that are fitted, two at least, of `START`; the others keep their start values.
    densities : tuple of int
        The rows of Table 6.1 that are fitted, by N.
    seeds : int
        Games for each cell and point.
    generations : int
        Generations of the search.
    population : int
        Points in a generation; 0: 4 + 3 ln(parameters), the usual number.
    validation_seeds : int
        Games for each cell in the validation, 6 at least: fewer have no interval.

    Raises
    ------
    InputError
        If a value is not allowed.
    """

    free: tuple[str, ...] = tuple(START)
    densities: tuple[int, ...] = Field(DENSITIES, min_length=1)
    seeds: int = Field(4, ge=1, le=1000)
    generations: int = Field(25, ge=1, le=10_000)
    population: int = Field(0, ge=0, le=10_000)
    validation_seeds: int = Field(20, ge=6, le=FIT_SEED - VALIDATION_SEED)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in self.free:
            if name not in START:
                raise InputError("free", name, f"must be among {', '.join(START)}")
        if len(set(self.free)) < max(2, len(self.free)):
            raise InputError("free", ",".join(self.free), "must be two or more different parameters")
        if 0 < self.population < 4:
            raise InputError("population", self.population, "must be at least 4, or 0 for the usual number")
        return self


def error_of(shares: Floats, target: Floats) -> float:
    """Return the mean absolute error over cells (percentage points).

    Parameters
    ----------
    shares : ndarray of float64, shape (cells, seeds)
        Share of learners that learned to attack.
    target : ndarray of float64, shape (cells,)
        What the table says (percent).
    """
    return float(np.abs(100.0 * shares.mean(axis=1) - target).mean())


def calibrate(
    setup: Setup,
    target: Mapping[Cell, float],
    play: Play,
    out: Path,
    fresh: bool = False,
    report: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Search, validate, and say whether the start values are beaten.

    Parameters
    ----------
    setup : Setup
        What is fitted.
    target : mapping of (str, int) to float
        Table 6.1 (percent).
    play : Play
        Plays runs.
    out : Path
        Directory of ``shares.json``, from which an interrupted search of the same setup goes on (with more
        generations too), and ``calibration.json``, what is returned.
    fresh : bool
        Whether to forget what the directory holds.
    report : callable
        Told a line after each generation.

    Returns
    -------
    dict
        ``setup``; ``start``, the point; ``generations``, each with its ``first_seed``, ``points``, ``errors``
        (percentage points), and ``mean`` (a point) and ``spread`` of the search after it; ``validation``, as
        `validate` returns it; ``result``: ``parameters`` and ``rule``, texts, and ``beats_start``.

    Raises
    ------
    InputError
        If a density is not in the table, or the directory cannot be used.
    """
    rows = sorted({n for _, n in target})
    for n in setup.densities:
        if n not in rows:
            raise InputError("densities", n, f"must be among {', '.join(map(str, rows))}, as in Table 6.1")
    shares = _open(setup, play, out, fresh)
    start = _start(setup)
    trace: dict[str, Any] = {"setup": setup.model_dump(mode="json"), "start": start, "generations": []}
    fitted = start
    for generation in _search(setup, target, shares):
        trace["generations"].append(generation)
        write_json(out / TRACE, trace)
        fitted = generation["mean"]
        report(
            f"generation {len(trace['generations'])} of {setup.generations}: "
            f"errors {min(generation['errors']):.2f} to {max(generation['errors']):.2f}, "
            f"spread {generation['spread']:.3f}, mean {', '.join(f'{k}={v:g}' for k, v in fitted.items())}"
        )
    seeds = range(VALIDATION_SEED, VALIDATION_SEED + setup.validation_seeds)
    of_start, of_fitted = shares.measure([start, fitted], list(target), seeds)
    trace["validation"] = validate(of_start, of_fitted, np.array(list(target.values())))
    parameters, rule = texts(fitted)
    beaten = trace["validation"]["gain_low"] > 0
    trace["result"] = {"parameters": parameters, "rule": rule, "beats_start": beaten}
    write_json(out / TRACE, trace)
    return trace


def summary(trace: dict[str, Any]) -> list[str]:
    """Return in a few lines what came out of a fit, as `calibrate` returns it."""
    found, result = trace["validation"], trace["result"]
    seeds = trace["setup"]["validation_seeds"]
    return [
        f"error:      start values {found['start_error']:.2f}, fitted {found['fitted_error']:.2f}"
        f" (percentage points, {seeds} seeds that were not fitted)",
        f"gain:       {found['gain']:.2f}, 95 % interval {found['gain_low']:.2f} to {found['gain_high']:.2f}",
        f"start:      {'beaten' if result['beats_start'] else 'not beaten: it is kept'}",
        f"parameters: {result['parameters']}",
        f"rule:       {result['rule']}",
    ]


def _start(setup: Setup) -> Point:
    return {name: START[name] for name in setup.free}


def _open(setup: Setup, play: Play, out: Path, fresh: bool) -> Shares:
    """Return the shares that the directory holds, after making sure that it is there and can be written."""
    comparable = setup.model_dump(mode="json", include={"densities", "seeds", "population"})
    comparable["start"] = _start(setup)
    make_directory(out)
    try:
        if fresh:
            for name in (_SHARES, TRACE):
                (out / name).unlink(missing_ok=True)
        shares = Shares(out / _SHARES, comparable, play)
        remove_temporary_files(out)
        shares.save()
    except OSError as error:
        raise InputError("out", str(out), f"must be a writable directory ({error.strerror})") from error
    return shares


def _search(
    setup: Setup, target: Mapping[Cell, float], shares: Shares
) -> Generator[dict[str, Any], None, None]:
    """Yield the generations of the search."""
    import cma  # here, since it brings matplotlib where that is installed

    cells = [cell for cell in target if cell[1] in setup.densities]
    wanted = np.array([target[cell] for cell in cells])
    draws = np.random.default_rng(FIT_SEED)
    options = {
        "bounds": [0.0, 1.0],
        "randn": lambda *shape: draws.standard_normal(shape),
        "seed": math.nan,  # leaves numpy's global generator alone
        "verbose": -9,
    } | ({"popsize": setup.population} if setup.population else {})
    strategy = cma.CMAEvolutionStrategy(to_place(_start(setup)), SPREAD, options)
    for generation in range(setup.generations):
        first_seed = FIT_SEED + generation * setup.seeds
        places = strategy.ask()
        points = [to_point(setup.free, place) for place in places]
        measured = shares.measure(points, cells, range(first_seed, first_seed + setup.seeds))
        errors = [error_of(each, wanted) for each in measured]
        strategy.tell(places, errors)
        yield {
            "first_seed": first_seed,
            "points": points,
            "errors": errors,
            "mean": to_point(setup.free, strategy.result.xfavorite),
            "spread": float(strategy.sigma),
        }


def validate(start: Floats, fitted: Floats, target: Floats) -> dict[str, float]:
    """Compare two points on the same seeds.

    Parameters
    ----------
    start, fitted : ndarray of float64, shape (cells, seeds)
        Shares of learners that learned to attack.
    target : ndarray of float64, shape (cells,)
        What the table says (percent).

    Returns
    -------
    dict
        ``start_error``, ``fitted_error``, and ``gain``, the former less the latter, with its 95 % interval
        ``gain_low``, ``gain_high`` over the seeds (percentage points).
    """
    both = np.stack([start, fitted]).transpose(2, 0, 1)  # seeds, points, cells

    def gains(means: Floats) -> Floats:
        errors = np.abs(100.0 * means - target).mean(axis=-1)
        return np.asarray(errors[:, 0] - errors[:, 1])

    gain = bootstrap_interval(both, gains)
    return {
        "start_error": error_of(start, target),
        "fitted_error": error_of(fitted, target),
        "gain": gain.estimate,
        "gain_low": gain.low,
        "gain_high": gain.high,
    }
