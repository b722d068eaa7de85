"""Verlet lists: pairs of edges that may come into contact before the list is made again."""

from __future__ import annotations

import math

import numpy as np

from torsade._compile import compile_kernels


def excluded(a, e, f, exclusion_edges, exclusion_length):
    """Whether edges e and f are too close along one fiber for their distance to be a contact.

    They are when at most exclusion_edges apart in number, or nearer than exclusion_length [m] in rest
    arclength; around the seam of a closed fiber the shorter way counts.
    """
    fiber = a.edge_fiber[e]
    if fiber != a.edge_fiber[f]:
        return False
    apart = abs(e - f)
    distance = abs(a.edge_arclength[e] - a.edge_arclength[f])
    if a.closed[fiber]:
        apart = min(apart, a.edge_start[fiber + 1] - a.edge_start[fiber] - apart)
        distance = min(distance, a.fiber_length[fiber] - distance)
    return apart <= exclusion_edges or distance < exclusion_length


def edge_midpoints(x, edges, mid):
    """Midpoints (n_edges, 3) [m] of all edges."""
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        for c in range(3):
            mid[e, c] = 0.5 * (x[i, c] + x[j, c])


def _bucket(i, j, k, mask):
    return ((i * 73856093) ^ (j * 19349663) ^ (k * 83492791)) & mask


def neighbour_pairs(a, mid, cutoff, exclusion_edges, exclusion_length):
    """All pairs e < f of edges with midpoints nearer than cutoff [m], excluded ones left out.

    Linear in the number of edges: points are hashed by their cell of side cutoff. Returns an int64
    array (n_pairs, 2) ordered by e, the same for the same input.
    """
    n = mid.shape[0]
    size = 16
    while size < 2 * n:
        size *= 2
    mask = size - 1
    head = np.full(size, -1, np.int64)
    following = np.empty(n, np.int64)
    cell = np.empty((n, 3), np.int64)
    for e in range(n - 1, -1, -1):
        for c in range(3):
            cell[e, c] = math.floor(mid[e, c] / cutoff)
        b = _bucket(cell[e, 0], cell[e, 1], cell[e, 2], mask)
        following[e] = head[b]
        head[b] = e
    pairs = np.empty((max(64, 4 * n), 2), np.int64)
    count = 0
    for e in range(n):
        for shift in range(27):
            i = cell[e, 0] + shift // 9 - 1
            j = cell[e, 1] + (shift // 3) % 3 - 1
            k = cell[e, 2] + shift % 3 - 1
            f = head[_bucket(i, j, k, mask)]
            while f >= 0:
                if f > e and cell[f, 0] == i and cell[f, 1] == j and cell[f, 2] == k:
                    dx = mid[e, 0] - mid[f, 0]
                    dy = mid[e, 1] - mid[f, 1]
                    dz = mid[e, 2] - mid[f, 2]
                    near = dx * dx + dy * dy + dz * dz < cutoff * cutoff
                    if near and not excluded(a, e, f, exclusion_edges, exclusion_length):
                        if count == pairs.shape[0]:
                            grown = np.empty((2 * count, 2), np.int64)
                            grown[:count] = pairs
                            pairs = grown
                        pairs[count, 0] = e
                        pairs[count, 1] = f
                        count += 1
                f = following[f]
    return pairs[:count].copy()


compile_kernels(__name__)
