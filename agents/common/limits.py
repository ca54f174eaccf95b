"""Largest and smallest values that input may have."""

from typing import Final

LONGEST_TIME: Final = 1e9
"""Maximum duration of an action or a sampling period, and maximum mean of a wander leg (s)."""
LONGEST_DISTANCE: Final = 10_000.0
"""Maximum side of the arena, range of a sense and gap at the start (m)."""
SHORTEST_PERIOD: Final = 1e-6
"""Minimum control period (s), so that periods can be counted."""
SLOWEST_TURN: Final = 1e-9
"""Minimum turning rate (rad/s)."""
LONGEST_STEP: Final = 0.8
"""Maximum distance that a robot covers in a period, in radii: two robots must not pass through each other."""
MOST_PERIODS: Final = 2**53
"""Maximum number of control periods, so that float64 counts them exactly."""
MOST_ROBOTS: Final = 1_000_000
"""Maximum size of a swarm, and of the number of robots divided among swarms."""
MOST_PUCKS: Final = 10**9
"""Maximum of puck limit and supply."""
MOST_PLACES: Final = 1000
"""Maximum number of stations, and of bases."""
MOST_SEEDS: Final = 1_000_000
"""Maximum number of seeds of a scenario."""
LAST_SEED: Final = 2**53
"""Largest seed, so that every table and file stores it exactly."""
MOST_POINTS: Final = 1000
"""Maximum number of conditions of a scenario with a grid."""
LONGEST_NAME: Final = 100
"""Maximum number of characters of a name, which files are named after."""
LONGEST_TITLE: Final = 200
"""Maximum number of characters of a title."""
MOST_JOBS: Final = 1024
"""Maximum number of worker processes."""
