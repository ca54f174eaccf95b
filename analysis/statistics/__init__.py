"""Statistics over seeds: intervals, comparisons, means and curves."""
