"""Fit of the free parameters (section 2.7) to Table 6.1 with CMA-ES, on the learning games of Fig. 6.4.

Errors are noisy. All candidates of a generation are measured on the same seeds, and each generation has its
own seeds. The result is the mean of the search distribution, not the best candidate. It is compared with
the start values on seeds that the fit does not use.

The search depends only on its setup and on the measured shares. To resume, the search runs again and finds
most shares in the file.
"""

import math
from collections.abc import Callable, Generator, Mapping
from pathlib import Path
from typing import Any, Final, Self

import cma
import numpy as np
from pydantic import Field, model_validator

from kswarms.agents.common.arrays import Floats
from kswarms.agents.common.atomic_files import remove_temporary_files
from kswarms.agents.common.descriptions import FrozenModel
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.games import START, Candidate, Cell, texts_of, to_candidate, to_position
from kswarms.scenarios.calibration.shares import Play, Shares, read_shares
from kswarms.scenarios.description.scenario import DENSITIES
from kswarms.scenarios.study.directory import SHARES_FILE, make_directory, write_json

SPREAD: Final = 0.15
"""Standard deviation of the first generation, relative to the search range."""
VALIDATION_SEED: Final = 1000
"""First seed of the validation. Seeds of the catalogue (from 0) stay unused, to judge the result."""
FIT_SEED: Final = 10_000
"""First seed of the first generation."""
TRACE: Final = "calibration.json"
"""File of the trace of a fit."""

IntervalOf = Callable[[Floats, Callable[[Floats], Floats]], Any]
"""Returns a statistic of the mean over the seeds with its interval, as
`kswarms.analysis.statistics.intervals.bootstrap_interval` does."""


class Setup(FrozenModel):
    """Settings of a fit. Parameters that are not fitted keep their start values."""

    free: tuple[str, ...] = tuple(START)
    densities: tuple[int, ...] = Field(DENSITIES, min_length=1)  # the fitted rows of Table 6.1, by N
    seeds: int = Field(4, ge=1, le=1000)  # games for each cell and candidate
    generations: int = Field(25, ge=1, le=10_000)
    population: int = Field(0, ge=0, le=10_000)  # 0: default of CMA-ES, 4 + 3 ln(parameters)
    validation_seeds: int = Field(20, ge=6, le=FIT_SEED - VALIDATION_SEED)  # fewer than 6 have no interval

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in self.free:
            if name not in START:
                raise InputError("free", name, f"must be among {', '.join(START)}")
        if len(set(self.free)) < max(2, len(self.free)):
            raise InputError("free", ",".join(self.free), "must be two or more different parameters")
        if 0 < self.population < 4:
            raise InputError(
                "population", self.population, "must be at least 4, or 0 for the default of CMA-ES"
            )
        return self

    @property
    def start(self) -> Candidate:
        """Start values of the free parameters."""
        return {name: START[name] for name in self.free}


def error_of(shares: Floats, target: Floats) -> Floats:
    """Return the mean absolute error over cells (percentage points), shape (…).

    `shares`, shape (…, cells), are the shares of learners that learned to attack, averaged over seeds;
    `target`, shape (cells,), are the published shares (percent).
    """
    return np.asarray(np.abs(100.0 * shares - target).mean(axis=-1))


def calibrate(
    setup: Setup,
    target: Mapping[Cell, float],
    play: Play,
    interval_of: IntervalOf,
    out: Path,
    fresh: bool = False,
    report: Callable[[str], None] = lambda _: None,
) -> dict[str, Any]:
    """Search, validate, and decide whether the result is better than the start values.

    Parameters
    ----------
    target : mapping of (str, int) to float
        Table 6.1 (percent).
    out : Path
        Directory of ``shares.json``, from which a search of the same setup resumes (also with more
        generations), and of ``calibration.json``, the returned trace.
    fresh : bool
        Whether to delete an earlier fit in the directory.
    report : callable
        Called with a line of text after each generation.

    Returns
    -------
    dict
        ``setup``; ``start``, a candidate; ``generations``, each with ``first_seed``, ``points`` (candidates),
        ``errors`` (percentage points), and the ``mean`` (a candidate) and ``spread`` of the search after it;
        ``validation``, as `validate` returns it; ``result``: the texts ``parameters`` and ``rule``, and
        ``beats_start``.
    """
    rows = sorted({n for _, n in target})
    for n in setup.densities:
        if n not in rows:
            raise InputError("densities", n, f"must be among {', '.join(map(str, rows))}, as in Table 6.1")
    shares = _open_shares(setup, play, out, fresh)
    fitted = start = setup.start
    trace: dict[str, Any] = {"setup": setup.model_dump(mode="json"), "start": start, "generations": []}
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
    trace["validation"] = validate(of_start, of_fitted, np.array(list(target.values())), interval_of)
    parameters, rule = texts_of(fitted)
    beaten = trace["validation"]["gain_low"] > 0
    trace["result"] = {"parameters": parameters, "rule": rule, "beats_start": beaten}
    write_json(out / TRACE, trace)
    return trace


