# ---
# jupyter:
#   jupytext:
#     text_representation: {extension: .py, format_name: percent}
#   kernelspec: {display_name: Python 3, language: python, name: python3}
# ---

# %% [markdown]
# # First game
#
# Two swarms of ten robots each gather pucks in an arena of 2 × 2 m. S1 *avoids*: it flees from every robot.
# S2 *attacks*: it fights robots of S1 and flees from its own.

# %%
import math

import matplotlib.pyplot as plt
import pandas as pd
import seaborn as sns

from kswarms import ForagingModel

model = ForagingModel(n=20, policies="avoid,attack", duration=600, seed=1)

# %% [markdown]
# `step()` plays one sampling period of 10 s. The model is a Mesa model and its robots are Mesa agents. You
# can inspect them between two steps. State P is foraging (program), state A a conflict (action).

# %%
for _ in range(6):
    model.step()
robot = model.robots[0]
print(f"t = {model.time} s: robot 0 at {robot.position.round(2)}, state {robot.state}, puck {robot.carrying}")

# %% [markdown]
# This cell draws the arena. Supply stations are black, bases have the colour of their swarm. A white line
# shows the heading of a robot, a black dot a puck that it carries.

# %%
COLOURS = ("tab:green", "tab:red")


def draw_arena(model, axes):
    """Draw stations, bases and robots to scale."""
    arena, parameters = model.arena, model.game.parameters
    for x, y in arena.stations:
        axes.add_patch(plt.Circle((x, y), parameters.station_radius, color="black"))
    for (x, y), colour in zip(arena.bases, COLOURS, strict=True):
        axes.add_patch(plt.Circle((x, y), parameters.base_radius, color=colour, alpha=0.3))
    for robot in model.robots:
        x, y = robot.position
        radius = model.game.body.radius
        axes.add_patch(plt.Circle((x, y), radius, color=COLOURS[robot.swarm], alpha=0.9))
        ahead_x, ahead_y = x + radius * math.cos(robot.heading), y + radius * math.sin(robot.heading)
        axes.plot([x, ahead_x], [y, ahead_y], color="white")
        if robot.carrying:
            axes.plot(x, y, "o", color="black")
    axes.set(xlim=(-arena.half, arena.half), ylim=(-arena.half, arena.half), aspect="equal")
    axes.set(xlabel="x (m)", ylabel="y (m)", title=f"t = {model.time:.0f} s")


figure, axes = plt.subplots(figsize=(4.5, 4.5))
draw_arena(model, axes)

# %% [markdown]
# Play to the end. Mesa's DataCollector has a sample for each sampling period. `sud` is the Swarm Utility
# Difference, the pucks of a swarm minus those of all others. `share_a` is the share of time in conflict.

# %%
model.play()
samples = model.datacollector.get_model_vars_dataframe()
samples[["time", "pucks_1", "sud_1", "share_a_1", "pucks_2", "sud_2", "share_a_2"]].tail(3)

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
for swarm, colour in enumerate(COLOURS, 1):
    left.plot(samples["time"], samples[f"pucks_{swarm}"], color=colour, label=f"S{swarm}")
    right.plot(samples["time"], samples[f"share_a_{swarm}"], color=colour, label=f"S{swarm}")
left.set(xlabel="time (s)", ylabel="pucks deposited")
right.set(xlabel="time (s)", ylabel="share of time in conflict", ylim=(0, 1))
left.legend()
right.legend();

# %% [markdown]
# The result of a game has one row for each swarm. It has the robot-seconds in conflicts within the swarm
# (`t_a_intra`), in conflicts with other swarms (`t_a_inter`), and in the program (`t_p`).

# %%
pd.DataFrame(model.results()).set_index("swarm").T

# %% [markdown]
# Which policy is better depends on the number of robots. The last cell plays six games of 300 s at each of
# three numbers of robots.

# %%
rows = []
for n in (10, 30, 50):
    for seed in range(6):
        game = ForagingModel(n=n, policies="avoid,attack", seed=seed, duration=300, record="")
        game.play()
        rows += [{"N": n, "policy": row["policy"], "pucks": row["pucks"]} for row in game.results()]

figure, axes = plt.subplots(figsize=(5, 3.5))
palette = dict(zip(("avoid", "attack"), COLOURS, strict=True))
sns.pointplot(pd.DataFrame(rows), x="N", y="pucks", hue="policy", palette=palette, dodge=True, ax=axes)
axes.set(xlabel="number of robots in all, N", ylabel="pucks in 300 s (mean, 95 %)");
