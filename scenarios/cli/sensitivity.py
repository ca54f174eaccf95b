"""``sensitivity``: which free parameters a measure depends on."""

from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from kswarms.agents.common.atomic_files import output_path
from kswarms.agents.common.errors import InputError
from kswarms.scenarios.calibration.directory import open_calibration
from kswarms.scenarios.calibration.evidence import require_games
from kswarms.scenarios.calibration.prior import PRIOR
from kswarms.scenarios.cli.calibrate import play_runs
from kswarms.scenarios.cli.options import CPUS, Jobs, complete_scenario_ids, parse_path
from kswarms.scenarios.cli.printing import print_line, print_table
from kswarms.scenarios.description.text import parse_integers, split_words

TABLE = "sensitivity.csv"
"""File of the indices."""


def sensitivity(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="ID", help="Scenario of `kswarms list`.", autocompletion=complete_scenario_ids
        ),
    ],
    condition: Annotated[str, typer.Option(metavar="NAME", help="Condition; see `kswarms show`.")] = "",
    measure: Annotated[str, typer.Option(metavar="NAME", help="Measure of docs/findings.md.")] = "pucks",
    swarm: Annotated[int | None, typer.Option(help="Swarm of the measure. [default: all together]")] = None,
    densities: Annotated[str, typer.Option(metavar="N,N,...", help="Numbers of robots.")] = "30",
    free: Annotated[
        str | None,
        typer.Option(metavar="NAME,...", help="Parameters of docs/calibration.md. [default: all]"),
    ] = None,
    trajectories: Annotated[int, typer.Option(min=2, max=1000, help="Trajectories of the design.")] = 10,
    seeds: Annotated[int, typer.Option(min=1, max=1000, help="Games for each world and density.")] = 2,
    jobs: Jobs = CPUS,
    out: Annotated[
        Path, typer.Option(parser=parse_path, metavar="DIR", help="Output directory; games in it are kept.")
    ] = Path("sensitivity"),
    fresh: Annotated[bool, typer.Option("--fresh", help="Delete the games in DIR.")] = False,
) -> None:
    """Print Morris's indices: how strongly a measure depends on each free parameter.

    Example: kswarms sensitivity fig-6.8 --measure learned_attack --swarm 2 --densities 30
    """
    try:
        from kswarms.scenarios.calibration.sensitivity import sensitivity as indices_of
    except ModuleNotFoundError as error:
        rule = "must be installed: pip install kswarms[sensitivity]"
        raise InputError("library", error.name, rule) from None
    from kswarms.analysis.findings.quantity import Quantity

    names = split_words(free) if free is not None else tuple(PRIOR)
    for name in names:
        if name not in PRIOR:
            raise InputError("free", name, f"must be among {', '.join(PRIOR)}")
    quantity = Quantity(measure=measure, scenario=scenario, condition=condition, swarm=swarm)
    curves = {(scenario, condition): parse_integers("densities", densities)}
    require_games(curves)
    about = {"quantity": quantity.model_dump(mode="json"), "densities": densities, "free": list(names)}
    directory = open_calibration(
        out, {**about, "trajectories": trajectories, "seeds": seeds}, partial(play_runs, jobs), fresh
    )
    found = indices_of(names, curves, seeds, partial(_mean, quantity), directory.evidence, trajectories)
    header = ["parameter", "mu_star", "interval", "sigma", "mu"]
    rows = [[row.parameter, *(f"{value:.6g}" for value in row[1:])] for row in found]
    with output_path(out / TABLE, "out") as path:
        path.write_text("".join(",".join(row) + "\n" for row in [header, *rows]), encoding="utf-8")
    shown = [[row.parameter, *(f"{value:.3g}" for value in row[1:])] for row in found]
    caption = f"{quantity.unit}, for the range of a parameter; {trajectories} trajectories, seeds: {seeds}"
    print_table(f"sensitivity of {quantity}", ["parameter", "μ*", "± (95 %)", "σ", "μ"], shown, caption)
    print_line(f"table: {out / TABLE}")


def _mean(quantity: Any, rows: Any) -> float:
    """Return the mean of a quantity over seeds and densities."""
    from kswarms.analysis.findings.data import sample
    from kswarms.analysis.results.runs import Results

    table = sample(Results.of_rows(rows.swarms, rows.policies), quantity)
    if table.empty:
        raise InputError("measure", quantity.measure, f"must be a measure of the games: none of {quantity}")
    return float(table.to_numpy().mean())
