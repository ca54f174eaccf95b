"""Theory of competitive multi-swarm games as pure functions (specification, part 1).

`swarms` has utilities and their difference, `wlu` the Wonderful Life Utility, `times` both for time as
utility, `estimates` a robot's estimates from its own sensors, `games` the forms of the game. docs/theory.md
maps every equation to its function.
"""
