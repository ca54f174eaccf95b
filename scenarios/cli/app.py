"""The command line ``kswarms``: its commands, its errors and its exit status.

A command's module is imported when the command is called, so that help and shell completion start fast.
"""

import os
import signal
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Annotated, Any, Final

import typer
from typer.core import TyperGroup

from kswarms import __version__
from kswarms.agents.common.errors import InputError, printable, shorten
from kswarms.scenarios.cli.parser_errors import to_input_error
from kswarms.scenarios.cli.printing import print_lines
from kswarms.scenarios.cli.terminal import flush_output, prepare_streams
from kswarms.scenarios.runs.errors import RunError
from kswarms.scenarios.signals import signals_as_interrupts

_INTERRUPTED: Final = 130
"""Exit status of typer after a `KeyboardInterrupt`."""

COMMANDS: Final = {
    "list": ("catalogue", "list_scenarios", "List scenarios and tables, with their cost."),
    "show": ("catalogue", "show", "Print a scenario as TOML, ready to edit."),
    "run": ("run", "run", "Play scenarios; write tables and figures."),
    "status": ("status", "status", "Show finished and failed runs, with errors."),
    "export": ("export", "export", "Write the tables of a study again, without playing."),
    "merge": ("export", "merge", "Merge studies, such as shards, into one."),
    "replay": ("status", "replay", "Play one run again and compare the results."),
    "calibrate": ("calibrate", "calibrate", "Find the worlds that meet all targets."),
    "findings": ("findings", "findings", "Judge findings in several worlds."),
    "sensitivity": ("sensitivity", "sensitivity", "Show which parameters a measure depends on."),
    "explore": ("explore", "explore", "Open a page to watch and change games."),
    "film": ("film", "film", "Film a game or part of it."),
    "conflicts": ("conflicts", "conflicts", "List the conflicts of a game."),
    "contribution": ("contribution", "contribution", "Measure what robots contribute to their swarm."),
    "report": ("report", "report", "Write all results into one HTML file."),
}
"""Module, function and short help of each command. The help of a command is the docstring of its function."""


class LazyGroup(TyperGroup):
    """Group that imports a command when it is called. Help and completion need only its name."""

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        """Return name, command and remaining arguments."""
        if not (args[0] in COMMANDS or args[0].startswith("-") or ctx.resilient_parsing):
            raise InputError("command", args[0], f"must be one of {', '.join(COMMANDS)}")
        name, command, rest = super().resolve_command(ctx, args)
        return name, _load(name) if name else command, rest


def _load(name: str) -> Any:
    module, function, _ = COMMANDS[name]
    single = typer.Typer(rich_markup_mode=None, add_completion=False)
    single.command(name)(getattr(import_module(f"kswarms.scenarios.cli.{module}"), function))
    return typer.main.get_command(single)


app = typer.Typer(
    cls=LazyGroup,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    help="Simulate competing swarms of foraging robots and analyse the results.",
    epilog="Example: kswarms run fig-6.1a --densities 6,30 --seeds 3\n\n"
    "Exit status: 0 done, 1 failed, 2 bad input; interrupted: 130 Ctrl-C, 143 SIGTERM, 129 SIGHUP.",
)
for _name, (_, _, _short) in COMMANDS.items():
    app.command(_name, short_help=_short)(
        lambda: None
    )  # lists the command; `LazyGroup.resolve_command` loads it


def main() -> None:
    """Run the command line and exit with its status."""
    prepare_streams()
    os.environ["MPLBACKEND"] = "agg"  # no window opens; matplotlib's import would fail for an unknown name
    status = invoke()
    if error := flush_output():
        status = status or _print_error(str(error), 1)
    sys.exit(status)


def invoke(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status, which `--help` documents.

    `arguments` are the words after ``kswarms``; the default is the arguments of this process. SIGTERM and
    SIGHUP end a command as Ctrl-C does. The status is then 128 plus the number of the signal.
    """
    arrived: list[signal.Signals] = []
    try:
        with signals_as_interrupts(arrived):
            status = _run_command(sys.argv[1:] if arguments is None else arguments)
    except KeyboardInterrupt:  # outside typer
        status = _INTERRUPTED
    if status and arrived:
        by = "" if arrived[0] == signal.SIGINT else f" by {arrived[0].name}"
        return _print_error(f"interrupted{by}", 128 + arrived[0])
    return _print_error("interrupted", status) if status == _INTERRUPTED else status


def _run_command(words: Sequence[str]) -> int:
    try:
        code: int | None = app(words, prog_name="kswarms", standalone_mode=False, obj=("kswarms", *words))
    except InputError as error:
        return _print_error(str(error), 2)
    except BrokenPipeError as error:  # no message if the reader of the output ended, such as `head`
        return 1 if flush_output() else _print_error(str(error), 1)
    except OSError as error:
        message = str(error)
        for name in (error.filename, error.filename2):
            message = message.replace(repr(name), shorten(name))
        return _print_error(message, 1)
    except RunError as error:
        print_lines(error.trace, err=True)
        return _print_error(str(error), 1)
    except typer.TyperException as error:
        return _print_error(str(to_input_error(error, words)), error.exit_code)
    return code or 0


def _print_error(message: str, status: int) -> int:
    with suppress(OSError):  # standard error may be closed, too
        typer.echo(f"kswarms: {printable(message)}", err=True)
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
