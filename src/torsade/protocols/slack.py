"""Slack: how far a strand that nothing holds goes before it is caught.

An overdamped fiber that touches nothing meets no resistance: pulled, it is at once where it touches
something. The equations of motion cannot say so, since they would divide by zero; this does.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from torsade.arrays import Floats
from torsade.assembly import Assembly

__all__ = ["take_up_slack"]

DEPTH = 1e-3
"""How deep a strand that is caught lies in the other, in diameters: enough to count as contact."""

STRIDE = 4.0
"""How far ahead pairs are looked for at once, in diameters: far enough to be quick, few enough to hold."""


def take_up_slack(
    assembly: Assembly, x: Floats, fiber: int, axis: Floats, diameter: float, reach: float = np.inf
) -> bool:
    """Move a fiber along an axis until it touches another one; whether it does within reach [m].

    Contact is between edge midpoints nearer than the diameter. A fiber that touches already stays, and
    so does one that is never caught.

    Parameters
    ----------
    x : (n_nodes, 3) node positions [m], changed in place
    axis : (3,) unit vector
    diameter : 2h [m]
    """
    middle = 0.5 * (x[assembly.edges[:, 0]] + x[assembly.edges[:, 1]])
    mine = assembly.edge_fiber == fiber
    gap = _gap(middle[mine], middle[~mine], axis, diameter, reach)
    if gap is None:
        return False
    if gap > 0:
        x[assembly.node_start[fiber] : assembly.node_start[fiber + 1]] += gap * axis
    return True


def _gap(mine: Floats, others: Floats, axis: Floats, diameter: float, reach: float) -> float | None:
    """How far points (n, 3) go along an axis until one is `diameter` from another, less `DEPTH`.

    0 when they touch already, None when they never do within reach.
    """
    tree = cKDTree(others)
    if np.min(tree.query(mine)[0]) < diameter:
        return 0.0
    touch, stride = (1 - DEPTH) * diameter, STRIDE * diameter
    farthest = min(reach, float((others @ axis).max() - (mine @ axis).min()) + diameter)
    gone = 0.0
    while gone <= farthest:
        moved = mine + gone * axis
        # Nothing nearer than this can be met on the way there.
        free = float(np.min(tree.query(moved)[0])) - touch
        if free > stride:
            gone += free
            continue
        pairs = cKDTree(moved).sparse_distance_matrix(tree, touch + stride, output_type="ndarray")
        between = others[pairs["j"]] - mine[pairs["i"]]
        along = between @ axis
        across = np.sum(between**2, axis=1) - along**2
        meets = (across < touch**2) & (along > 0)
        # A sphere of the diameter about the other midpoint is entered this far along the axis.
        found = along[meets] - np.sqrt(touch**2 - across[meets])
        if found.size and found.min() <= gone + stride:
            return float(found.min()) if found.min() <= reach else None
        gone += stride
    return None
