"""Benchmark of the report on a complete study of random numbers, in a new process.

As a script it prints time, memory and size, and exits with 1 if time or memory is above its bound.
"""

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.description.condition import Condition
from kswarms.scenarios.description.scenario import Scenario

MAX_SECONDS: Final = 120.0
MAX_MEMORY: Final = 1500
"""MB"""

_REPORT: Final = """
import resource, sys
from kswarms.scenarios.cli import invoke
status = invoke(["report", sys.argv[1]])
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
sys.exit(status)
"""


def write_study(
    directory: Path,
    scenarios: Iterable[Scenario] = tuple(CATALOGUE.values()),
    densities: int | None = None,
    seeds: int | None = None,
) -> int:
    """Write `runs.parquet` and `policies.parquet` with random numbers instead of results of games.

    Parameters
    ----------
    directory : Path
        Existing directory.
    scenarios : iterable of Scenario
        Scenarios.
    densities, seeds : int, optional
        Number of densities and seeds of each scenario; by default all.

    Returns
    -------
    int
        Number of rows of `runs.parquet`.
    """
    rng = np.random.default_rng(0)
    runs, policies = [], []
    for scenario in scenarios:
        for condition in scenario.conditions:
            for n in scenario.densities[:densities]:
                sizes = condition.sizes(n)
                for seed in range(scenario.seeds if seeds is None else seeds):
                    key = {
                        "run": f"{scenario.id}/{condition.name}/{n}/{seed}",
                        "scenario": scenario.id,
                        "condition": condition.name,
                        "n": n,
                        "seed": seed,
                    }
                    runs += [key | row for row in _swarms(condition, sizes, rng)]
                    policies += [key | row for row in _learned(condition, rng)]
    pd.DataFrame(runs).to_parquet(directory / "runs.parquet")
    if policies:
        pd.DataFrame(policies).to_parquet(directory / "policies.parquet")
    return len(runs)


def _swarms(condition: Condition, sizes: list[int], rng: np.random.Generator) -> list[dict[str, Any]]:
    n = sum(sizes)
    pucks = rng.poisson([size * (6.5 - 0.11 * n) for size in sizes])
    share = np.clip(rng.normal(n / 60, 0.02, len(sizes)), 0, 1)
    return [
        {
            "swarm": k + 1,
            "size": size,
            "policy": condition.swarms[k].policy,
            "pucks": int(pucks[k]),
            "sud": int(2 * pucks[k] - pucks.sum()),
            "t_a_intra": 200.0 * size * share[k],
            "t_a_inter": 400.0 * size * share[k],
            "t_p": 600.0 * size * (1 - share[k]),
            "conflicts_intra": 100 * size,
            "conflicts_inter": 200 * size,
            "duration": 600.0,
            "ended": "time",
        }
        for k, size in enumerate(sizes)
    ]


def _learned(condition: Condition, rng: np.random.Generator) -> list[dict[str, Any]]:
    rows = []
    for k, rule in enumerate(condition.swarms):
        if "learner" not in rule.policy:
            continue
        within = rule.policy.startswith(("learner", "intra-learner"))
        beyond = rule.policy.startswith(("learner", "inter-learner"))
        for opponent in range(len(condition.swarms)):
            if (opponent == k and within) or (opponent != k and beyond):
                attack = float(rng.uniform())
                key = {"swarm": k + 1, "opponent": opponent + 1}
                for action, share in (("flight", 1 - attack), ("fight", attack)):
                    rows.append(key | {"action": action, "share": share, "attack_share": attack})
    return rows


def main() -> int:
    """Print the cost of the report, and return 1 if it is above a bound, else 0."""
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        rows = write_study(directory)
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", _REPORT, name], stdout=subprocess.PIPE, text=True, check=True
        )
        seconds = time.perf_counter() - start
        size = (directory / "report.html").stat().st_size / 1e6
    memory = float(done.stdout.splitlines()[-1])
    print(f"rows of runs {rows:,}; {seconds:.0f} s (at most {MAX_SECONDS:.0f}); ", end="")
    print(f"{memory:.0f} MB (at most {MAX_MEMORY}); report of {size:.1f} MB")
    return int(seconds > MAX_SECONDS or memory > MAX_MEMORY)


if __name__ == "__main__":
    sys.exit(main())
