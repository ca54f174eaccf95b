"""A picture of the arena with its robots, drawn from plain arrays."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageColor, ImageDraw, ImageFont

Floats = NDArray[np.float64]

SWARM_COLOURS: Final = ("#008000", "#d50000", "#1e40ff", "#ff8c00", "#800080", "#8b4513")
"""Of S1, S2 …: green and red as in the source, then the order of the figures."""
_IN_ACTION: Final = "#ffc107"
_WALL, _STATION, _PUCK, _WHITE = "#333333", "#2b2b2b", "#111111", "#ffffff"
_SMOOTH: Final = 3
"""Pixels are the mean of this many times as many, each way."""
_MARGIN: Final = 0.03
"""Around the arena, as a part of half its side."""
_HEADER: Final = 0.06
"""Height of the line above it, as a part of the picture's width."""


@dataclass(frozen=True)
class Ground:
    """What stands still; lengths in metres.

    Attributes
    ----------
    half : float
        Half the side of the arena.
    stations, bases : ndarray of float64, shape (m, 2) and (K, 2)
        Their middles.
    station_radius, base_radius, radius : float
        Radii of stations, bases and robots.
    """

    half: float
    stations: Floats
    bases: Floats
    station_radius: float
    base_radius: float
    radius: float


class ArenaPainter:
    """Paints pictures of one arena.

    Parameters
    ----------
    ground : Ground
        What stands still.
    width : int
        Of a picture (pixels); its height is `height`.

    Attributes
    ----------
    width, height : int
        Of a picture (pixels); both even, as video formats want them.
    """

    def __init__(self, ground: Ground, width: int) -> None:
        self.ground = ground
        self.width = width - width % 2
        header = int(self.width * _HEADER)
        self.height = self.width + header + header % 2
        self._scale = _SMOOTH * self.width / (2 * ground.half * (1 + _MARGIN))
        self._font = ImageFont.load_default(0.7 * header)
        self._still = self._paint_ground()

    def paint(
        self,
        title: str,
        pucks: Sequence[int],
        positions: Floats,
        heading: Floats,
        swarm: NDArray[np.int64],
        in_action: NDArray[np.bool_],
        carrying: NDArray[np.bool_],
    ) -> Image.Image:
        """Return a picture of an instant.

        Parameters
        ----------
        title : str
            Written above it, on the left.
        pucks : sequence of int
            Score of each swarm, written on the right.
        positions : ndarray of float64, shape (n, 2)
            (m)
        heading : ndarray of float64, shape (n,)
            (rad)
        swarm : ndarray of int64, shape (n,)
            Counted from 0.
        in_action, carrying : ndarray of bool, shape (n,)
            Whether in state A (a yellow ring); whether with a puck (a black disc on white).
        """
        picture = self._still.copy()
        pen = ImageDraw.Draw(picture)
        radius = self.ground.radius
        robots = zip(positions, heading, swarm, in_action, carrying, strict=True)
        for (x, y), angle, own, acts, carries in robots:
            self._disc(pen, x, y, 0.97 * radius, _colour(own))
            if acts:
                self._ring(pen, x, y, 0.97 * radius, 0.2 * radius)
            dx, dy = math.cos(angle), math.sin(angle)
            ends = [self._at(x + r * radius * dx, y + r * radius * dy) for r in (0.3, 0.95)]
            pen.line([*ends[0], *ends[1]], fill=_WHITE, width=max(1, round(0.18 * radius * self._scale)))
            if carries:
                self._disc(pen, x, y, 0.42 * radius, _WHITE)
                self._disc(pen, x, y, 0.32 * radius, _PUCK)
        reduced = picture.reduce(_SMOOTH)
        whole = Image.new("RGB", (self.width, self.height), _WHITE)
        whole.paste(reduced, (0, self.height - self.width))
        self._write_header(ImageDraw.Draw(whole), title, pucks)
        return whole

    def _write_header(self, pen: ImageDraw.ImageDraw, title: str, pucks: Sequence[int]) -> None:
        middle = (self.height - self.width) / 2
        edge = self.width * _MARGIN
        pen.text((edge, middle), title, fill=_WALL, font=self._font, anchor="lm")
        right = self.width - edge
        for k, score in reversed(list(enumerate(pucks))):
            text = f"S{k + 1} {score}"
            pen.text((right, middle), text, fill=_colour(k), font=self._font, anchor="rm")
            right -= pen.textlength(f"{text}   ", font=self._font)

    def _paint_ground(self) -> Image.Image:
        ground = self.ground
        side = _SMOOTH * self.width
        picture = Image.new("RGB", (side, side), _WHITE)
        pen = ImageDraw.Draw(picture)
        wall = 0.02 * ground.half
        corners = [
            *self._at(-ground.half - wall, ground.half + wall),
            *self._at(ground.half + wall, -ground.half - wall),
        ]
        pen.rectangle(corners, outline=_WALL, width=round(wall * self._scale))
        for x, y in ground.stations:
            self._disc(pen, x, y, ground.station_radius, _STATION)
        font = ImageFont.load_default(0.1 * self._scale)
        for k, (x, y) in enumerate(ground.bases):
            colour = ImageColor.getrgb(_colour(k))
            self._disc(pen, x, y, ground.base_radius, tuple(round(255 - 0.22 * (255 - c)) for c in colour))
            pen.text(self._at(x, y), f"S{k + 1}", fill=_colour(k), font=font, anchor="mm")
        return picture

    def _at(self, x: float, y: float) -> tuple[float, float]:
        """Return the pixel of a place (m)."""
        middle = _SMOOTH * self.width / 2
        return middle + self._scale * float(x), middle - self._scale * float(y)

    def _disc(
        self, pen: ImageDraw.ImageDraw, x: float, y: float, radius: float, colour: str | tuple[int, ...]
    ) -> None:
        pen.ellipse(self._box(x, y, radius), fill=colour)

    def _ring(self, pen: ImageDraw.ImageDraw, x: float, y: float, radius: float, width: float) -> None:
        pen.ellipse(self._box(x, y, radius), outline=_IN_ACTION, width=max(1, round(width * self._scale)))

    def _box(self, x: float, y: float, radius: float) -> tuple[float, float, float, float]:
        middle_x, middle_y = self._at(x, y)
        reach = radius * self._scale
        return middle_x - reach, middle_y - reach, middle_x + reach, middle_y + reach


def _colour(swarm: int) -> str:
    return SWARM_COLOURS[swarm % len(SWARM_COLOURS)]


def _blend(one: str, other: str, part: float) -> tuple[int, ...]:
    """Return one colour with a part of another in it."""
    pairs = zip(ImageColor.getrgb(one), ImageColor.getrgb(other), strict=True)
    return tuple(round((1 - part) * a + part * b) for a, b in pairs)


def palette() -> Image.Image:
    """Return an image whose palette has the colours of all pictures, and what smooth edges make of them.

    A palette taken from a film's first picture would lack whatever appears later.
    """
    plain = (_WHITE, _STATION, _IN_ACTION, *SWARM_COLOURS)
    colours = [_blend(a, b, part) for a, b in combinations(plain, 2) for part in (0.0, 0.25, 0.5, 0.75)]
    colours += [_blend(_WHITE, colour, 0.22) for colour in SWARM_COLOURS]
    colours += [_blend(name, name, 0.0) for name in (*plain, _WALL, _PUCK)]
    image = Image.new("P", (1, 1))
    image.putpalette([value for colour in dict.fromkeys(colours) for value in colour])
    return image
