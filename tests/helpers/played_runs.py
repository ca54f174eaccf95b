"""Tables of runs that a test has played, without a study."""

from collections.abc import Iterable

import pandas as pd

from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run


def result_table(played: Iterable[tuple[Run, Outcome]], rows: str = "swarms") -> pd.DataFrame:
    """Return the rows ``swarms`` or ``policies`` of outcomes, as a study writes them."""
    return pd.DataFrame(
        [
            {"run": run.digest, "scenario": scenario, "condition": condition, "n": run.n, "seed": run.seed}
            | row
            for run, outcome in played
            for scenario, condition in run.labels
            for row in getattr(outcome, rows)
        ]
    )
