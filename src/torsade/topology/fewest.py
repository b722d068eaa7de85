"""How few crossings a curve can be seen with: the least over many directions of view, open or closed.

It bounds the crossing number of a closed curve from above; an open curve that can be seen without any is not
knotted however its ends are led away in the plane of that view.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from torsade._compile import compile_kernels
from torsade.arrays import Floats
from torsade.topology.polygons import polygon
from torsade.topology.projection import across, spiral

DIRECTIONS = 60
"""Of half the sphere: from behind the same crossings are seen."""


def least_crossings(x: Floats, views: Floats, low: Floats, high: Floats, flat: Floats) -> int:
    """Fewest crossings of the polyline x (n, 3) seen along any of views (n_views, 2, 3): right and up.

    Rows of low, high and flat (n, 2) are scratch. Closed curves repeat their first node at the end; their
    first and last edge do not count as crossing.
    """
    n = x.shape[0] - 1
    closed = x[0, 0] == x[n, 0] and x[0, 1] == x[n, 1] and x[0, 2] == x[n, 2]
    least = n * n
    for k in range(views.shape[0]):
        for i in range(n + 1):
            for c in range(2):
                flat[i, c] = views[k, c, 0] * x[i, 0] + views[k, c, 1] * x[i, 1] + views[k, c, 2] * x[i, 2]
        for i in range(n):
            for c in range(2):
                low[i, c] = min(flat[i, c], flat[i + 1, c])
                high[i, c] = max(flat[i, c], flat[i + 1, c])
        count = 0
        for i in range(n - 2):
            if count >= least:
                break
            last = n - 1 if closed and i == 0 else n
            ax, ay = flat[i, 0], flat[i, 1]
            bx, by = flat[i + 1, 0] - ax, flat[i + 1, 1] - ay
            for j in range(i + 2, last):
                if low[j, 0] > high[i, 0] or high[j, 0] < low[i, 0]:
                    continue
                if low[j, 1] > high[i, 1] or high[j, 1] < low[i, 1]:
                    continue
                px, py = flat[j, 0] - ax, flat[j, 1] - ay
                qx, qy = flat[j + 1, 0] - ax, flat[j + 1, 1] - ay
                if (bx * py - by * px > 0.0) == (bx * qy - by * qx > 0.0):
                    continue
                dx, dy = qx - px, qy - py
                count += (dy * px - dx * py > 0.0) != (dx * (by - py) - dy * (bx - px) > 0.0)
        least = min(least, count)
    return int(least)


def fewest_crossings(x: ArrayLike, closed: bool, directions: int = DIRECTIONS) -> int:
    """The fewest crossings seen along any of so many directions, evenly spread.

    Args:
        x: nodes, shape (n, 3).
        closed: whether the last node joins the first.
        directions: how many, of half the sphere.

    Raises:
        TorsadeError: nodes that `polygons` refuses.
    """
    corners = polygon(x, closed)
    if closed:
        corners = np.concatenate([corners, corners[:1]])
    low, high, flat = (np.empty((len(corners), 2)) for _ in range(3))
    found: int = least_crossings(np.ascontiguousarray(corners), _views(directions), low, high, flat)
    return found


@lru_cache(maxsize=8)
def _views(directions: int) -> Floats:
    """Right and up of views along directions of half the sphere, shape (directions, 2, 3)."""
    turned = spiral(2 * directions)
    turned = turned[turned[:, 2] > 0] @ _TURN  # so that none lies along an axis of a symmetric curve
    return np.array([across(d) for d in turned])


_TURN = np.array(
    [[math.cos(0.7), math.sin(0.7), 0.0], [-math.sin(0.7), math.cos(0.7), 0.0], [0.0, 0.0, 1.0]]
) @ np.array([[1.0, 0.0, 0.0], [0.0, math.cos(0.4), math.sin(0.4)], [0.0, -math.sin(0.4), math.cos(0.4)]])


compile_kernels(__name__, plain=("fewest_crossings", "_views"))
