# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # User-defined policies, rewards and rules
#
# A policy is a class in a file of your own. You can use its name, with the path of the file, wherever you can
# use the name of a policy. The files of this notebook are in `docs/examples`. [Extend](../extending.md)
# describes what each class needs.

# %%
from functools import partial
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd
import seaborn as sns

from kswarms import ForagingModel, make_policy
from kswarms.agents.conformance import POLICY_CHECKS, REWARD_CHECKS, RULE_CHECKS
from kswarms.agents.user_code.loading import load_class
from kswarms.model.recorder import policy_rows

EXAMPLES = "../examples"
print(Path(EXAMPLES, "cautious.py").read_text())

# %%
CAUTIOUS = f"{EXAMPLES}/cautious.py:Cautious"
model = ForagingModel(n=20, policies=f"avoid,{CAUTIOUS}(patience=2)", duration=300, seed=1)
model.play()
pd.DataFrame(model.results())[["swarm", "policy", "pucks", "conflicts_inter"]]

# %% [markdown]
# ## Check it
#
# `kswarms.agents.conformance` has the checks that every policy, reward and rule must pass: the same seed
# gives the same choices, robots share no state, copies behave alike, and so on. A failing check says what
# is wrong.

# %%
for check in POLICY_CHECKS:
    check(partial(make_policy, CAUTIOUS))
    print("passed:", check.__name__)

# %% [markdown]
# ## Compare it
#
# Which patience is best, and at which number of robots? This cell plays three seeds of each combination. With
# `patience=0` the swarm always fights the other swarm. `sud` is the difference of the scores.

# %%
rows = []
for n in (16, 40):
    for patience in (0, 1, 3, 9):
        for seed in range(3):
            game = ForagingModel(
                n=n, policies=f"avoid,{CAUTIOUS}(patience={patience})", duration=200, seed=seed, record=""
            )
            game.play()
            rows.append({"N": n, "patience": patience, "sud": game.results()[1]["sud"]})
figure, axes = plt.subplots(figsize=(5, 3.5))
sns.pointplot(pd.DataFrame(rows), x="patience", y="sud", hue="N", palette="deep", dodge=True, ax=axes)
axes.axhline(0, color="grey", linewidth=1)
axes.set(ylabel="pucks ahead of the avoiding swarm");

# %% [markdown]
# ## A reward and a rule
#
# A learner takes the names of a reward and a selection rule as arguments. WLU and UCB are the defaults.

# %%
print(Path(EXAMPLES, "haste.py").read_text())

# %%
HASTE, EPSILON = (f"{EXAMPLES}/haste.py:{name}" for name in ("Haste", "EpsilonGreedy"))
for check in REWARD_CHECKS:
    check(load_class("reward", HASTE))
for check in RULE_CHECKS:
    check(load_class("rule", EPSILON))

LEARNERS = {
    "WLU, UCB": "inter-learner",
    "Haste, UCB": f"inter-learner(reward='{HASTE}')",
    "Haste, ε-greedy": f"inter-learner(reward='{HASTE}', rule='{EPSILON}')",
}
rows = []
for name, text in LEARNERS.items():
    for seed in range(2):
        game = ForagingModel(
            n=30, policies=f"attack,{text}", learning=1000, duration=100, seed=seed, record=""
        )
        game.play()
        learned = policy_rows(game)[0]["attack_share"]
        rows.append({"learner": name, "learned to attack": learned, "pucks": game.pucks[1]})
pd.DataFrame(rows).groupby("learner").mean()