def summary(trace: dict[str, Any]) -> list[str]:
    """Return a few lines about the trace of a fit."""
    found, result = trace["validation"], trace["result"]
    seeds = trace["setup"]["validation_seeds"]
    return [
        f"error:      start values {found['start_error']:.2f}, fitted {found['fitted_error']:.2f}"
        f" (percentage points, {seeds} seeds not used by the fit)",
        f"gain:       {found['gain']:.2f}, 95 % interval {found['gain_low']:.2f} to {found['gain_high']:.2f}",
        f"start:      {'beaten' if result['beats_start'] else 'not beaten; the start values are kept'}",
        f"parameters: {result['parameters']}",
        f"rule:       {result['rule']}",
    ]


def _open_shares(setup: Setup, play: Play, out: Path, fresh: bool) -> Shares:
    """Create the directory and return the shares in it."""
    comparable = setup.model_dump(mode="json", include={"densities", "seeds", "population"})
    comparable["start"] = setup.start
    make_directory(out, SHARES_FILE, [TRACE])
    if fresh and (out / SHARES_FILE).exists():
        read_shares(out / SHARES_FILE)  # refuses a file of others
        for name in (SHARES_FILE, TRACE):
            (out / name).unlink(missing_ok=True)
    shares = Shares(out / SHARES_FILE, comparable, play)
    remove_temporary_files(out)
    shares.save()
    return shares


def _search(
    setup: Setup, target: Mapping[Cell, float], shares: Shares
) -> Generator[dict[str, Any], None, None]:
    """Yield the generations of the search."""
    cells = [cell for cell in target if cell[1] in setup.densities]
    published = np.array([target[cell] for cell in cells])
    rng = np.random.default_rng(FIT_SEED)
    options = {
        "bounds": [0.0, 1.0],
        "randn": lambda *shape: rng.standard_normal(shape),
        "seed": math.nan,  # does not seed numpy's global generator
        "verbose": -9,
    } | ({"popsize": setup.population} if setup.population else {})
    strategy = cma.CMAEvolutionStrategy(to_position(setup.start), SPREAD, options)
    for generation in range(setup.generations):
        first_seed = FIT_SEED + generation * setup.seeds
        positions = strategy.ask()
        candidates = [to_candidate(setup.free, position) for position in positions]
        measured = shares.measure(candidates, cells, range(first_seed, first_seed + setup.seeds))
        errors = [float(error_of(each.mean(axis=1), published)) for each in measured]
        strategy.tell(positions, errors)
        yield {
            "first_seed": first_seed,
            "points": candidates,
            "errors": errors,
            "mean": to_candidate(setup.free, strategy.result.xfavorite),
            "spread": float(strategy.sigma),
        }


def validate(start: Floats, fitted: Floats, target: Floats, interval_of: IntervalOf) -> dict[str, float]:
    """Compare the errors of two candidates on the same seeds (percentage points).

    `start` and `fitted` are shares of learners that learned to attack, shape (cells, seeds); `target`, shape
    (cells,), are the published shares (percent). The result has ``start_error``, ``fitted_error`` and their
    difference ``gain`` with its 95 % interval over the seeds, ``gain_low`` to ``gain_high``.
    """
    both = np.stack([start, fitted]).transpose(2, 0, 1)  # seeds, candidates, cells

    def gains(means: Floats) -> Floats:
        return error_of(means[:, 0], target) - error_of(means[:, 1], target)

    gain = interval_of(both, gains)
    start_error, fitted_error = map(float, error_of(both.mean(axis=0), target))
    errors = {"start_error": start_error, "fitted_error": fitted_error}
    return errors | {"gain": gain.estimate, "gain_low": gain.low, "gain_high": gain.high}
