"""Legends of figures, for tests."""

from matplotlib.figure import Figure


def legend_texts(figure: Figure) -> list[str]:
    """Return the entries of the only legend."""
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]
