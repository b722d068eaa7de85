"""No fiber goes into skin, and no side of the skin into the other: what a step may do."""

from __future__ import annotations

import math

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index
from torsade.assembly import Assembly
from torsade.rod.skin import Skin


def _segment_distance(x: Floats, i: Index, j: Index, c: Index) -> float:
    """Distance [m] of the segment from node i to node j from the line along z through node c."""
    px = x[i, 0] - x[c, 0]
    py = x[i, 1] - x[c, 1]
    ex = x[j, 0] - x[i, 0]
    ey = x[j, 1] - x[i, 1]
    squared = ex * ex + ey * ey
    t = -(px * ex + py * ey) / squared if squared > 0.0 else 0.0
    t = min(max(t, 0.0), 1.0)
    return math.sqrt((px + t * ex) ** 2 + (py + t * ey) ** 2)


def _approach(x0: Floats, x1: Floats, i: Index, c: Index) -> float:
    """How far [m] node i moves across z from x0 to x1, as seen from node c."""
    dx = x1[i, 0] - x0[i, 0] - x1[c, 0] + x0[c, 0]
    dy = x1[i, 1] - x0[i, 1] - x1[c, 1] + x0[c, 1]
    return math.sqrt(dx * dx + dy * dy)


def pierced(a: Assembly, skin: Skin | tuple[()], x0: Floats, x1: Floats) -> tuple[int, int]:
    """An edge and the cylinder into which its axis would go as nodes move from x0 to x1, or (-1, -1).

    Also when it may pass through the cylinder's axis on the way, and for cylinders, which count on from
    n_edges, when one would go into the other by half. A distance shrinks no faster than nodes move, so on the
    way it is at least half of what the sum of both ends exceeds the motion by.
    """
    if len(skin) == 0:
        return -1, -1
    node, edges = skin.node, a.edges
    n_edges = edges.shape[0]
    for c in range(node.shape[0]):
        center = node[c]
        for e in range(n_edges):
            i = edges[e, 0]
            j = edges[e, 1]
            after = _segment_distance(x1, i, j, center)
            before = _segment_distance(x0, i, j, center)
            move = max(_approach(x0, x1, i, center), _approach(x0, x1, j, center))
            if after < skin.radius or before + after <= move:
                return e, n_edges + c
        for d in range(c):
            after = _segment_distance(x1, node[d], node[d], center)
            before = _segment_distance(x0, node[d], node[d], center)
            if after < skin.radius or before + after <= _approach(x0, x1, node[d], center):
                return n_edges + c, n_edges + d
    return -1, -1


compile_kernels(__name__, inline=("_segment_distance", "_approach"))
