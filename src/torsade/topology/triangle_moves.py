"""Triangle moves of polygons in space, which change no knot: kernels.

A polygon keeps its knot type when two edges a b, b c are replaced by the edge a c, or the other way round,
unless another edge pierces the triangle a b c (Reidemeister's Delta moves; two knots are the same when such
moves join them). So a node may be taken out, or moved to another place b', where neither the triangle a b c
nor a b' c is pierced.

Nodes of all curves stand in one array. Node i is followed by node after[i], and -1 ends an open curve; a node
that has been taken out has before = after = -2. Edges are looked for in boxes around runs of `RUN` nodes.
Positions are taken to be in general position: an edge that shares a corner with a triangle does not lie in
its plane.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index, Ints

RUN = 32
"""Nodes in a box."""

OUT = -2
"""In place of the neighbours of a node that has been taken out."""


class Chain(NamedTuple):
    """Polygons while they are changed: x (n, 3), neighbours (n,), boxes (n_boxes, 3) around edges."""

    x: Floats
    before: Ints
    after: Ints
    low: Floats
    high: Floats


def _volume(a: Floats, b: Floats, c: Floats, d: Floats) -> float:
    """Six times the signed volume of the tetrahedron of four points (3,)."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = d[0] - a[0], d[1] - a[1], d[2] - a[2]
    return float(ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx))


def pierces(p: Floats, q: Floats, a: Floats, b: Floats, c: Floats) -> bool:
    """Whether the segment p q passes through the triangle a b c, points (3,) in general position."""
    if (_volume(a, b, c, p) > 0.0) == (_volume(a, b, c, q) > 0.0):
        return False
    side = _volume(p, q, a, b) > 0.0
    return (_volume(p, q, b, c) > 0.0) == side and (_volume(p, q, c, a) > 0.0) == side


def is_free(chain: Chain, b: Index, tip: Floats) -> bool:
    """Whether no edge passes through the triangle of the neighbours of node b and a point tip (3,)."""
    x, after, low, high = chain.x, chain.after, chain.low, chain.high
    a, c = chain.before[b], after[b]
    n = x.shape[0]
    xa, xc = x[a], x[c]
    x0, x1 = min(xa[0], xc[0], tip[0]), max(xa[0], xc[0], tip[0])
    y0, y1 = min(xa[1], xc[1], tip[1]), max(xa[1], xc[1], tip[1])
    z0, z1 = min(xa[2], xc[2], tip[2]), max(xa[2], xc[2], tip[2])
    for k in range(low.shape[0]):
        if low[k, 0] > x1 or high[k, 0] < x0 or low[k, 1] > y1 or high[k, 1] < y0:
            continue
        if low[k, 2] > z1 or high[k, 2] < z0:
            continue
        for i in range(k * RUN, min(n, (k + 1) * RUN)):
            j = after[i]
            if j < 0 or i == a or i == b or i == c or j == a or j == c:  # noqa: SIM109 - as fast as it gets
                continue
            p, q = x[i], x[j]
            if min(p[0], q[0]) > x1 or max(p[0], q[0]) < x0 or min(p[1], q[1]) > y1 or max(p[1], q[1]) < y0:
                continue
            if min(p[2], q[2]) > z1 or max(p[2], q[2]) < z0:
                continue
            if pierces(p, q, xa, tip, xc):
                return False
    return True


def _enclose(chain: Chain, i: Index) -> None:
    """Let the box of edge i reach both its nodes; boxes only grow."""
    x, low, high = chain.x, chain.low, chain.high
    k = i // RUN
    for node in (i, chain.after[i]):
        for d in range(3):
            low[k, d] = min(low[k, d], x[node, d])
            high[k, d] = max(high[k, d], x[node, d])


def enclose_all(chain: Chain) -> None:
    """Set the boxes around all edges."""
    chain.low[:] = np.inf
    chain.high[:] = -np.inf
    for i in range(chain.x.shape[0]):
        if chain.after[i] >= 0:
            _enclose(chain, i)


def take_out(chain: Chain, wanted: Bools, longest: float) -> int:
    """Take out wanted nodes (n,) while any can be and the edge that is left is no longer than longest.

    Ends of open curves stay, and three nodes of a closed one. Returns how many wanted ones remain.
    """
    x, before, after = chain.x, chain.before, chain.after
    n = x.shape[0]
    changed = True
    remain = 0
    while changed:
        changed = False
        remain = 0
        for b in range(n):
            if not wanted[b] or after[b] == OUT:
                continue
            remain += 1
            a, c = before[b], after[b]
            if a < 0 or c < 0 or after[c] == a:
                continue
            l = (x[c, 0] - x[a, 0]) ** 2 + (x[c, 1] - x[a, 1]) ** 2 + (x[c, 2] - x[a, 2]) ** 2
            if l > longest * longest or not is_free(chain, b, x[b]):
                continue
            after[a] = c
            before[c] = a
            before[b] = OUT
            after[b] = OUT
            _enclose(chain, a)
            changed = True
            remain -= 1
    return remain


def move_all(chain: Chain, target: Floats, tip: Floats, halvings: int) -> int:
    """Move nodes to target (n, 3), each in one step where that is free, or else in halves of what is left.

    tip (3,) is scratch. Returns how many nodes have not arrived after as many rounds of halving without
    another arriving.
    """
    x, before, after = chain.x, chain.before, chain.after
    n = x.shape[0]
    stuck = 0
    while True:
        arrived = 0
        waiting = 0
        for b in range(n):
            if after[b] == OUT:
                continue
            if x[b, 0] == target[b, 0] and x[b, 1] == target[b, 1] and x[b, 2] == target[b, 2]:
                continue
            waiting += 1
            if before[b] < 0 or after[b] < 0 or after[after[b]] == before[b]:
                continue
            if not is_free(chain, b, x[b]):
                continue
            if is_free(chain, b, target[b]):
                x[b] = target[b]
                arrived += 1
            elif stuck > 0:
                for d in range(3):
                    tip[d] = (x[b, d] + target[b, d]) / 2
                if not is_free(chain, b, tip):
                    continue
                x[b] = tip
            else:
                continue
            _enclose(chain, before[b])
            _enclose(chain, b)
        if waiting == arrived:
            return 0
        stuck = 0 if arrived > 0 else stuck + 1
        if stuck > halvings:
            return waiting - arrived


compile_kernels(__name__, inline=("_volume",))
