# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # Your own scenario and sweep
#
# A scenario describes an experiment: conditions (curves of a figure), numbers of robots, and seeds. This
# scenario measures the effect of a higher speed on a swarm that avoids. `drive` is the speed as a fraction of
# the top speed.

# %%
import matplotlib.pyplot as plt
import mesa
import pandas as pd
import seaborn as sns

from kswarms import Condition, ForagingModel, Scenario, SwarmRule
from kswarms.scenarios.runs.run import expand
from kswarms.scenarios.runs.sweep import play_all

scenario = Scenario(
    id="faster",
    title="A faster swarm avoids one that attacks",
    densities=(10, 30),
    seeds=3,
    conditions=tuple(
        Condition(
            name=f"drive={drive}",
            swarms=(SwarmRule(policy="avoid", drive=drive), SwarmRule(policy="attack")),
            duration=200,
        )
        for drive in (0.6, 0.8)
    ),
)

# %% [markdown]
# A scenario can be written as TOML. If you save this text as `faster.toml`, `kswarms run faster.toml` plays
# it:

# %%
print(scenario.to_toml())

# %% [markdown]
# The scenario has a run for each combination of condition, number of robots and seed. Here the runs are
# played in the process of the notebook. The command line uses one process for each CPU.

# %%
runs = expand([scenario])
rows = []
for run, outcome in play_all(runs):
    _, condition = run.labels[0]
    rows += [{"condition": condition, "N": run.n, "seed": run.seed, **row} for row in outcome.swarms]
results = pd.DataFrame(rows)
results.pivot_table(index=["condition", "N"], columns="swarm", values="pucks")

# %% [markdown]
# Games with the same seed start in the same state. The conditions are therefore compared seed by seed. The
# difference is the effect of the speed.

# %%
by_seed = results.pivot_table(index=["N", "seed", "swarm"], columns="condition", values="pucks")
gain = (by_seed["drive=0.8"] - by_seed["drive=0.6"]).rename("gain").reset_index()
figure, axes = plt.subplots(figsize=(5, 3))
sns.stripplot(gain, x="N", y="gain", hue="swarm", palette=["tab:green", "tab:red"], dodge=True, ax=axes)
axes.axhline(0, color="grey", linewidth=1)
axes.set(xlabel="number of robots in all, N", ylabel="pucks gained by S1's speed");

# %% [markdown]
# ## The same with `mesa.batch_run`
#
# Every argument of `ForagingModel` is a number or a string, so Mesa's batch runner can sweep it. Pass seeds
# as values of the parameter `seed`; `iterations` would repeat the same game. In a notebook, one process is
# simplest. More processes need a script with the guard `if __name__ == "__main__":`.

# %%
swept = mesa.batch_run(
    ForagingModel,
    {
        "policies": "avoid,attack",
        "n": 30,
        "drives": ["0.6,0.6", "0.7,0.6", "0.8,0.6"],
        "duration": 200.0,
        "seed": range(3),
    },
    number_processes=1,
    data_collection_period=-1,
    display_progress=False,
)
sweep = pd.DataFrame(swept)
sweep.groupby("drives")[["pucks_1", "pucks_2", "share_a_1", "share_a_2"]].mean()
