"""Ends held in direction, exactly: a grip is an edge before an end, without rest length, that does not move.

Half of the neighbouring edge bends and twists against the grip, so the end itself, not the middle of its
edge, has the grip's direction and angle; what depends on a clamp converges with the square of the edge
length. `torsade.motion.supports` does the same in equilibria.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsade.arrays import Floats
from torsade.assembly import Assembly, State, assemble, initial_state
from torsade.motion.ends import Boundary, clamp, free

__all__ = ["NOTHING", "gripped"]

NOTHING = 1e-30
"""Rest length of a grip, as a share of its neighbour: a number above zero, to be divided by."""


def gripped(
    x: Floats, directions: Sequence[Floats | None], total_twist: float = 0.0
) -> tuple[Assembly, State, Boundary]:
    """A straight-grown fiber at rest with grips, evenly twisted, and the boundary that holds it.

    Parameters
    ----------
    x : (n_nodes, 3) nodes of the fiber [m]; all edges keep their present lengths
    directions : tangents (3,) at its beginning and at its end, along the fiber, or None for a free end
    total_twist : from one end to the other [rad]

    Returns
    -------
    Assembly and state with a node and an edge more for every grip, and the boundary that keeps it still.
    """
    length = np.linalg.norm(np.diff(x, axis=0), axis=1)
    rest, nodes = length, x
    first, last = directions
    if first is not None:
        nodes = np.concatenate([[nodes[0] - length[0] * first], nodes])
        rest = np.concatenate([[NOTHING * length[0]], rest])
    if last is not None:
        nodes = np.concatenate([nodes, [nodes[-1] + length[-1] * last]])
        rest = np.concatenate([rest, [NOTHING * length[-1]]])
    assembly = assemble([nodes], rest_lengths=[rest])
    state = initial_state(assembly, [nodes])
    state.theta[:] = total_twist * assembly.edge_arclength / length.sum()
    boundary = free(assembly)
    for end, direction in enumerate(directions):
        if direction is not None:
            boundary = clamp(boundary, assembly, 0, end, tangent=True)
    return assembly, state, boundary
