"""Names for the kinds of arrays that kernels take."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

Index = int | np.int64 | np.uintp
"""A number of a node, edge, hinge or fiber, counted or read from an array."""

ONE = np.uintp(1)
"""To count on from an index that is not negative: compiled code need not ask, and works on many at once."""


def columns(n: int) -> Floats:
    """Room for n vectors (n, 3), one component after the other, which makes loops over all of them faster."""
    return np.empty((n, 3), order="F")


Slots = NDArray[np.uint32]
"""Places in an array, counted from its start: compiled code need not ask whether one is negative."""
