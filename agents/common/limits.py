"""Limits of input values. Times in seconds, distances in metres."""

from typing import Final

SHORTEST_TIME: Final = 1e-6  # any time but 0, so that float64 counts the periods of the longest time exactly
LONGEST_TIME: Final = 1e9  # any time: 30 years
LONGEST_PERIOD: Final = 1.0  # control period, so that robots react
SHORTEST_DISTANCE: Final = 1e-4  # any distance but 0: bodies may overlap by it
LONGEST_DISTANCE: Final = 10_000.0  # any distance
SMALLEST_RADIUS: Final = 1e-3  # of a body
LARGEST_RADIUS: Final = 1000.0  # of a body
SLOWEST: Final = 1e-3  # top speed (m/s), drive, turning rate (rad/s: half a turn takes less than an hour)
FASTEST: Final = 1000.0  # top speed (m/s), turning rate (rad/s)
SMALLEST_ANGLE: Final = 1e-3  # half-angle ahead, turn between legs (rad)
MAX_FRICTION: Final = 10.0  # Coulomb coefficient: contacts hold each other up to 84° from their normal
SHORTEST_STEP: Final = 1e-6  # motion in a period, in radii, so that rounding errors are small
LONGEST_STEP: Final = 0.8  # motion in a period, in radii, so that two robots do not pass through each other
MAX_SWARMS: Final = 1000
MAX_ACTIONS: Final = 100
MAX_ROBOTS: Final = 1_000_000  # size of a swarm, and number of robots divided among swarms
MAX_PUCKS: Final = 10**9  # puck limit and supply
MAX_PLACES: Final = 1000  # number of stations, and of bases
MAX_SEEDS: Final = 1_000_000  # number of seeds of a scenario
MAX_SEED: Final = 2**53  # seed, so that every table and file stores it exactly
MAX_POINTS: Final = 1000  # number of conditions of a scenario with a grid
LONGEST_NAME: Final = 100  # characters of a name, which files are named after
LONGEST_TITLE: Final = 200  # characters of a title
MAX_RUN_LIMIT: Final = 1e7  # time limit of a run (s)
# Text without line breaks, control characters, changes of the writing direction and bytes that are no text.
ONE_LINE: Final = r"^[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]*$"
MAX_JOBS: Final = 1024  # worker processes
MAX_TEXT_FILE: Final = 10_000_000  # bytes of a TOML or Python file
MAX_CODE_FILES: Final = 10_000  # files of a package with user-defined code
MAX_JSON_FILE: Final = 100_000_000  # bytes of a JSON file: learned policies, measured shares, manifest
