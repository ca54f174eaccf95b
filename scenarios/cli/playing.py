"""Play the runs of a study, with its warnings and its progress."""

from collections.abc import Iterator, Sequence
from contextlib import closing, nullcontext
from dataclasses import dataclass
from pathlib import Path

from kswarms.agents.common.quoting import for_shell
from kswarms.model.description.game import Game
from kswarms.scenarios.cli.printing import warn
from kswarms.scenarios.cli.progress import ProgressStyle, show_progress
from kswarms.scenarios.description.scenario import Scenario
from kswarms.scenarios.runs.dask import dask_executor
from kswarms.scenarios.runs.run import Order
from kswarms.scenarios.runs.trial import require_trials
from kswarms.scenarios.study.file_systems import network_file_system
from kswarms.scenarios.study.study import Study


@dataclass(frozen=True)
class Plan:
    """The runs of a command, and how they are played."""

    scenarios: Sequence[Scenario]
    first_seed: int
    shard: tuple[int, int]
    """Number of the part that is played, and number of parts."""
    records: Sequence[str]
    """Names of the recorded tables."""
    order: Order
    jobs: int
    """Number of worker processes."""
    scheduler: str | None
    """Address of a Dask scheduler that plays the runs in place of worker processes."""
    run_limit: float | None
    """Time limit of each run by the clock (s)."""
    allow_mixed: bool
    """Whether runs of several environments may be mixed."""


def play_study(out: Path, plan: Plan, command: str, progress: ProgressStyle) -> tuple[list[Path], int]:
    """Play the missing runs of a study; return the tables written and the number of failed runs."""
    require_trials(_games_with_user_code(plan.scenarios), plan.run_limit)
    failed, playing = 0, False
    if kind := network_file_system(out):
        advice = "safer and faster: --out on a local disk, such as $TMPDIR; copy the directory afterwards"
        warn(f"{out} is on a network file system ({kind}), which can damage a ledger; {advice}")
    try:
        connection = nullcontext() if plan.scheduler is None else dask_executor(plan.scheduler)
        with connection as executor, Study(out, command, plan.allow_mixed) as study:
            runs = study.plan(plan.scenarios, plan.first_seed, plan.records, plan.shard)
            for origin in study.other_origins:
                warn(f"{out} has runs of other code, {origin}; use another --out to play them again")
            playing = True
            results = study.play(runs, plan.jobs, plan.records, executor, plan.run_limit, plan.order)
            with closing(results) as played:
                for count in show_progress(played, runs, progress):
                    failed = count.failed
    except KeyboardInterrupt:
        if playing:  # after the tables are written, because the terminal may be gone
            warn(f"{out} has the finished runs; repeat the command to resume")
        raise
    if failed:
        warn(f"{failed} of {len(runs)} runs failed; see `kswarms status {for_shell(str(out))}`")
    return study.tables, failed


def _games_with_user_code(scenarios: Sequence[Scenario]) -> Iterator[Game]:
    """Yield a game of each condition with user-defined code."""
    for scenario in scenarios:
        for condition in scenario.conditions:
            if any(rule.runs_user_code for rule in condition.swarms):
                yield condition.game(scenario.densities[0])
