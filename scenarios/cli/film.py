"""``film``: a game, or part of it, as a film or a contact sheet."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Final

import typer
from PIL.Image import Image

from kswarms.agents.common.atomic_files import check_output
from kswarms.agents.common.errors import InputError
from kswarms.agents.common.quoting import for_file_name
from kswarms.analysis.film.files import check_film, write_film, write_sheet
from kswarms.analysis.film.painter import ArenaPainter
from kswarms.scenarios.cli.options import (
    ConditionName,
    Robots,
    RunDigest,
    Seed,
    Source,
    Trust,
    parse_path,
    resolve_run,
)
from kswarms.scenarios.cli.printing import print_line
from kswarms.scenarios.cli.progress import track
from kswarms.scenarios.runs.run import Run

_MAX_FRAMES: Final = 100_000
"""Maximum number of frames of a film: over an hour at 20 frames per second."""


def film(
    source: Source = None,
    run: RunDigest = "",
    trust: Trust = False,
    condition: ConditionName = None,
    n: Robots = None,
    seed: Seed = None,
    begin: Annotated[
        float,
        typer.Option("--from", help="First instant (s of the measured game, negative during learning)."),
    ] = 0.0,
    end: Annotated[float | None, typer.Option("--to", help="Last instant (s). [default: the end]")] = None,
    speed: Annotated[float, typer.Option(help="Seconds of the game per second of film, above 0.")] = 10.0,
    fps: Annotated[int, typer.Option(min=1, max=60, help="Frames per second.")] = 20,
    size: Annotated[int, typer.Option(min=64, max=4096, help="Width of a frame (pixels).")] = 720,
    sheet: Annotated[
        int | None,
        typer.Option(metavar="K", min=1, max=100, help="Write a contact sheet (PNG) of K instants instead."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            parser=parse_path,
            metavar="FILE",
            help="Film (.mp4, .gif) or sheet (.png). [default: a new file named after the game]",
        ),
    ] = None,
) -> None:
    """Film a game of a scenario, or a run of a results directory, from above.

    Example: kswarms film fig-6.1c --n 50 --to 120 --out fight.gif
    """
    found = resolve_run(source, run, trust, condition, n, seed)
    length, first = found.game.duration, 0.0 - found.game.learning
    end = length if end is None else end
    _check("from", begin, first <= begin < length, f"must be at least {first}, below {length}")
    _check("to", end, begin < end <= length, f"must be greater than {begin}, and at most {length}")
    _check("speed", speed, 0 < speed < math.inf, "must be greater than 0")
    if out is None:
        out = Path(_file_name(found) + (".mp4" if sheet is None else ".png"))
        _check("out", str(out), not out.exists(), "exists; give its name with --out to replace it")
    if sheet is None:
        check_film(out)
        step = speed / fps
        fits = (end - begin) / step < _MAX_FRAMES
        _check("speed", speed, fits, f"must be higher: a film has at most {_MAX_FRAMES:,} frames")
        instants = [begin + k * step for k in range(int((end - begin) / step + 1e-9) + 1)]
    else:
        _check("out", str(out), out.suffix == ".png", "must end with .png for a contact sheet")
        instants = [begin + (end - begin) * (k / (sheet - 1) if sheet > 1 else 1.0) for k in range(sheet)]
    check_output(out, "out")
    frames = _frames(found, instants, size)
    if sheet is None:
        write_film(out, frames, fps)
    else:
        write_sheet(out, list(frames))
    print_line(f"{'film' if sheet is None else 'sheet'}: {out}")


def _check(field: str, value: object, allowed: bool, rule: str) -> None:
    if not allowed:
        raise InputError(field, value, rule)


def _file_name(run: Run) -> str:
    scenario, condition = run.labels[0]
    parts = (scenario, condition, f"n{run.n}", f"seed{run.seed}")
    return for_file_name("-".join(part for part in parts if part))


def _frames(run: Run, instants: list[float], size: int) -> Iterator[Image]:
    """Play a run and paint it at each instant, up to the end of the game."""
    from kswarms.scenarios.runs.play import run_errors
    from kswarms.scenarios.watch.player import Player

    with run_errors(str(run)):
        player = Player(run.game, run.seed, record_conflicts=False)
    painter = ArenaPainter(player.model.arena, run.game.body.radius, size)
    for instant in track(instants, "filming", len(instants)):
        with run_errors(str(run)):
            player.seek(instant)
        now = player.snapshot()
        title = f"t = {now.time:.1f} s" if now.time >= 0 else f"learning, {-now.time:.1f} s to the game"
        yield painter.paint(
            title, now.pucks, now.positions, now.heading, now.swarm, now.in_action, now.carrying
        )
        if player.ended:
            break
