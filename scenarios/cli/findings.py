"""``findings``: judge findings in the default world and in the worlds of a calibration."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from kswarms.agents.common.atomic_files import output_path
from kswarms.agents.common.errors import InputError
from kswarms.model.description.parameters import Parameters
from kswarms.model.description.presets import PRESETS, ensemble
from kswarms.scenarios.calibration.directory import read_ensemble
from kswarms.scenarios.calibration.prior import PRIOR
from kswarms.scenarios.calibration.worlds import in_world
from kswarms.scenarios.catalogue import CATALOGUE
from kswarms.scenarios.catalogue.selection import select_scenarios, with_densities_and_seeds
from kswarms.scenarios.cli.options import CPUS, Jobs, Progress, parse_path
from kswarms.scenarios.cli.printing import print_line, print_table
from kswarms.scenarios.description.text import parse_integers

TABLE = "findings.csv"
"""File of the verdicts."""


def findings(
    context: typer.Context,
    worlds: Annotated[
        int, typer.Option(min=0, help="Worlds of the ensemble, besides the default world.")
    ] = 0,
    calibration: Annotated[
        Path | None,
        typer.Option(
            parser=parse_path,
            metavar="DIR",
            help="Directory of `kswarms calibrate`. [default: the published ensemble]",
        ),
    ] = None,
    file: Annotated[
        Path | None,
        typer.Option(
            "--findings", parser=parse_path, metavar="FILE", help="Findings in TOML. [default: the thesis's]"
        ),
    ] = None,
    densities: Annotated[
        str, typer.Option(metavar="N,N,...", help="Numbers of robots.")
    ] = "6,16,26,30,36,40,50",
    seeds: Annotated[int, typer.Option(help="Games for each density, in each world.")] = 4,
    first_seed: Annotated[int, typer.Option(min=0, help="First seed.")] = 3000,
    jobs: Jobs = CPUS,
    out: Annotated[
        Path, typer.Option(parser=parse_path, metavar="DIR", help="Output directory; games in it are kept.")
    ] = Path("findings"),
    progress: Progress = "bar",
) -> int:
    """Judge findings in several worlds: the default one, and worlds of the ensemble.

    DIR gets a study for each world, and findings.csv. The same command resumes an interrupted one.

    Example: kswarms findings --worlds 12 --jobs 2
    """
    from kswarms.analysis.findings import FINDINGS, read_findings
    from kswarms.analysis.findings.worlds.judging import judge_over_worlds, worlds_table
    from kswarms.analysis.results.runs import read_results
    from kswarms.scenarios.cli.playing import Plan, play_study

    chosen = read_findings(file) if file is not None else FINDINGS
    members = ensemble() if calibration is None else read_ensemble(calibration)
    if len(members) < worlds:
        raise InputError("worlds", worlds, f"must be at most {len(members)}, the worlds of the ensemble")
    ids = dict.fromkeys(name for finding in chosen for name in finding.scenarios if name in CATALOGUE)
    scenarios, _ = with_densities_and_seeds(
        select_scenarios(ids), parse_integers("densities", densities), seeds, suitable_only=True
    )
    command = shlex.join(context.obj)
    results = []
    for name, world in {"default": PRESETS["fitted"], **_named(members[:worlds])}.items():
        plan = Plan(
            [in_world(scenario, world) for scenario in scenarios],
            first_seed, (1, 1), [], "longest", jobs, None, None, False,
        )  # fmt: skip
        _, failed = play_study(out / name, plan, command, progress)
        if failed:
            return 1
        results.append(({free: getattr(world, free) for free in PRIOR}, read_results(out / name)))
    (_, default), *others = results
    frame = judge_over_worlds(chosen, default, others)
    with output_path(out / TABLE, "out") as path:
        frame.to_csv(path, index=False)
    table = worlds_table(frame)
    print_table("findings", table.header, table.rows, table.caption)
    print_line(f"table: {out / TABLE}")
    return 0


def _named(members: Sequence[Parameters]) -> dict[str, Parameters]:
    return {f"world-{number:02}": world for number, world in enumerate(members, 1)}
