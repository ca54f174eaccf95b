"""Limits of input values. Times in seconds, distances in metres."""

from typing import Final

LONGEST_TIME: Final = 1e9  # duration of an action or a sampling period, mean of a wander leg
LONGEST_DISTANCE: Final = 10_000.0  # side of the arena, sensing range, gap at the start
SHORTEST_PERIOD: Final = 1e-6  # control period, so that periods can be counted
SLOWEST_TURN: Final = 1e-9  # turning rate (rad/s)
LONGEST_STEP: Final = 0.8  # motion in a period, in radii, so that two robots do not pass through each other
MAX_PERIODS: Final = 2**53  # number of control periods, so that float64 counts them exactly
MAX_ROBOTS: Final = 1_000_000  # size of a swarm, and number of robots divided among swarms
MAX_PUCKS: Final = 10**9  # puck limit and supply
MAX_PLACES: Final = 1000  # number of stations, and of bases
MAX_SEEDS: Final = 1_000_000  # number of seeds of a scenario
MAX_SEED: Final = 2**53  # seed, so that every table and file stores it exactly
MAX_POINTS: Final = 1000  # number of conditions of a scenario with a grid
LONGEST_NAME: Final = 100  # characters of a name, which files are named after
LONGEST_TITLE: Final = 200  # characters of a title
MAX_RUN_LIMIT: Final = 1e7  # time limit of a run (s)
# Text without line breaks, control characters and changes of the writing direction.
ONE_LINE: Final = r"^[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]*$"
MAX_JOBS: Final = 1024  # worker processes
MAX_TEXT_FILE: Final = 10_000_000  # bytes of a TOML or Python file
MAX_CODE_FILES: Final = 10_000  # files of a package with user-defined code
MAX_JSON_FILE: Final = 100_000_000  # bytes of a JSON file: learned policies, measured shares, manifest
