"""The command line ``kswarms``: its commands, its errors and its exit status.

Each command is a function in a module of this package; what takes long to import is imported by the command
that needs it.
"""

import sys
from collections.abc import Callable, Sequence
from typing import Annotated, Any, Final

import typer
from pydantic import ValidationError

from kswarms import __version__
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.cli.calibrate import calibrate
from kswarms.scenarios.cli.catalogue import list_scenarios, show
from kswarms.scenarios.cli.conflicts import conflicts
from kswarms.scenarios.cli.contribution import contribution
from kswarms.scenarios.cli.explore import explore
from kswarms.scenarios.cli.film import film
from kswarms.scenarios.cli.report import report
from kswarms.scenarios.cli.run import run
from kswarms.scenarios.cli.status import replay, status
from kswarms.scenarios.runs.outcome import RunError

INTERRUPTED: Final = 130

app = typer.Typer(
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Competing swarms of foraging robots: play the scenarios of the catalogue and see who wins.",
    epilog="Example: kswarms run fig-6.1a --densities 6,30 --seeds 3\n\n"
    "Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted.",
)


def main() -> None:
    """Run the command line and exit with its status."""
    sys.exit(invoke())


def invoke(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments : sequence of str, optional
        The words after ``kswarms``; by default those that this process was started with.

    Returns
    -------
    int
        Exit status: 0 done, 1 failed, 2 bad input, 130 interrupted.
    """
    try:
        words = sys.argv[1:] if arguments is None else arguments
        code: int | None = app(words, prog_name="kswarms", standalone_mode=False, obj=("kswarms", *words))
    except InputError as error:
        return _complain(str(error), 2)
    except RunError as error:
        typer.echo(error.trace, err=True)  # a fault of the program, not of its input
        return _complain(str(error), 1)
    except OSError as error:
        return _complain(str(error), 1)
    except typer.BadParameter as error:
        return _complain(_refusal(error), 2)
    except typer.TyperException as error:  # typer's own complaints: an unknown command or option, say
        return _complain(error.format_message(), error.exit_code)
    if code == INTERRUPTED:
        return _complain("interrupted", code)
    return code or 0


def _refusal(error: typer.BadParameter) -> str:
    """Tell the option, its value and what is allowed, as all input is refused; typer leaves the value out."""
    cause = error.__cause__
    if not isinstance(cause, ValidationError) or error.param is None:
        return error.format_message()
    found = InputError.from_validation(cause, ())
    field = error.param.opts[-1].lstrip("-").replace("-", "_")
    # Of a choice, typer says the value itself.
    allowed = found.allowed.removeprefix(f"Value error, {found.value!r} ").removesuffix(".")
    return str(InputError(field, found.value, allowed))


def _complain(message: str, status: int) -> int:
    typer.echo(f"kswarms: {' '.join(message.split())}", err=True)
    return status


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"kswarms {__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def _without_command(
    context: typer.Context,
    _version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


_COMMANDS: Final[dict[Callable[..., Any], tuple[str, str]]] = {
    list_scenarios: ("List scenarios and tables, with what they take.", "list"),
    show: ("Print a scenario as TOML, ready to edit.", "show fig-6.1c"),
    run: (
        "Play scenarios; write tables and figures.",
        "run fig-6.1a fig-6.1c --densities 6,30,50 --seeds 5",
    ),
    status: ("Tell what is done, what failed and why.", "status results"),
    replay: ("Play one run again, and compare.", "replay results 0c2b1f7a9d3e4f56"),
    calibrate: (
        "Fit the free parameters to Table 6.1.",
        "calibrate --free friction,gamma --densities 16,30,50 --seeds 2",
    ),
    explore: ("Open a page in which games are watched.", "explore fig-6.4b"),
    film: ("Film a game, or a stretch of it.", "film fig-6.1c --n 50 --to 120 --out fight.gif"),
    conflicts: ("Tell a game conflict by conflict.", "conflicts fig-6.4b --n 6 --robot 3 --from 0"),
    contribution: (
        "Measure what robots contributed to their swarm.",
        "contribution fig-6.4b --n 16 --robots S2 --seeds 5",
    ),
    report: ("Write all results into one HTML file.", "report results --out report.html"),
}
"""What each command is in the list of all, and how it is used."""

for _command, (_short, _example) in _COMMANDS.items():
    app.command(
        _example.split()[0],
        short_help=_short,
        epilog=f"Example: kswarms {_example}",
    )(_command)
