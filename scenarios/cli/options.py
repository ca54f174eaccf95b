"""Options that several commands share, their validation and their shell completion."""

from pathlib import Path
from typing import Annotated, Final

import typer

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import MAX_JOBS, MAX_RUN_LIMIT, MAX_SEED
from kswarms.scenarios.catalogue import CATALOGUE, TABLES
from kswarms.scenarios.catalogue.selection import DEFAULT_N, DEFAULT_SCENARIO, select_scenarios
from kswarms.scenarios.cli.cpus import available_cpus
from kswarms.scenarios.cli.progress import ProgressStyle
from kswarms.scenarios.runs.run import Run, digest

CPUS: Final = min(available_cpus(), MAX_JOBS)
Jobs = Annotated[
    int,
    typer.Option(
        min=1, max=MAX_JOBS, show_default="one for each available CPU", help="Number of worker processes."
    ),
]
Progress = Annotated[ProgressStyle, typer.Option(help="How progress is shown.")]
AllowMixed = Annotated[
    bool, typer.Option("--allow-mixed", help="Mix runs of different versions of Python, numpy and numba.")
]
RunLimit = Annotated[
    float | None,
    typer.Option(
        min=0.001,
        max=MAX_RUN_LIMIT,
        metavar="SECONDS",
        help="Time limit of each run by the clock; a longer run fails. [default: none]",
    ),
]
FirstSeed = Annotated[int, typer.Option(min=0, max=MAX_SEED, help="First seed.")]


def complete_ids(incomplete: str) -> list[tuple[str, str]]:
    """Return id and title of the scenarios and tables whose ids start with a text."""
    return [
        (name, entry.title) for name, entry in (CATALOGUE | TABLES).items() if name.startswith(incomplete)
    ]


def complete_scenario_ids(incomplete: str) -> list[tuple[str, str]]:
    """Return id and title of the scenarios whose ids start with a text."""
    return [(name, title) for name, title in complete_ids(incomplete) if name in CATALOGUE]


def parse_path(text: str) -> Path:
    """Return a path; expand ``~``, which shells leave alone in ``--out=~/x``. Refuse an empty text."""
    if not text:  # for example an unset shell variable; it would mean the current directory
        raise InputError("path", text, "must not be empty")
    try:
        return Path(text).expanduser()
    except RuntimeError:
        raise InputError("path", text, "names an unknown user; a name that starts with ~ needs ./") from None


_SOURCE_HELP: Final = (
    "Scenario or table of `kswarms list`, or my.toml; with --run, a results directory. "
    f"[default: {DEFAULT_SCENARIO}]"
)
Source = Annotated[
    str | None, typer.Argument(metavar="ID|DIR", help=_SOURCE_HELP, autocompletion=complete_ids)
]
RunDigest = Annotated[
    str,
    typer.Option(metavar="DIGEST", help="Run of DIR to replay: column `run` of its tables."),
]
ConditionName = Annotated[
    str | None,
    typer.Option("--condition", metavar="NAME", help="Condition; see `kswarms show`. [default: the first]"),
]
Robots = Annotated[
    int | None,
    typer.Option("--n", help="Number of robots, a multiple of the sum of the shares. [default: near 20]"),
]
Seed = Annotated[
    int | None, typer.Option("--seed", min=0, max=MAX_SEED, help="Seed of the game. [default: 0]")
]

Trust = Annotated[
    bool,
    typer.Option("--trust", help="Allow the run of DIR to execute the user-defined code that it names."),
]


def resolve_source(source: str | None, run: str, trust: bool) -> str | Run:
    """Return the id or file of a scenario, or the run of a results directory if a digest is given."""
    if not run:
        return source or DEFAULT_SCENARIO
    if source is None:
        raise InputError("run", run, "needs a results directory, DIR")
    from kswarms.scenarios.watch.recorded_run import recorded_run

    return recorded_run(Path(source), run, trust)


def resolve_run(
    source: str | None, run: str, trust: bool, condition: str | None, n: int | None, seed: int | None
) -> Run:
    """Return a run of a results directory if a digest is given, or else a run of a scenario."""
    start = resolve_source(source, run, trust)
    if isinstance(start, Run):
        for field, value in (("condition", condition), ("n", n), ("seed", seed)):
            if value is not None:
                raise InputError(field, value, "must not be given with --run: the run has its own")
        return start
    found = select_scenarios([start])[0]
    name = found.conditions[0].name if condition is None else condition
    if n is None:
        n = min(found.densities, key=lambda density: abs(density - DEFAULT_N))
    game, seed = found.game(name, n), seed or 0
    return Run(digest(game, seed), game, seed, ((found.id, name),))
