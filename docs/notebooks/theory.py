# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # Theory and contributions
#
# What is a robot worth to its swarm? Three answers, from the idealised to the true one: a game in normal
# form, utilities measured on a recorded game, and the same game without the robot.
# [The theory and its functions](../theory.md) and [What a robot contributed](../contribution.md) tell all
# that is only touched here.

# %%
# %matplotlib inline
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import seaborn as sns

from kswarms.agents.theory.games import NormalForm, is_pairwise_zero_sum, polymatrix, zero_sum
from kswarms.agents.theory.times import Interaction, pair_utility, time_utility
from kswarms.analysis.figures.game_forms import draw_polymatrix
from kswarms.analysis.measures.contribution import assumption, means, of_question, time_sud
from kswarms.analysis.measures.utilities import robot_utilities, swarm_utilities
from kswarms.model.description.game import Game, Swarm
from kswarms.model.game_model import GameModel
from kswarms.scenarios.contribution.games import contributions, robots_of

# %% [markdown]
# ## A game in normal form
#
# Time is utility: a second of program is worth β, a second of conflict costs α (Eq. 4.1). Say that a flight
# takes 2.4 s and gives 8 s of program until the next conflict, a fight 1.4 s and 6 s. Within a swarm each
# counts its own time; between swarms what one gains the other loses (Eq. 4.3).

# %%
ACTIONS = ("flight", "fight")
spent = {"flight": Interaction(t_a=2.4, t_p=8.0), "fight": Interaction(t_a=1.4, t_p=6.0)}
own = np.array([[time_utility(*spent[mine]) for _ in ACTIONS] for mine in ACTIONS])
within = NormalForm(ACTIONS, ACTIONS, own, own.T)
between = zero_sum(ACTIONS, ACTIONS, [[pair_utility(spent[a], spent[b]) for b in ACTIONS] for a in ACTIONS])
pd.DataFrame(between.own.round(9), index=ACTIONS, columns=ACTIONS)

# %% [markdown]
# Of three swarms these games make a *polymatrix* game: one on each edge, and one on each loop for meetings
# within a swarm. Its edges are zero-sum, its loops are not.

# %%
pairs = [(k, m) for k in (1, 2, 3) for m in (1, 2, 3) if k <= m]
graph = polymatrix({(k, m): within if k == m else between for k, m in pairs})
print("between swarms zero-sum:", is_pairwise_zero_sum(graph), "| within:", within.is_zero_sum())
draw_polymatrix(graph)

# %% [markdown]
# ## Utilities of a recorded game
#
# In a game nobody is told these times; they come out of motion and contacts. Eight robots that avoid meet
# eight that attack, and every conflict is recorded.

# %%
swarms = (Swarm(policy="avoid", size=8), Swarm(policy="attack", size=8))
game = Game(swarms=swarms, duration=300)
model = GameModel(game, seed=1, record="conflicts")
model.play()
conflicts = pd.DataFrame(model.tables()["conflicts"])
robots = robot_utilities(conflicts, alpha=1.0, beta=1.0)
robots.head(3)

# %% [markdown]
# `u_1` and `u_2` are what a robot has from meetings with S1 and with S2, `utility` is their sum (Eq. 3.3),
# `wlu` its Wonderful Life Utility from times alone (Eq. 4.14). Added up by swarm:

# %%
swarm_utilities(robots)

# %% [markdown]
# The two Swarm Utility Differences cancel, as those of two swarms always do (Corollary 6).

# %%
figure, axes = plt.subplots(figsize=(5, 3.5))
sns.scatterplot(robots, x="utility", y="wlu", hue="swarm", palette=["tab:green", "tab:red"], ax=axes)
axes.set(xlabel="utility of the robot, U (s)", ylabel="Wonderful Life Utility, W (s)");

# %% [markdown]
# ## The same game without a robot
#
# W estimates a difference: SUD with the robot less SUD without it (Eq. 3.9). A simulation can measure it.
# Here each of two robots of S2 is missing from the same six games; the seeds are the same, so the world is
# the same until the missing robot would have come near somebody. (`kswarms contribution fig-6.4b` does this
# for a scenario.)

# %%
rows = contributions(game, robots_of(game, "8,9"), range(6), label=("avoid-attack", ""), time_sud=time_sud)
question = of_question(pd.DataFrame(rows))
question[["seed", "robot", "sud", "sud_without", "pucks", "reward"]].head(4).round(2)

# %% [markdown]
# `pucks` is the contribution, `reward` what the robot would have been rewarded in the game. Means over the
# seeds with their 95 % intervals, robot −1 being the mean robot of the two:

# %%
means(question)[["robot", "pucks", "pucks_low", "pucks_high", "reward", "reward_low", "reward_high"]].round(2)

# %% [markdown]
# Six seeds leave a wide interval: a single difference is mostly chance, for the two games part soon.
#
# The source assumes that without a robot all time which others spent in conflicts with it were program time
# (Eqs. 4.9 to 4.11). What became of it is the *share freed*: 1 if the assumption holds, 0 if other conflicts
# took the place of those.

# %%
assumption(question)[["others", "t_a", "t_a_without", "met", "share", "share_low", "share_high"]].round(2)
