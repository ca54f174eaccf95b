"""``contribution``: what robots contributed to their swarm, by playing the game without them."""

from collections.abc import Generator, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from kswarms.agents.common.errors import InputError
from kswarms.scenarios.catalogue.selecting import chosen
from kswarms.scenarios.cli.options import Jobs, check_seed, directory, processes, scenario_ids
from kswarms.scenarios.cli.printing import print_table
from kswarms.scenarios.cli.progress import tracked
from kswarms.scenarios.description.scenario import MOST_SEEDS
from kswarms.scenarios.runs.outcome import Outcome
from kswarms.scenarios.runs.run import Run


def contribution(
    wanted: Annotated[
        str,
        typer.Argument(
            metavar="ID",
            help="A scenario of the list, or my.toml with one.",
            autocompletion=scenario_ids,
        ),
    ],
    condition: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Which curve of it, as `kswarms show` names it, if it has several."
        ),
    ] = None,
    n: Annotated[int, typer.Option(help="Robots in all, as the shares of its swarms allow.")] = 26,
    robots: Annotated[
        str | None,
        typer.Option(metavar="LIST", help="Robots, from 0, and swarms, as 3,7 or S2. [default: all]"),
    ] = None,
    seeds: Annotated[
        int, typer.Option(help="Games with all robots, at least 1, each also played without each.")
    ] = 20,
    first_seed: Annotated[int, typer.Option(help="Seed of the first of these games, at least 0.")] = 0,
    absent_from: Annotated[
        Literal["learning", "game"],
        typer.Option(help="Whether they are absent from the learning too, or from the measured game alone."),
    ] = "learning",
    jobs: Jobs = None,
    out: Annotated[Path, typer.Option(parser=directory, metavar="DIR", help="Where the results go.")] = Path(
        "results"
    ),
) -> None:
    """Measure what robots contributed: play the same games without each, and compare with its rewards."""
    scenarios = chosen([wanted])
    if len(scenarios) > 1:
        raise InputError("id", wanted, f"must be one scenario: {', '.join(each.id for each in scenarios)}")
    scenario = scenarios[0]
    names = [each.name for each in scenario.conditions]
    if condition is None and len(names) > 1:
        raise InputError("condition", condition, f"must be one of {', '.join(map(repr, names))}")
    name = names[0] if condition is None else condition
    game = scenario.game(name, n)
    if not 1 <= seeds <= MOST_SEEDS:
        raise InputError("seeds", seeds, f"must be at least 1, at most {MOST_SEEDS}")
    check_seed("first_seed", first_seed)
    workers = processes(jobs)

    from kswarms.analysis.measures.contribution import time_sud
    from kswarms.scenarios.contribution.games import contributions, prepare_table, robots_of, write_table

    numbers = robots_of(game, robots)
    prepare_table(out)
    rows = contributions(
        game,
        numbers,
        range(first_seed, first_seed + seeds),
        absent_from,
        label=(scenario.id, name),
        play=partial(_play, workers),
        time_sud=time_sud,
    )
    typer.echo(f"table:  {write_table(out, rows)}")
    _show(out, scenario.id, scenario.title, rows[0])


def _play(jobs: int, runs: Sequence[Run]) -> Generator[tuple[Run, Outcome], None, None]:
    from kswarms.scenarios.contribution.games import RECORD
    from kswarms.scenarios.runs.sweep import play_all

    with closing(play_all(runs, jobs, RECORD)) as played:
        yield from tracked(played, "playing", len(runs))


def _show(out: Path, scenario: str, title: str, question: dict[str, Any]) -> None:
    """Draw what was found and print it."""
    from kswarms.analysis.figures.contribution import draw, printed
    from kswarms.analysis.measures.contribution import of_question, read

    named = {name: question[name] for name in ("condition", "n", "absent_from")}
    typer.echo(f"figure: {draw(out, title, scenario=scenario, **named)}")
    rows = of_question(read(out), scenario=scenario, **named)
    for heading, (header, *lines) in printed(rows):
        print_table(heading, header, lines)
