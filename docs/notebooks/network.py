# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # The interaction network
#
# The recorded conflicts of a game show which robots met, where they met, and which blocked each other.

# %%
# %matplotlib inline
import matplotlib.pyplot as plt
import pandas as pd
import seaborn as sns

from kswarms import ForagingModel
from kswarms.analysis.figures.heat_maps import heat_map_figure
from kswarms.analysis.figures.networks import jams_figure, network_figure
from kswarms.analysis.measures.networks import describe_network, jams, meeting_network, mixing_matrix

model = ForagingModel(n=36, policies="avoid,attack", duration=600, seed=1, record="conflicts")
model.play()
conflicts = model.datacollector.get_table_dataframe("conflicts")
conflicts[["robot", "swarm", "opponent", "opponent_swarm", "start", "x", "y", "action", "t_a", "t_p"]].head(3)

# %% [markdown]
# `kswarms.read_conflicts(directory)` reads the conflicts that `kswarms run … --record conflicts` wrote.
# Select the rows of one `run`.
#
# ## Which robots met
#
# The network is a networkx graph. Its nodes are robots. An edge joins two robots that met. It has the number
# of their conflicts and the time in conflict. You can use all functions of networkx.

# %%
network = meeting_network(conflicts)
pd.Series(describe_network(network)).round(3)

# %% [markdown]
# `assortativity` is Newman's assortativity coefficient by swarm. `chance` is its value if all robots meet
# equally often. Above `chance`, robots meet their own swarm more often than others; below it, less often.
# `assortativity_time` weights pairs by their time in conflict.

# %%
network_figure(network, "36 robots, S1 avoids, S2 attacks")

# %% [markdown]
# The next table has the time in conflict between swarms, in robot-seconds. Conflicts within a swarm count
# twice, once for each robot.

# %%
names = ["S1", "S2"]
pd.DataFrame(mixing_matrix(network, "time"), index=names, columns=names).round()

# %% [markdown]
# ## Jams
#
# At each second, the conflicts in progress link robots. A connected cluster of three or more robots is a
# jam.

# %%
jams_figure(jams(conflicts), "36 robots, S1 avoids, S2 attacks")

# %% [markdown]
# ## Where conflicts happen
#
# The maps show how many conflicts began in each cell of 5 × 5 cm, on a logarithmic scale: all conflicts, then
# those with each action.

# %%
heat_map_figure(conflicts, "36 robots, S1 avoids, S2 attacks", arena=model.arena)

# %% [markdown]
# ## What changes with the number of robots
#
# The last cell computes the share of conflict time between swarms and the share of robots in jams, for three
# pairs of policies and three numbers of robots.

# %%
rows = []
for policies in ("avoid,avoid", "avoid,attack", "attack,attack"):
    for n in (12, 24, 36):
        game = ForagingModel(n=n, policies=policies, duration=300, seed=0, record="conflicts")
        game.play()
        table = game.datacollector.get_table_dataframe("conflicts")
        rows.append(
            {
                "policies": policies,
                "N": n,
                "inter": describe_network(meeting_network(table))["inter"],
                "jammed": jams(table)["jammed"].mean() / n,
            }
        )
figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
labels = {"inter": "share of conflict time between swarms", "jammed": "share of robots in jams"}
for quantity, at in zip(labels, axes, strict=True):
    legend = quantity == "jammed"  # one for both
    sns.lineplot(pd.DataFrame(rows), x="N", y=quantity, hue="policies", marker="o", legend=legend, ax=at)
    at.set(xlabel="number of robots in all, N", ylabel=labels[quantity], ylim=(0, 1), xticks=(12, 24, 36))
axes[1].legend(loc="lower right", title="policies");
