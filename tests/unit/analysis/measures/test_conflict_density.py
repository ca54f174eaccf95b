"""Numbers of conflicts in the cells of the arena."""

from kswarms.analysis.measures.conflict_density import conflict_density
from tests.helpers.result_rows import PLACED


def test_density_counts_conflicts_per_game_in_each_cell_from_below_left() -> None:
    counts = conflict_density(PLACED)
    assert counts.shape == (40, 40)
    assert counts.sum() == 2
    assert (counts[0, 0], counts[0, 39], counts[28, 39]) == (1, 0.5, 0.5)
    assert conflict_density(PLACED.drop(columns="run"))[0, 0] == 2
