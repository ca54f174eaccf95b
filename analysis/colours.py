"""The colours of swarms in figures, films, the page and the report."""

from typing import Final

SWARM_COLOURS: Final = ("#00866a", "#d5450b", "#1f4fd8", "#cc79a7", "#56b4e9", "#e69f00")
"""S1 is green, S2 red, S3 blue as in the source, in shades that colour-blind readers can distinguish.

The others are from the palette of Okabe and Ito.
"""


def swarm_colour(swarm: int) -> str:
    """Return the colour of a swarm, counted from 1; a seventh swarm has the colour of the first."""
    return SWARM_COLOURS[(swarm - 1) % len(SWARM_COLOURS)]
