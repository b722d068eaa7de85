"""The Gauss integral over pairs of edges, exactly: kernels.

Two edges, from p0 to p1 and from q0 to q1, are seen to cross from all directions in the spherical
quadrilateral of corners a = q0 - p0, b = q1 - p0, c = q1 - p1, d = q0 - p1. Its signed area Omega is their
Gauss integral (Banchoff 1976; Klenin and Langowski 2000, method 1a). The diagonal from a to c cuts it into
two triangles of area (van Oosterom and Strackee 1983)

    Omega_1 = 2 arg(D1 + iV),    D1 = |a||b||c| + (a.b)|c| + (b.c)|a| + (c.a)|b|,    V = a . (b x c),

    Omega_2 = 2 arg(D2 + iV) likewise, of a, c and d.

Both have the same V, which is a . (e x f) with edges e = p1 - p0 and f = q1 - q0. The differences q - p fill
a flat parallelogram, seen from the origin under less than half the sphere. So |Omega| < 2 pi, and one
arctangent serves both:

    Omega = 2 arg[(D1 + iV)(D2 + iV)].

Only distances between nodes enter D1, and likewise D2,

    2 D1 = (|a| + |b|)(|b| + |c|)(|c| + |a|) - |c||f|^2 - |a||e|^2 - |b||e - f|^2,

and each distance is shared by four pairs of edges. There is no arcsine that loses digits, and no division by
zero unless edges touch. Positive V is a left-handed crossing.

Nodes are rows x, y, z of one array. Edge k joins nodes k and k + 1.
"""

from __future__ import annotations

import math

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, Ints

ROWS = 32
"""Rows that share columns of distances. Sums are the same to the bit however multiples of it are split."""

SUSPECT = 1e-5
"""Edges touch only if Re and |Im| of (2 D1 + 2iV)(2 D2 + 2iV) are below this times (|e|^2 + |f|^2)^3.

Touching, the product is real and not positive. Its change with any distance is below 400 (|e| + |f|)^5,
so that none nearer than 1e-9 (|e| + |f|) is missed.
"""


def _arctangent(y: float, x: float) -> float:
    """Angle of (x, y) [rad], to 3e-16 relative, without branches, so that many are found at once.

    arctan(t)/t on [0, 1] is a polynomial in t^2 through 19 Chebyshev nodes, known to 1.2e-16.
    """
    across, along = abs(y), abs(x)
    steep = across > along
    t = along / across if steep else across / along
    u = t * t
    p = -2.7633793313601145e-05 * u + 0.00029221739308086863
    p = p * u - 0.0014627303082646208
    p = p * u + 0.004642163938026353
    p = p * u - 0.01059534604369583
    p = p * u + 0.01880522404364234
    p = p * u - 0.027590832895856107
    p = p * u + 0.03536066107263382
    p = p * u - 0.04165211802350559
    p = p * u + 0.04705209153071265
    p = p * u - 0.05249518584337663
    p = p * u + 0.05879865489802981
    p = p * u - 0.06666332509211019
    p = p * u + 0.07692275905014771
    p = p * u - 0.0909090706749639
    p = p * u + 0.11111111032045885
    p = p * u - 0.14285714284072867
    p = p * u + 0.1999999999998641
    p = p * u - 0.33333333333333315
    angle = p * (u * t) + t
    angle = 0.5 * math.pi - angle if steep else angle
    angle = math.pi - angle if x < 0 else angle
    return math.copysign(angle, y)


def _distances(nodes: Floats, k: Index, first: Index, last: Index, distance: Floats) -> None:
    """Distances (n_nodes,) from node k to the nodes from first to before last."""
    x, y, z = nodes[0, first:last], nodes[1, first:last], nodes[2, first:last]
    px, py, pz = nodes[0, k], nodes[1, k], nodes[2, k]
    out = distance[first:last]
    for j in range(last - first):
        dx = x[j] - px
        dy = y[j] - py
        dz = z[j] - pz
        out[j] = math.sqrt(dx * dx + dy * dy + dz * dz)


