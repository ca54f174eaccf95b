# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # Learning and its traces
#
# A learner has a bandit for each swarm-ID that it can meet, with an arm for each action. Here S2 learns
# whether to flee from S1 or to fight it; within the swarm it flees. S1 attacks. Learning takes 1,000 s,
# then a game of 300 s is measured in which everyone keeps to what it learned.

# %%
import matplotlib.pyplot as plt
import pandas as pd
import seaborn as sns

from kswarms.agents.learning.selection_rules import UCB
from kswarms.model.foraging import ForagingModel
from kswarms.model.recorder import policy_rows

model = ForagingModel(
    n=40, policies="attack,inter-learner", learning=1000, duration=300, seed=2, record="conflicts"
)
model.play()

# %% [markdown]
# What one robot knows at the end: for each arm the sums of rewards and of times, how often it was taken,
# and Q = ΣR / ΣT (Eq. 4.15). After learning it takes the arm of the greatest Q.

# %%
robot = model.members[1][0]
pd.DataFrame(robot.policy.snapshot())

# %% [markdown]
# Every conflict was recorded. A learner's conflict with S1 has a reward, and the Q of its arm after it.

# %%
conflicts = model.datacollector.get_table_dataframe("conflicts")
learned_from = conflicts[(conflicts["phase"] == "learning") & conflicts["reward"].notna()]
learned_from[["robot", "start", "action", "t_a", "t_p", "active", "reward", "q"]].head()

# %% [markdown]
# One robot's trace: Q of both arms as the conflicts come in, and what it chose. The bonus of UCB, √(γ ln N
# / N(a)), shrinks with each choice of an arm and grows while the arm waits.

# %%
own = learned_from[learned_from["robot"] == robot.index]
figure, axes = plt.subplots(figsize=(8, 3.5))
for action, colour in (("flight", "tab:green"), ("fight", "tab:red")):
    chosen = own[own["action"] == action]
    axes.plot(chosen["start"], chosen["q"], "o-", color=colour, markersize=3, label=action)
axes.set(xlabel="time (s)", ylabel="Q of the arm after the conflict", title=f"robot {robot.index}, {UCB()!r}")
axes.legend();

# %% [markdown]
# And of the swarm: the share of fights among its choices, in windows of 100 s. Exploration never stops
# while it learns, so the share does not become 0 or 1.

# %%
share = learned_from.assign(
    window=learned_from["start"] // 100 * 100 + 50, fight=learned_from["action"].eq("fight")
)
figure, axes = plt.subplots(figsize=(6, 3))
share.groupby("window")["fight"].mean().plot(ax=axes, marker="o")
axes.set(xlabel="time (s)", ylabel="share of fights", ylim=(0, 1));

# %% [markdown]
# What the swarm learned is the share of its robots whose arm of the greatest Q is each action.

# %%
pd.DataFrame(policy_rows(model))

# %% [markdown]
# The crowd decides. The same against an avoiding and an attacking swarm, at three densities, two seeds
# each: in a small crowd robots learn to flee, in a large one to fight. (`kswarms run table-6.1` does this
# at all ten densities, over 3,000 s.)

# %%
rows = []
for n in (10, 30, 50):
    for opponent in ("avoid", "attack"):
        for seed in range(2):
            game = ForagingModel(
                n=n, policies=f"{opponent},inter-learner", learning=1000, duration=1, seed=seed, record=""
            )
            game.play()
            rows.append({"N": n, "S1": opponent, "attack": policy_rows(game)[0]["attack_share"]})

figure, axes = plt.subplots(figsize=(5, 3))
sns.barplot(pd.DataFrame(rows), x="N", y="attack", hue="S1", errorbar=None, ax=axes)
axes.set(xlabel="number of robots in all, N", ylabel="share that learned to attack", ylim=(0, 1));
