"""``calibrate``: find the worlds that meet all targets."""

from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.options import CPUS, Jobs, parse_path
from kswarms.scenarios.cli.printing import print_line
from kswarms.scenarios.cli.progress import play_tracked
from kswarms.scenarios.description.text import split_words
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run


def calibrate(
    targets: Annotated[
        str, typer.Option(metavar="NAME|FILE", help="Built-in targets (chapter-6), or a TOML file.")
    ] = "chapter-6",
    free: Annotated[
        str | None,
        typer.Option(metavar="NAME,...", help="Free parameters of docs/calibration.md. [default: all]"),
    ] = None,
    size: Annotated[int, typer.Option(help="Worlds of the ensemble, at least 2.")] = 30,
    tries: Annotated[int, typer.Option(help="Worlds of a wave.")] = 64,
    waves: Annotated[int, typer.Option(help="Maximum number of waves.")] = 4,
    factor: Annotated[
        float, typer.Option(help="Factor on all tolerances for a place in the next stage.")
    ] = 1.5,
    jobs: Jobs = CPUS,
    out: Annotated[
        Path,
        typer.Option(
            parser=parse_path, metavar="DIR", help="Output directory; a calibration in it is resumed."
        ),
    ] = Path("calibration"),
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Delete the calibration in DIR and start a new one.")
    ] = False,
) -> None:
    """Find an ensemble of worlds that meet all targets. The same command resumes an interrupted one.

    Example: kswarms calibrate --free friction,gamma --size 10
    """
    from kswarms.analysis.findings.worlds.targets import read_targets
    from kswarms.scenarios.calibration.calibration import Setup, Stage, calibrate, worst_of
    from kswarms.scenarios.calibration.directory import open_calibration
    from kswarms.scenarios.calibration.evidence import require_games

    options: dict[str, Any] = {"size": size, "tries": tries, "waves": waves, "factor": factor}
    if free is not None:
        options["free"] = split_words(free)
    setup, chosen = Setup(**options), read_targets(targets)
    stages = [
        Stage(
            chosen.curves(number),
            seeds,
            partial(_outputs, chosen, number),
            tuple(target.id for target in chosen.of_stage(number)),
            partial(chosen.implausibility, number),
        )
        for number, seeds in enumerate(chosen.seeds, 1)
    ]
    for stage in stages:
        require_games(stage.curves)
    about = {"setup": setup.model_dump(mode="json"), "targets": chosen.model_dump(mode="json")}
    directory = open_calibration(out, about, partial(play_runs, jobs), fresh)
    for number, wave in enumerate(calibrate(setup, stages, directory.evidence), 1):
        directory.write(wave)
        met = sum(worst_of(world) <= 1 for world in wave["worlds"])
        print_line(
            f"wave {number}: of {wave['passed'][0]} worlds, {len(wave['worlds'])} are near all targets,"
            f" and {met} meet them"
        )
    found = directory.finish(size)
    if not found["worlds"]:
        raise InputError("factor", factor, "must be larger: no world is near all targets")
    print_line(f"ensemble: {len(found['worlds'])} worlds within {found['factor']:.3g} times the tolerances")
    print_line(f"worlds: {directory.worlds}")
    print_line(f"trace: {directory.trace}")


def _outputs(targets: Any, stage: int, rows: Any) -> Any:
    from kswarms.analysis.results.runs import Results

    return targets.outputs(stage, Results.of_rows(rows.swarms, rows.policies))


def play_runs(jobs: int, runs: Sequence[Run]) -> Generator[tuple[Run, Outcome], None, None]:
    """Play runs with a progress bar."""
    with closing(play_tracked(runs, jobs, "", "playing")) as played:
        yield from played
