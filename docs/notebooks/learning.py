# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # Learning
#
# A learner has one bandit for each swarm-ID that it can meet, with one arm for each action. Here S2 learns
# whether to flee from S1 or to fight it; within its swarm it flees. S1 attacks. The learning phase takes
# 1,000 s. Then a game of 300 s is measured, in which learners use what they learned.

# %%
import matplotlib.pyplot as plt
import pandas as pd
import seaborn as sns

from kswarms import ForagingModel
from kswarms.agents.learning.selection_rules import UCB
from kswarms.model.recorder import policy_rows

model = ForagingModel(
    n=40, policies="attack,inter-learner", learning=1000, duration=300, seed=2, record="conflicts"
)
model.play()

# %% [markdown]
# This is what one robot has learned: for each arm the sums of rewards and times, the number of choices, and
# Q = ΣR / ΣT (Eq. 4.15). After the learning phase it chooses the arm with the greatest Q.

# %%
robot = model.members[1][0]
pd.DataFrame(robot.policy.snapshot())

# %% [markdown]
# Every conflict was recorded. A learner's conflict with S1 has a reward, and Q of its arm afterwards.

# %%
conflicts = model.datacollector.get_table_dataframe("conflicts")
learned_from = conflicts[(conflicts["phase"] == "learning") & conflicts["reward"].notna()]
learned_from[["robot", "start", "action", "t_a", "t_p", "active", "reward", "q"]].head()

# %% [markdown]
# The course of learning of one robot: Q of both arms, and its choices. The bonus of UCB, √(γ ln N / N(a)),
# shrinks with each choice of an arm and grows while the arm is not chosen.

# %%
own = learned_from[learned_from["robot"] == robot.index]
figure, axes = plt.subplots(figsize=(8, 3.5))
for action, colour in (("flight", "tab:green"), ("fight", "tab:red")):
    chosen = own[own["action"] == action]
    axes.plot(chosen["start"], chosen["q"], "o-", color=colour, markersize=3, label=action)
axes.set(xlabel="time (s)", ylabel="Q of the arm after the conflict", title=f"robot {robot.index}, {UCB()!r}")
axes.legend();

# %% [markdown]
# The whole swarm: the share of fights among its choices, in windows of 100 s. Learners never stop exploring
# in this phase, so the share does not reach 0 or 1.

# %%
share = learned_from.assign(
    window=learned_from["start"] // 100 * 100 + 50, fight=learned_from["action"].eq("fight")
)
figure, axes = plt.subplots(figsize=(6, 3))
share.groupby("window")["fight"].mean().plot(ax=axes, marker="o")
axes.set(xlabel="time (s)", ylabel="share of fights", ylim=(0, 1));

# %% [markdown]
# What the swarm learned: for each action, the share of robots whose arm with the greatest Q it is.

# %%
pd.DataFrame(policy_rows(model))

# %% [markdown]
# The result depends on the number of robots. The same against an avoiding and an attacking swarm, at three
# densities with two seeds each: in small crowds robots learn to flee, in large ones to fight. (`kswarms run
# table-6.1` does this at all ten densities, with 3,000 s of learning.)

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
