"""``contribution``: contributions of robots to their swarm, measured by games without them."""

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from kswarms.agents.common.errors import InputError
from kswarms.agents.common.limits import MAX_SEEDS
from kswarms.scenarios.catalogue.selection import select_scenarios
from kswarms.scenarios.cli.options import CPUS, FirstSeed, Jobs, RunLimit, complete_scenario_ids, parse_path
from kswarms.scenarios.cli.printing import print_line, print_table
from kswarms.scenarios.cli.progress import play_tracked


def contribution(
    source: Annotated[
        str,
        typer.Argument(
            metavar="ID", help="Scenario of `kswarms list`, or my.toml.", autocompletion=complete_scenario_ids
        ),
    ],
    condition: Annotated[
        str | None, typer.Option(metavar="NAME", help="Condition, required if the scenario has several.")
    ] = None,
    n: Annotated[int, typer.Option(help="Number of robots, a multiple of the sum of the shares.")] = 26,
    robots: Annotated[
        str | None, typer.Option(metavar="LIST", help="Robots, from 0, or swarms: 3,7 or S2. [default: all]")
    ] = None,
    seeds: Annotated[
        int, typer.Option(min=1, max=MAX_SEEDS, help="Games; each is repeated without each robot.")
    ] = 20,
    first_seed: FirstSeed = 0,
    absent_from: Annotated[
        Literal["learning", "game"],
        typer.Option(help="Phases without the robot: learning and game, or the measured game only."),
    ] = "learning",
    jobs: Jobs = CPUS,
    run_limit: RunLimit = None,
    out: Annotated[
        Path, typer.Option(parser=parse_path, metavar="DIR", help="Results directory.")
    ] = Path("results"),
) -> None:
    """Measure what robots contribute: repeat each game without the robot, and compare with its reward.

    Example: kswarms contribution fig-6.4b --n 16 --robots S2 --seeds 5
    """
    scenarios = select_scenarios([source])
    if len(scenarios) > 1:
        raise InputError("id", source, f"must be one scenario: {', '.join(each.id for each in scenarios)}")
    scenario = scenarios[0]
    names = [each.name for each in scenario.conditions]
    if condition is None and len(names) > 1:
        raise InputError("condition", condition, f"must be one of {', '.join(map(repr, names))}")
    name = names[0] if condition is None else condition
    game = scenario.game(name, n)
    from kswarms.analysis.figures.contribution import write_contribution_figure
    from kswarms.analysis.measures.contribution import select_contributions, time_sud
    from kswarms.analysis.results.records import read_contributions
    from kswarms.analysis.tables.contribution import contribution_tables
    from kswarms.scenarios.contribution.games import RECORD, contributions, parse_robots
    from kswarms.scenarios.contribution.table import prepare_table, write_table
    from kswarms.scenarios.runs.trial import require_trials

    numbers = parse_robots(game, robots)
    require_trials([game], run_limit)
    prepare_table(out)
    found = contributions(
        game,
        numbers,
        range(first_seed, first_seed + seeds),
        absent_from,
        label=(scenario.id, name),
        play=lambda runs: play_tracked(runs, jobs, RECORD, "playing", run_limit),
        time_sud=time_sud,
    )
    print_line(f"table:  {write_table(out, found)}")
    question: dict[str, Any] = {"condition": name, "n": n, "absent_from": absent_from}
    figure = write_contribution_figure(out, scenario.title, scenario=scenario.id, **question)
    print_line(f"figure: {figure}")
    rows = select_contributions(read_contributions(out), scenario=scenario.id, **question)
    for heading, (header, *lines) in contribution_tables(rows):
        print_table(heading, header, lines)
