"""``status`` and ``replay``: the state of a results directory, and the replay of one of its runs."""

from pathlib import Path
from typing import Annotated

import typer

from kswarms.agents.common.quoting import for_shell
from kswarms.scenarios.cli.options import RunLimit, Trust
from kswarms.scenarios.cli.printing import format_duration, print_columns, print_line, warn
from kswarms.scenarios.study.database import LEDGER_FILE
from kswarms.scenarios.study.ledger import Ledger
from kswarms.scenarios.study.lock import lock_holder

Directory = Annotated[Path, typer.Argument(metavar="DIR", help="Results directory of `kswarms run`.")]


def status(directory: Directory) -> None:
    """Show the finished, failed and missing runs, their CPU time and the errors.

    Example: kswarms status results
    """
    with Ledger(directory / LEDGER_FILE) as ledger:
        headings = ("scenario", "done", "failed", "missing", "CPU time")
        rows = [(name, *_cells(counts)) for name, counts in ledger.points_by_scenario().items()]
        rows.append(("unique runs", *_cells(ledger.runs_by_status())))
        print_columns([headings, *rows], left=(0,))
        typer.echo()
        sessions = ledger.sessions()
        print_line(f"sessions: {len(sessions)}, first: {sessions[0]['started'] if sessions else '–'}")
        for code, runs in ledger.runs_by_code().items():
            print_line(f"played by: kswarms {code}, {runs} runs")
        environments = ledger.runs_by_environment()
        for environment, runs in environments.items():
            print_line(f"played with: {environment}, {runs} runs")
        if len(environments) > 1:
            print_line("mixed:    the runs of different versions may differ in their last digits")
        if holder := lock_holder(directory):
            print_line(f"in use by: {holder}")
        for (run, scenario, condition, n, seed), error, trace in ledger.failed_runs():
            label = f"{scenario} {condition}".strip()
            typer.echo()
            print_line(f"failed: {label}, n={n}, seed={seed}: {error}")
            for line in _last_call(trace):
                print_line(f"  {line}")
            print_line(f"  again: kswarms replay {for_shell(str(directory))} {for_shell(run)}")


def replay(
    directory: Directory,
    run_digest: Annotated[str, typer.Argument(metavar="RUN", help="Digest: column `run` of a table.")],
    trust: Trust = False,
    run_limit: RunLimit = None,
) -> int:
    """Play one run again, print its results and compare them with DIR. It writes nothing.

    Example: kswarms replay results 0c2b1f7a9d3e4f56
    """
    from kswarms.scenarios.runs.sweep import play_all
    from kswarms.scenarios.watch.recorded_run import require_no_user_code

    with Ledger(directory / LEDGER_FILE) as ledger:
        run = ledger.run(run_digest)
        kept, origin = ledger.outcome(run_digest), ledger.origin(run_digest)
    if not trust:
        require_no_user_code(run)
    print_line(str(run))
    ((_, outcome),) = play_all([run], run_limit=run_limit)
    for row in (*outcome.swarms, *outcome.policies):
        print_line("  " + ", ".join(f"{name}={value!r}" for name, value in row.items()))
    if kept is None:
        print_line(f"{directory} has no results of this run")
        return 0
    if kept == (outcome.swarms, outcome.policies):
        print_line(f"equal to the results in {directory}")
        return 0
    warn(f"{directory} has different results of this run, played by kswarms {origin}")
    return 1


def _cells(counts: dict[str, tuple[int, float]]) -> tuple[str, ...]:
    numbers = (str(counts.get(status, (0, 0.0))[0]) for status in ("done", "failed", "missing"))
    return (*numbers, format_duration(sum(seconds for _, seconds in counts.values())))


def _last_call(trace: str) -> list[str]:
    """Return the last file, line and statement of a traceback."""
    lines = trace.splitlines()
    calls = [k for k, line in enumerate(lines) if line.startswith("  File ")]
    return [line.strip() for line in lines[calls[-1] : calls[-1] + 2]] if calls else []
