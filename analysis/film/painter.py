"""Images of the arena and its robots, painted from arrays."""

import math
from collections.abc import Sequence
from itertools import combinations
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageColor, ImageDraw, ImageFont

from kswarms.analysis.colours import SWARM_COLOURS, swarm_colour

Floats = NDArray[np.float64]

_IN_ACTION: Final = "#ffc107"
_WALL, _STATION, _PUCK, _WHITE = "#333333", "#2b2b2b", "#111111", "#ffffff"
_TINT: Final = 0.22
"""Share of the swarm's colour in the colour of its base; the rest is white."""
_OVERSAMPLING: Final = 3
"""Images are painted larger by this factor in each direction, then reduced."""
_MARGIN: Final = 0.03
"""Width of the margin around the arena, relative to half its side."""
_HEADER: Final = 0.06
"""Height of the line above the arena, relative to the width of the image."""


class ArenaLayout(Protocol):
    """Arena to draw, such as a `kswarms.model.description.arena.Arena`; lengths in m."""

    @property
    def half(self) -> float:
        """Half the side of the arena."""

    @property
    def stations(self) -> Any:
        """Centres of the stations, shape (S, 2)."""

    @property
    def bases(self) -> Any:
        """Centres of the bases, shape (K, 2)."""

    @property
    def station_radius(self) -> float:
        """Radius of the stations."""

    @property
    def base_radius(self) -> float:
        """Radius of the bases."""


class ArenaPainter:
    """Paint images of one arena.

    `robot_radius` is in m. Images have `width` × `height` pixels. Both are even, as video formats require; an
    odd width is rounded down.
    """

    def __init__(self, arena: ArenaLayout, robot_radius: float, width: int) -> None:
        self.width = width - width % 2
        header = int(self.width * _HEADER)
        self.height = self.width + header + header % 2
        self._radius = robot_radius
        self._scale = _OVERSAMPLING * self.width / (2 * arena.half * (1 + _MARGIN))
        self._font = ImageFont.load_default(0.7 * header)
        self._background = self._paint_background(arena)

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
        """Return an image of one moment of a game.

        The title and the pucks of each swarm are above the arena. Robots in state A have a yellow ring;
        robots with a puck have a black disc on white. For n robots, `positions` (m) has shape (n, 2);
        `heading` (rad), `swarm` (counted from 0), `in_action` and `carrying` have shape (n,).
        """
        image = self._background.copy()
        pen = ImageDraw.Draw(image)
        radius = self._radius
        robots = zip(positions, heading, swarm, in_action, carrying, strict=True)
        for (x, y), angle, index, acts, carries in robots:
            body = self._box(x, y, 0.97 * radius)
            pen.ellipse(body, fill=swarm_colour(index + 1))
            if acts:
                pen.ellipse(body, outline=_IN_ACTION, width=max(1, round(0.2 * radius * self._scale)))
            dx, dy = math.cos(angle), math.sin(angle)
            ends = [self._pixel(x + r * radius * dx, y + r * radius * dy) for r in (0.3, 0.95)]
            pen.line([*ends[0], *ends[1]], fill=_WHITE, width=max(1, round(0.18 * radius * self._scale)))
            if carries:
                pen.ellipse(self._box(x, y, 0.42 * radius), fill=_WHITE)
                pen.ellipse(self._box(x, y, 0.32 * radius), fill=_PUCK)
        framed = Image.new("RGB", (self.width, self.height), _WHITE)
        framed.paste(image.reduce(_OVERSAMPLING), (0, self.height - self.width))
        self._write_header(ImageDraw.Draw(framed), title, pucks)
        return framed

    def _write_header(self, pen: ImageDraw.ImageDraw, title: str, pucks: Sequence[int]) -> None:
        middle = (self.height - self.width) / 2
        edge = self.width * _MARGIN
        pen.text((edge, middle), title, fill=_WALL, font=self._font, anchor="lm")
        right = self.width - edge
        for swarm, score in reversed(list(enumerate(pucks, 1))):
            text = f"S{swarm} {score}"
            pen.text((right, middle), text, fill=swarm_colour(swarm), font=self._font, anchor="rm")
            right -= pen.textlength(f"{text}   ", font=self._font)

    def _paint_background(self, arena: ArenaLayout) -> Image.Image:
        side = _OVERSAMPLING * self.width
        image = Image.new("RGB", (side, side), _WHITE)
        pen = ImageDraw.Draw(image)
        wall = 0.02 * arena.half
        outside = arena.half + wall
        pen.rectangle(self._box(0.0, 0.0, outside), outline=_WALL, width=round(wall * self._scale))
        for x, y in arena.stations:
            pen.ellipse(self._box(x, y, arena.station_radius), fill=_STATION)
        font = ImageFont.load_default(0.1 * self._scale)
        for swarm, (x, y) in enumerate(arena.bases, 1):
            colour = swarm_colour(swarm)
            pen.ellipse(self._box(x, y, arena.base_radius), fill=_blend(_WHITE, colour, _TINT))
            pen.text(self._pixel(x, y), f"S{swarm}", fill=colour, font=font, anchor="mm")
        return image

    def _pixel(self, x: float, y: float) -> tuple[float, float]:
        """Return the pixel of a point (m)."""
        middle = _OVERSAMPLING * self.width / 2
        return middle + self._scale * float(x), middle - self._scale * float(y)

    def _box(self, x: float, y: float, radius: float) -> tuple[float, float, float, float]:
        """Return the corners of the square around a circle (pixels)."""
        return *self._pixel(x - radius, y + radius), *self._pixel(x + radius, y - radius)


def _blend(one: str, other: str, share: float) -> tuple[int, ...]:
    """Return a mixture of two colours; `share` is the share of `other`."""
    pairs = zip(ImageColor.getrgb(one), ImageColor.getrgb(other), strict=True)
    return tuple(round((1 - share) * a + share * b) for a, b in pairs)


def palette() -> Image.Image:
    """Return a palette image with all colours and the mixtures at anti-aliased edges.

    A palette of the first image of a film would lack colours that appear later.
    """
    plain = (_WHITE, _STATION, _IN_ACTION, *SWARM_COLOURS)
    colours = [_blend(a, b, share) for a, b in combinations(plain, 2) for share in (0.0, 0.25, 0.5, 0.75)]
    colours += [_blend(_WHITE, colour, _TINT) for colour in SWARM_COLOURS]
    colours += [_blend(name, name, 0.0) for name in (*plain, _WALL, _PUCK)]
    image = Image.new("P", (1, 1))
    image.putpalette([value for colour in dict.fromkeys(colours) for value in colour])
    return image
