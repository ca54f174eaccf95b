"""``film``: a game, or a stretch of it, as a film or a contact sheet."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.options import ConditionName, Robots, RunDigest, Seed, Watched, one_run
from kswarms.scenarios.cli.progress import tracked

if TYPE_CHECKING:
    from PIL.Image import Image

    from kswarms.analysis.film.painter import ArenaPainter
    from kswarms.scenarios.watch.player import Picture, Player

_MOST_PICTURES: Final = 100_000
"""Of a film: over an hour at the usual 20 a second."""


def film(
    what: Watched = None,
    run: RunDigest = "",
    condition: ConditionName = None,
    n: Robots = None,
    seed: Seed = None,
    begin: Annotated[
        float,
        typer.Option("--from", help="First instant: seconds of the measured game, negative in the learning."),
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option("--to", help="Last instant (s). [default: the end of the game]")
    ] = None,
    speed: Annotated[
        float, typer.Option(help="Seconds of the game in a second of the film, above 0.")
    ] = 10.0,
    fps: Annotated[int, typer.Option(help="Pictures a second, 1 to 60.")] = 20,
    size: Annotated[int, typer.Option(help="Width of a picture (pixels), 64 to 4096.")] = 720,
    sheet: Annotated[
        int | None,
        typer.Option(metavar="K", help="Write a contact sheet of K instants, 1 to 100, instead: a PNG."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="An .mp4 or .gif, with --sheet a .png. [default: by the game]"),
    ] = None,
) -> None:
    """Film a game of a scenario, or a run of a results directory, from above."""
    found = one_run(what, run, condition, n, seed)
    game = found.game
    end = game.duration if end is None else end
    first = 0.0 - game.learning
    _check("from", begin, first <= begin < game.duration, f"must be at least {first}, below {game.duration}")
    _check(
        "to", end, begin < end <= game.duration, f"must be greater than {begin}, and at most {game.duration}"
    )
    _check("speed", speed, 0 < speed < math.inf, "must be greater than 0")
    _check("fps", fps, 1 <= fps <= 60, "must be in 1 to 60")
    _check("size", size, 64 <= size <= 4096, "must be in 64 to 4096")
    _check("sheet", sheet, sheet is None or 1 <= sheet <= 100, "must be in 1 to 100")
    scenario, curve = found.labels[0]
    name = "-".join(part for part in (scenario, curve, f"n{found.n}", f"seed{found.seed}") if part)
    name = name.replace("/", "-")  # a curve may be called as its user likes
    out = out or Path(f"{name}{'.mp4' if sheet is None else '.png'}")

    from kswarms.analysis.film.files import check_film, write_film, write_sheet
    from kswarms.scenarios.runs.play import run_errors
    from kswarms.scenarios.watch.player import Player

    if sheet is None:
        check_film(out)
        step = speed / fps
        fits = (end - begin) / step < _MOST_PICTURES
        _check("speed", speed, fits, f"must be so high that there are at most {_MOST_PICTURES:,} pictures")
        instants = [begin + k * step for k in range(int((end - begin) / step + 1e-9) + 1)]
    else:
        _check("out", str(out), out.suffix == ".png", "must end with .png for a contact sheet")
        instants = [begin + (end - begin) * (k / (sheet - 1) if sheet > 1 else 1.0) for k in range(sheet)]
    if not out.parent.is_dir():
        raise InputError("out", str(out), "must be in a directory that is there")
    with run_errors(str(found)):
        player = Player(game, found.seed)
    try:
        pictures = _pictures(player, instants, size, str(found))
        if sheet is None:
            write_film(out, pictures, fps)
        else:
            write_sheet(out, list(pictures))
    finally:
        player.close()
    typer.echo(f"{'film' if sheet is None else 'sheet'}: {out}")


def _check(field: str, value: object, allowed: bool, rule: str) -> None:
    if not allowed:
        raise InputError(field, value, rule)


def _pictures(player: "Player", instants: list[float], size: int, played: str) -> Iterator["Image"]:
    """Play to each instant and paint it; the end of the game is the last, if it comes before."""
    from kswarms.analysis.film.painter import ArenaPainter
    from kswarms.scenarios.runs.play import run_errors

    painter = ArenaPainter(player.model.arena, player.game.body.radius, size)
    for instant in tracked(instants, "filming", len(instants)):
        with run_errors(played):
            player.seek(instant)
        yield _paint(painter, player.picture())
        if player.ended:
            break


def _paint(painter: "ArenaPainter", picture: "Picture") -> "Image":
    time, _, positions, heading, swarm, in_action, carrying, pucks = picture
    title = f"t = {time:.1f} s" if time >= 0 else f"learning, {-time:.1f} s to the game"
    return painter.paint(title, pucks, positions, heading, swarm, in_action, carrying)
