"""Types of arrays."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Records = NDArray[np.void]
Rows = NDArray[np.uint32]
"""Rows of robots. Numba reads unsigned indices faster: it does not test whether they are negative."""
