"""How alike two closed curves are: the one laid on the other, wherever nodes begin and however they run."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade.arrays import Floats
from torsade.errors import TorsadeError

__all__ = ["Likeness", "likeness"]


class Likeness(NamedTuple):
    """Two closed curves of n nodes laid on each other.

    Attributes
    ----------
    distance : root mean square distance of their nodes then, in the unit of the curves
    first, step : node i of one lies on node (first + step i) mod n of the other, step 1 or -1
    """

    distance: float
    first: int
    step: int

    def node(self, i: int, n: int) -> int:
        """The node of the other curve that node i of one lies on."""
        return (self.first + self.step * i) % n


def likeness(one: Floats, other: Floats) -> Likeness:
    """Lay a closed curve on another by the rotation, shift of nodes and direction that bring them nearest.

    Both have nodes (n, 3), evenly spaced. The rotation is Kabsch's (1976), reflections left out.

    Raises
    ------
    TorsadeError
        When they have different numbers of nodes.
    """
    if one.shape != other.shape:
        raise TorsadeError(f"curves of {len(one)} and {len(other)} nodes are compared; give as many nodes")
    x, y = one - one.mean(axis=0), other - other.mean(axis=0)
    n, size = len(x), float((x**2).sum() + (y**2).sum())
    places = [(first, step) for step in (1, -1) for first in range(n)]
    crossed = np.array([x.T @ y[(first + step * np.arange(n)) % n] for first, step in places])
    stretched = np.linalg.svd(crossed, compute_uv=False)
    stretched[:, 2] *= np.sign(np.linalg.det(crossed))
    overlap = stretched.sum(axis=1)
    best = int(np.argmax(overlap))
    return Likeness(float(np.sqrt(max(size - 2 * overlap[best], 0.0) / n)), *places[best])
