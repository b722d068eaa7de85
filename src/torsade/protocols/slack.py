"""Slack: how far a strand that nothing holds goes before it is caught.

An overdamped fiber that touches nothing meets no resistance: pulled, it is at once where it touches
something. The equations of motion cannot say so, since they would divide by zero; this does.
"""

from __future__ import annotations

import numpy as np

from torsade.arrays import Floats
from torsade.assembly import Assembly

__all__ = ["take_up_slack"]

DEPTH = 1e-3
"""How deep a strand that is caught lies in the other, in diameters: enough to count as contact."""


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
    between = (middle[~mine][:, None] - middle[mine][None]).reshape(-1, 3)
    along = between @ axis
    squared = np.sum(between**2, axis=1)
    if squared.min() < diameter**2:
        return True
    across = squared - along**2
    touch = (1 - DEPTH) * diameter
    meets = (across < touch**2) & (along > 0)
    # A sphere of the diameter about the other midpoint is entered this far along the axis.
    gap = along[meets] - np.sqrt(touch**2 - across[meets])
    gap = gap[gap > 0]
    if not gap.size or gap.min() > reach:
        return False
    x[assembly.node_start[fiber] : assembly.node_start[fiber + 1]] += gap.min() * axis
    return True
