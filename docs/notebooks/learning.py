# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # Learning
#
# A learner has one multi-armed bandit for each swarm that it learns about, with one arm for each action. Here
# S2 learns whether to flee from S1 or to fight it. Within its swarm it flees. S1 attacks. The learning phase
# takes 1,000 s. Then a game of 300 s is measured, in which learners use what they learned.

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
# The next table shows what one robot has learned. Each arm has the sum of its rewards, the sum of its times,
# the number of its choices, and Q = ΣR / ΣT, the mean reward per second (Eq. 4.15 of the thesis). After the
# learning phase the robot chooses the arm with the greatest Q.

# %%
robot = model.members[1][0]
pd.DataFrame(robot.policy.snapshot())

# %% [markdown]
# Every conflict was recorded. A learner's conflict with S1 has a reward, and the value Q of its arm after the
# conflict. `t_a` is the time of the action, `t_p` the time until the next conflict.

# %%
conflicts = model.datacollector.get_table_dataframe("conflicts")
learned_from = conflicts[(conflicts["phase"] == "learning") & conflicts["reward"].notna()]
learned_from[["robot", "start", "action", "t_a", "t_p", "active", "reward", "q"]].head()

# %% [markdown]
# The next figure shows how one robot learns: each point is a choice, with Q of the chosen arm. The rule UCB
# (upper confidence bound) chooses the arm with the greatest sum of Q and a bonus √(γ ln N / N(a)). N(a) is
# the number of choices of the arm, N that of all choices. The bonus of an arm shrinks with each of its
# choices and grows while it is not chosen.

# %%
own = learned_from[learned_from["robot"] == robot.index]
figure, axes = plt.subplots(figsize=(8, 3.5))
for action, colour in (("flight", "tab:green"), ("fight", "tab:red")):
    chosen = own[own["action"] == action]
    axes.plot(chosen["start"], chosen["q"], "o-", color=colour, markersize=3, label=action)
axes.set(xlabel="time (s)", ylabel="Q of the arm after the conflict", title=f"robot {robot.index}, {UCB()!r}")
axes.legend();

# %% [markdown]
# For the whole swarm, this figure shows the share of fights among the choices, in windows of 100 s. Learners
# explore during the whole phase, so the share does not reach 0 or 1.

# %%
share = learned_from.assign(
    window=learned_from["start"] // 100 * 100 + 50, fight=learned_from["action"].eq("fight")
)
figure, axes = plt.subplots(figsize=(6, 3))
share.groupby("window")["fight"].mean().plot(ax=axes, marker="o")
axes.set(xlabel="time (s)", ylabel="share of fights", ylim=(0, 1));

# %% [markdown]
# The column `share` shows what the swarm learned: the share of robots for which the action has the greatest
# Q.

# %%
pd.DataFrame(policy_rows(model))

# %% [markdown]
# The result depends on the number of robots N. The last cell lets a swarm learn against an avoiding and an
# attacking swarm, at three values of N with two seeds each. At low N robots learn to flee, at high N to
# fight. `kswarms run table-6.1` does this at all ten values of N, with 3,000 s of learning.

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