def _row(
    nodes: Floats,
    edges: Floats,
    i: Index,
    first: Index,
    last: Index,
    near: Floats,
    far: Floats,
    angle: Floats,
) -> int:
    """Omega/2 [rad] of edge i with the edges from first to before last, into angle (last - first,).

    near and far (n_nodes,) are distances from the first and from the last node of edge i. Returns how many
    of the edges may touch it.
    """
    x, y, z = nodes[0, first:last], nodes[1, first:last], nodes[2, first:last]
    fx, fy, fz, ff = edges[0, first:last], edges[1, first:last], edges[2, first:last], edges[3, first:last]
    px, py, pz = nodes[0, i], nodes[1, i], nodes[2, i]
    ex, ey, ez, ee = edges[0, i], edges[1, i], edges[2, i], edges[3, i]
    a, b = near[first:last], near[first + 1 : last + 1]
    d, c = far[first:last], far[first + 1 : last + 1]
    suspects = 0
    for j in range(last - first):
        v = (x[j] - px) * (ey * fz[j] - ez * fy[j])
        v += (y[j] - py) * (ez * fx[j] - ex * fz[j])
        v += (z[j] - pz) * (ex * fy[j] - ey * fx[j])
        v *= 2.0
        sides = ee + ff[j]
        diagonal = sides - 2.0 * (ex * fx[j] + ey * fy[j] + ez * fz[j])
        ac = a[j] + c[j]
        d1 = (a[j] + b[j]) * (b[j] + c[j]) * ac - (c[j] * ff[j] + a[j] * ee + b[j] * diagonal)
        d2 = (a[j] + d[j]) * (d[j] + c[j]) * ac - (c[j] * ee + a[j] * ff[j] + d[j] * diagonal)
        re = d1 * d2 - v * v
        im = v * (d1 + d2)
        small = SUSPECT * sides * sides * sides
        suspects += (re <= small) & (abs(im) <= small)
        angle[j] = _arctangent(im, re)
    return suspects


def _sums(values: Floats, count: Index) -> tuple[float, float]:
    """Sum of the first count values and of their sizes, in eight lanes: always in the same order."""
    s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0
    t0 = t1 = t2 = t3 = t4 = t5 = t6 = t7 = 0.0
    whole = count // 8 * 8
    for k in range(0, whole, 8):
        a, b, c, d = values[k], values[k + 1], values[k + 2], values[k + 3]
        e, f, g, h = values[k + 4], values[k + 5], values[k + 6], values[k + 7]
        s0, s1, s2, s3 = s0 + a, s1 + b, s2 + c, s3 + d
        s4, s5, s6, s7 = s4 + e, s5 + f, s6 + g, s7 + h
        t0, t1, t2, t3 = t0 + abs(a), t1 + abs(b), t2 + abs(c), t3 + abs(d)
        t4, t5, t6, t7 = t4 + abs(e), t5 + abs(f), t6 + abs(g), t7 + abs(h)
    for k in range(whole, count):
        s0 += values[k]
        t0 += abs(values[k])
    signed = ((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7))
    return signed, ((t0 + t1) + (t2 + t3)) + ((t4 + t5) + (t6 + t7))


def row_sums(
    nodes: Floats,
    edges: Floats,
    offset: Index,
    begin: Ints,
    end: Ints,
    first: Index,
    last: Index,
    sums: Floats,
    suspects: Ints,
) -> None:
    """Sums of Omega/2 [rad] of rows of pairs, for the rows from first, a multiple of ROWS, to before last.

    Row r holds the pairs of edge offset + r with the edges from begin[r] to before end[r].

    Args:
        nodes: shape (3, n_nodes), in any unit, of size around one.
        edges: edge vectors and squared lengths, shape (4, n_nodes - 1).
        offset: edge of row 0.
        begin: shape (n_rows,).
        end: shape (n_rows,).
        first: row.
        last: row.
        sums: filled with the sum of Omega/2 and of |Omega|/2, shape (n_rows, 2).
        suspects: filled with the number of pairs that may touch, shape (n_rows,).
    """
    count = nodes.shape[1]
    angle, near, far = np.empty(count), np.empty(count), np.empty(count)
    for start in range(first, last, ROWS):
        stop = min(last, start + ROWS)
        low, high = np.int64(count), np.int64(0)
        for r in range(start, stop):
            if begin[r] < end[r]:
                low, high = min(low, begin[r]), max(high, end[r] + 1)
        low = min(low, high)
        _distances(nodes, offset + start, low, high, near)
        for r in range(start, stop):
            _distances(nodes, offset + r + 1, low, high, far)
            suspects[r] = _row(nodes, edges, offset + r, begin[r], end[r], near, far, angle)
            sums[r, 0], sums[r, 1] = _sums(angle, end[r] - begin[r])
            near, far = far, near


compile_kernels(__name__, inline=("_arctangent",))
