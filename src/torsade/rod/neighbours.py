"""Verlet lists: pairs of edges that may come into contact before the list is made again.

Edges of one fiber are excluded when they are at most exclusion_edges apart in number, or nearer than
exclusion_length [m] in rest arclength; around the seam of a closed fiber, and across the cut of one just
opened, the shorter way counts.
"""

from __future__ import annotations

import math

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, Ints
from torsade.assembly import Assembly

NONE = np.int64(0)
NEXT = np.int64(1)
"""Not literals: a kernel is compiled again for every literal that it is called with."""


def edge_midpoints(x: Floats, edges: Ints, mid: Floats) -> None:
    """Midpoints (n_edges, 3) [m] of all edges."""
    for e in range(edges.shape[0]):
        i = np.uintp(edges[e, 0])
        j = np.uintp(edges[e, 1])
        for c in range(3):
            mid[e, c] = 0.5 * (x[i, c] + x[j, c])


def _bucket(i: Index, j: Index, k: Index, mask: int) -> Index:
    return ((i * 73856093) ^ (j * 19349663) ^ (k * 83492791)) & mask


def _hash_cells(mid: Floats, side: float, head: Ints, following: Ints, cell: Ints) -> None:
    """Linked lists of the points in every bucket; head (size,), following (n,), cell (n, 3)."""
    for k in range(head.shape[0]):
        head[k] = -1
    mask = head.shape[0] - 1
    for e in range(mid.shape[0] - 1, -1, -1):
        for c in range(3):
            cell[e, c] = math.floor(mid[e, c] / side)
        b = _bucket(cell[e, 0], cell[e, 1], cell[e, 2], mask)
        following[e] = head[b]
        head[b] = e


def _first(count: Index, pairs: Ints, room: Index) -> Ints:
    """The first count rows of pairs (n, 2), in an array with room for more if room says so."""
    out = np.empty((max(count, room), 2), np.int64)
    for k in range(count):
        out[k, 0] = pairs[k, 0]
        out[k, 1] = pairs[k, 1]
    return out


def near_points(mid: Floats, cutoff: float) -> Ints:
    """All pairs e < f of points mid (n, 3) [m] nearer than cutoff [m].

    Linear in the number of points: they are hashed by their cell of side cutoff. Returns an int64 array
    (n_pairs, 2) ordered by e, the same for the same input.
    """
    n = mid.shape[0]
    size = 16
    while size < 2 * n:
        size *= 2
    mask = size - 1
    head = np.empty(size, np.int64)
    following = np.empty(n, np.int64)
    cell = np.empty((n, 3), np.int64)
    _hash_cells(mid, cutoff, head, following, cell)
    reach = cutoff * cutoff
    pairs = np.empty((max(64, 8 * n), 2), np.int64)
    total = NONE
    for e in range(n):
        x, y, z = mid[e, 0], mid[e, 1], mid[e, 2]
        ci, cj, ck = cell[e, 0], cell[e, 1], cell[e, 2]
        if total + n > pairs.shape[0]:
            pairs = _first(total, pairs, 2 * (total + n))
        for i in range(ci - 1, ci + 2):
            for j in range(cj - 1, cj + 2):
                for k in range(ck - 1, ck + 2):
                    f = head[_bucket(i, j, k, mask)]
                    while f >= 0:
                        if f > e and cell[f, 0] == i and cell[f, 1] == j and cell[f, 2] == k:
                            dx = mid[f, 0] - x
                            dy = mid[f, 1] - y
                            dz = mid[f, 2] - z
                            if dx * dx + dy * dy + dz * dz < reach:
                                pairs[total, 0] = e
                                pairs[total, 1] = f
                                total += 1
                        f = following[f]
    return _first(total, pairs, total)


def neighbour_pairs(
    a: Assembly, mid: Floats, cutoff: float, exclusion_edges: Index, exclusion_length: float
) -> Ints:
    """All pairs e < f of edges with midpoints nearer than cutoff [m], excluded ones left out."""
    return without_excluded(a, near_points(mid, cutoff), mid, cutoff, exclusion_edges, exclusion_length)


def without_excluded(
    a: Assembly, pairs: Ints, mid: Floats, cutoff: float, exclusion_edges: Index, exclusion_length: float
) -> Ints:
    """The pairs (n_pairs, 2) with midpoints nearer than cutoff [m] that are not excluded."""
    edge_fiber, edge_start, ends_meet = a.edge_fiber, a.edge_start, a.ends_meet
    arclength, fiber_length = a.edge_arclength, a.fiber_length
    kept = np.empty((pairs.shape[0], 2), np.int64)
    count = NONE
    for k in range(pairs.shape[0]):
        e = pairs[k, 0]
        f = pairs[k, 1]
        dx = mid[e, 0] - mid[f, 0]
        dy = mid[e, 1] - mid[f, 1]
        dz = mid[e, 2] - mid[f, 2]
        keep = dx * dx + dy * dy + dz * dz < cutoff * cutoff
        fiber = edge_fiber[e]
        if keep and fiber == edge_fiber[f]:
            apart = abs(e - f)
            distance = abs(arclength[e] - arclength[f])
            if ends_meet[fiber]:
                apart = min(apart, edge_start[fiber + 1] - edge_start[fiber] - apart)
                distance = min(distance, fiber_length[fiber] - distance)
            keep = apart > exclusion_edges and distance >= exclusion_length
        if keep:
            kept[count, 0] = e
            kept[count, 1] = f
            count += 1
    return _first(count, kept, count)


def near_rows(pairs: Ints, mid: Floats, reach: float, rows: Ints) -> int:
    """Rows of pairs (n_pairs, 2) of edges with midpoints nearer than reach [m], into rows; returns how many.

    mid (n_edges, 3) [m], rows (n_pairs,).
    """
    count = 0
    for k in range(pairs.shape[0]):
        e = np.uintp(pairs[k, 0])
        f = np.uintp(pairs[k, 1])
        dx = mid[f, 0] - mid[e, 0]
        dy = mid[f, 1] - mid[e, 1]
        dz = mid[f, 2] - mid[e, 2]
        rows[count] = k
        count += dx * dx + dy * dy + dz * dz < reach * reach
    return count


compile_kernels(
    __name__, inline=("_bucket",), owning=("_first", "near_points", "neighbour_pairs", "without_excluded")
)
