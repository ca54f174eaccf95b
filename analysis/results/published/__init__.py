"""Published numbers for comparison with the simulator, as package data.

`table-6.1.csv` to `table-6.3.csv` are tables of the thesis; `argos_fixed_policies.csv` holds games of the
same controller in ARGoS 3 (time-limited, 600 s, ten seeds at each density).
"""

from importlib.resources import files

import pandas as pd

_DELTAS = ("0.02", "0.08", "0.125", "0.2", "0.25")


def _read_csv(name: str) -> pd.DataFrame:
    with files(__name__).joinpath(name).open("rb") as source:
        return pd.read_csv(source)


def table_6_1() -> pd.DataFrame:
    """Return Table 6.1: robots that learned to attack the other swarm, for each density.

    Ten rows. `n` (int64): robots in all; `fig_6_4a_attack_pct`, `fig_6_4b_attack_pct` (float64): percent of
    the learning swarm's robots, against an avoiding (6.4a) and an attacking (6.4b) swarm.
    """
    return _read_csv("table-6.1.csv")


def table_6_2() -> pd.DataFrame:
    """Return Table 6.2: robots that learned with both bandits (Fig. 6.8), for each density.

    Ten rows. `n` (int64): robots in all; `inter_attack_pct`, `intra_avoid_pct` (float64): percent of the
    learning swarm's robots that learned to fight the other swarm, and to flee within their own.
    """
    return _read_csv("table-6.2.csv")


def table_6_3() -> pd.DataFrame:
    """Return Table 6.3: robots that learned to attack an attacking swarm (Fig. 6.12), for each density.

    Ten rows. `n` (int64): robots in all; `d0.02` … `d0.25` (float64): percent of the learning swarm's
    robots, for each Δ.
    """
    return _read_csv("table-6.3.csv")


def learned_percentages() -> pd.DataFrame:
    """Return Tables 6.1, 6.2 and 6.3 as one table.

    Ninety rows. `scenario`, `condition` (str): curve of the figure; `learned` (str): ``attack`` (the other
    swarm) or ``flight within`` (the own swarm); `n` (int64): robots in all; `published` (float64): percent
    of the learning swarm's robots.
    """
    attack, within = "attack", "flight within"
    columns = [
        (table_6_1(), "fig_6_4a_attack_pct", "fig-6.4a", "", attack),
        (table_6_1(), "fig_6_4b_attack_pct", "fig-6.4b", "", attack),
        (table_6_2(), "inter_attack_pct", "fig-6.8", "", attack),
        (table_6_2(), "intra_avoid_pct", "fig-6.8", "", within),
        *((table_6_3(), f"d{delta}", "fig-6.12", f"delta={delta}", attack) for delta in _DELTAS),
    ]
    parts = []
    for table, column, scenario, condition, learned in columns:
        curve = {"scenario": scenario, "condition": condition, "learned": learned}
        parts.append(pd.DataFrame({**curve, "n": table["n"], "published": table[column].astype("float64")}))
    return pd.concat(parts, ignore_index=True)


def published_cells() -> pd.Series:
    """Return all published numbers that a quantity can be compared with (float64).

    The index has the levels `scenario`, `condition`, `swarm`, `measure` and `n`. The measures are the learned
    percentages of Tables 6.1 to 6.3, and the pucks of the ARGoS games as means over the seeds.
    """
    tables = learned_percentages()
    tables["measure"] = tables["learned"].map(
        {"attack": "learned_attack", "flight within": "learned_flight_within"}
    )
    games = argos_fixed_policies()
    games["scenario"] = "argos-" + games["s1_policy"] + "-" + games["s2_policy"]
    means = games.groupby(["scenario", "n"])[["score1", "score2"]].mean().reset_index()
    scores = [
        means[["scenario", "n"]].assign(
            swarm=swarm, condition="", measure="pucks", published=means[f"score{swarm}"]
        )
        for swarm in (1, 2)
    ]
    every = pd.concat([tables.assign(swarm=2), *scores], ignore_index=True)
    index = pd.MultiIndex.from_frame(every[["scenario", "condition", "swarm", "measure", "n"]])
    return pd.Series(every["published"].to_numpy("float64"), index).sort_index()


def argos_fixed_policies() -> pd.DataFrame:
    """Return the games of two swarms with fixed policies in ARGoS 3.

    150 rows. `s1_policy`, `s2_policy` (str); `n` (int64): robots in all; `seed` (int64): 1 … 10; and for each
    swarm k = 1, 2: `score1`, `score2` (int64): pucks; `ta_intra1` …, `ta_inter1` …, `tp1` … (float64):
    robot-seconds in conflicts within the swarm, in conflicts with the other swarm, and in the program.
    """
    return _read_csv("argos_fixed_policies.csv")
