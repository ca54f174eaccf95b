# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # Theory and contributions
#
# This notebook computes what a robot is worth to its swarm in three ways: from a game in normal form, from
# the times of a recorded game, and from the same game without the robot. [The theory and its
# functions](../theory.md) and [What a robot contributed](../contribution.md) have the details.

# %%
# %matplotlib inline
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import seaborn as sns

from kswarms import Game, GameModel, Swarm
from kswarms.agents.theory.games import NormalForm, is_pairwise_zero_sum, polymatrix, zero_sum
from kswarms.agents.theory.times import Interaction, pair_utility, time_utility
from kswarms.analysis.figures.game_forms import draw_polymatrix
from kswarms.analysis.measures.contribution import (
    freed_time,
    mean_contributions,
    select_contributions,
    time_sud,
)
from kswarms.analysis.measures.utilities import robot_utilities, utilities_by_swarm
from kswarms.scenarios.contribution.games import contributions, parse_robots

# %% [markdown]
# ## A game in normal form
#
# Time is utility: a second of program earns β, a second of conflict costs α (Eq. 4.1). Suppose that a
# flight takes 2.4 s and gives 8 s of program until the next conflict, and a fight 1.4 s and 6 s. Within a
# swarm each robot counts its own time. Between swarms the gain of one is the loss of the other (Eq. 4.3).

# %%
ACTIONS = ("flight", "fight")
spent = {"flight": Interaction(t_a=2.4, t_p=8.0), "fight": Interaction(t_a=1.4, t_p=6.0)}
own = np.array([[time_utility(*spent[mine]) for _ in ACTIONS] for mine in ACTIONS])
within = NormalForm(ACTIONS, ACTIONS, own, own.T)
between = zero_sum(ACTIONS, ACTIONS, [[pair_utility(spent[a], spent[b]) for b in ACTIONS] for a in ACTIONS])
pd.DataFrame(between.own.round(9), index=ACTIONS, columns=ACTIONS)

# %% [markdown]
# For three swarms these games form a *polymatrix* game, a graph with swarms as nodes. Each edge is the game
# between two swarms and is zero-sum. Each loop is the game within a swarm and is not zero-sum.

# %%
pairs = [(k, m) for k in (1, 2, 3) for m in (1, 2, 3) if k <= m]
graph = polymatrix({(k, m): within if k == m else between for k, m in pairs})
print("between swarms zero-sum:", is_pairwise_zero_sum(graph), "| within:", within.is_zero_sum())
draw_polymatrix(graph)

# %% [markdown]
# ## Utilities of a recorded game
#
# In a simulated game, these times result from motion and contacts. Here a swarm of eight avoiding robots
# plays against one of eight attacking robots, and every conflict is recorded.

# %%
swarms = (Swarm(policy="avoid", size=8), Swarm(policy="attack", size=8))
game = Game(swarms=swarms, duration=300)
model = GameModel(game, seed=1, record="conflicts")
model.play()
conflicts = pd.DataFrame(model.tables()["conflicts"])
robots = robot_utilities(conflicts, alpha=1.0, beta=1.0)
robots.head(3)

# %% [markdown]
# `u_1` and `u_2` are a robot's utilities from meetings with S1 and with S2, `utility` is their sum (Eq.
# 3.3), and `wlu` its Wonderful Life Utility W from times alone (Eq. 4.14). The sums by swarm:

# %%
utilities_by_swarm(robots)

# %% [markdown]
# `sud` is the Swarm Utility Difference, the utility of a swarm minus that of all others. For two swarms the
# differences always sum to zero (Corollary 6).

# %%
figure, axes = plt.subplots(figsize=(5, 3.5))
sns.scatterplot(robots, x="utility", y="wlu", hue="swarm", palette=["tab:green", "tab:red"], ax=axes)
axes.set(xlabel="utility of the robot, U (s)", ylabel="Wonderful Life Utility, W (s)");

# %% [markdown]
# ## The same game without a robot
#
# W estimates a difference: SUD with the robot minus SUD without it (Eq. 3.9). A simulation can measure it.
# Here six games are played with all robots, and again without robot 8 and without robot 9 of S2. The seeds
# are the same, so the games are equal until the absent robot would have come near another robot. `kswarms
# contribution fig-6.4b` does this for a scenario.

# %%
rows = contributions(game, parse_robots(game, "8,9"), range(6), label=("avoid-attack", ""), time_sud=time_sud)
question = select_contributions(pd.DataFrame(rows))
question[["seed", "robot", "sud", "sud_without", "pucks", "reward"]].head(4).round(2)

# %% [markdown]
# `pucks` is the contribution, `reward` the robot's reward in the game. The next table has the means over the
# seeds with their 95 % intervals. Robot −1 is the mean of the two robots:

# %%
means = mean_contributions(question)
means[["robot", "pucks", "pucks_low", "pucks_high", "reward", "reward_low", "reward_high"]].round(2)

# %% [markdown]
# Six seeds leave a wide interval. A single difference is mostly chance, because the two games soon diverge.
#
# The thesis assumes that without a robot, all time that others spent in conflicts with it would be program
# time (Eqs. 4.9 to 4.11). The *share freed* (`share`) measures this. It is 1 if the assumption is true, and 0
# if other conflicts take the place of these conflicts.

# %%
freed_time(question)[["others", "t_a", "t_a_without", "met", "share", "share_low", "share_high"]].round(2)
