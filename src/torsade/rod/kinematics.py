"""Geometry of a discrete rod: tangents, curvature binormals, parallel transport and twist.

Twist is carried by a material angle theta on each edge, measured from a reference director that is
parallel transported in time (Bergou et al. 2010). The reference twist of a hinge is the angle, about
the second tangent, from the space-transported first director to the second one.
"""

from __future__ import annotations

import math

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import ONE, Floats, Index, Ints
from torsade.assembly import Assembly


def edge_geometry(a: Assembly, x: Floats, length: Floats, tangent: Floats) -> None:
    """Length [m] (n_edges,) and unit tangent (n_edges, 3) of every edge of nodes x (n_nodes, 3)."""
    node_start, edge_start = a.node_start, a.edge_start
    for f in range(edge_start.shape[0] - 1):
        node, edge = node_start[f], edge_start[f]
        n = node_start[f + 1] - node
        for k in range(n - 1):
            i = np.uintp(node + k)
            _measure_edge(x, i, i + ONE, np.uintp(edge + k), length, tangent)
        if edge_start[f + 1] - edge == n:
            i = np.uintp(node + n - 1)
            _measure_edge(x, i, np.uintp(node), np.uintp(edge + n - 1), length, tangent)


def _measure_edge(x: Floats, i: Index, j: Index, e: Index, length: Floats, tangent: Floats) -> None:
    """Length and tangent of edge e from node i to node j."""
    dx = x[j, 0] - x[i, 0]
    dy = x[j, 1] - x[i, 1]
    dz = x[j, 2] - x[i, 2]
    r = math.sqrt(dx * dx + dy * dy + dz * dz)
    length[e] = r
    s = 1.0 / r
    tangent[e, 0] = dx * s
    tangent[e, 1] = dy * s
    tangent[e, 2] = dz * s


def _half_solid_angle(p: Floats, i: Index, q: Floats, j: Index, r: Floats, k: Index) -> tuple[float, float]:
    """Numerator and denominator of tan(Omega/2) of the spherical triangle of unit vectors p[i], q[j], r[k].

    Van Oosterom and Strackee (1983): tan(Omega/2) = a.(b x c) / (1 + a.b + b.c + c.a).
    """
    ax, ay, az = p[i, 0], p[i, 1], p[i, 2]
    bx, by, bz = q[j, 0], q[j, 1], q[j, 2]
    cx, cy, cz = r[k, 0], r[k, 1], r[k, 2]
    numerator = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    ab = ax * bx + ay * by + az * bz
    bc = bx * cx + by * cy + bz * cz
    ca = cx * ax + cy * ay + cz * az
    return numerator, 1.0 + ab + bc + ca


def small_atan(q: float) -> float:
    """atan q by a series that is exact to round-off up to q = 0.02."""
    s = q * q
    return q * (1.0 - s * (1.0 / 3.0 - s * (0.2 - s * (1.0 / 7.0 - s * (1.0 / 9.0 - s * (1.0 / 11.0))))))


def _swept(t0: Floats, t: Floats, a: Index, b: Index) -> tuple[float, float]:
    """Numerator and denominator of the tangent of half the area swept between the edges a and b."""
    y1, x1 = _half_solid_angle(t0, a, t0, b, t, b)
    y2, x2 = _half_solid_angle(t0, a, t, b, t, a)
    return x1 * y2 + y1 * x2, x1 * x2 - y1 * y2


def reference_twist_change(a: Assembly, tangent_0: Floats, tangent: Floats, change: Floats) -> None:
    """Exact change of every hinge's reference twist as tangents move from tangent_0 to tangent.

    With both directors parallel transported in time, the change is the area on the unit sphere enclosed
    by the path t_a0, t_b0, t_b, t_a (holonomy). Arrays (n_edges, 3), change (n_hinges,) [rad].
    """
    edge_start, hinge_start, hinges = a.edge_start, a.hinge_start, a.hinges
    for f in range(edge_start.shape[0] - 1):
        edge = edge_start[f]
        n = edge_start[f + 1] - edge
        hinge = hinge_start[f + 1] - (n - 1)
        for k in range(n - 1):
            p = np.uintp(edge + k)
            y, x = _swept(tangent_0, tangent, p, p + ONE)
            small = 2.0 * small_atan(y / x)
            change[np.uintp(hinge + k)] = small if abs(y) < 0.02 * x else math.nan
        if n > 0 and hinge > hinge_start[f]:
            change[hinge - 1] = math.nan
    for k in range(change.shape[0]):
        if change[k] != change[k]:
            y, x = _swept(tangent_0, tangent, np.uintp(hinges[k, 0]), np.uintp(hinges[k, 1]))
            change[k] = 2.0 * math.atan2(y, x)


def transport(u: Floats, a: Floats, b: Floats, out: Floats) -> None:
    """Parallel transport of the vector u from the unit tangent a to the unit tangent b, into out.

    Rotation about a x b; renormalised against b so that round-off never accumulates.
    """
    cx = a[1] * b[2] - a[2] * b[1]
    cy = a[2] * b[0] - a[0] * b[2]
    cz = a[0] * b[1] - a[1] * b[0]
    cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    q = (cx * u[0] + cy * u[1] + cz * u[2]) / (1.0 + cosine)
    vx = cosine * u[0] + cy * u[2] - cz * u[1] + q * cx
    vy = cosine * u[1] + cz * u[0] - cx * u[2] + q * cy
    vz = cosine * u[2] + cx * u[1] - cy * u[0] + q * cz
    p = vx * b[0] + vy * b[1] + vz * b[2]
    vx -= p * b[0]
    vy -= p * b[1]
    vz -= p * b[2]
    s = 1.0 / math.sqrt(vx * vx + vy * vy + vz * vz)
    out[0] = vx * s
    out[1] = vy * s
    out[2] = vz * s


def carry_directors(edge_start: Ints, director: Floats, tangent_0: Floats, tangent: Floats) -> None:
    """Carry the first reference director of every fiber from tangent_0 to tangent (n_edges, 3), in place.

    The others follow from it and the reference twists, see `spread_directors`.
    """
    for f in range(edge_start.shape[0] - 1):
        e = edge_start[f]
        if e < edge_start[f + 1]:
            transport(director[e], tangent_0[e], tangent[e], director[e])


def spread_directors(hinges: Ints, tangent: Floats, reference_twist: Floats, director: Floats) -> None:
    """Make all reference directors (n_edges, 3) from the first of every fiber, hinge after hinge.

    Across a hinge the director is transported from one tangent (n_edges, 3) to the next and turned about
    that by the reference twist (n_hinges,) [rad]. A closed fiber's seam closes by itself.
    """
    moved = np.empty(3)
    for k in range(hinges.shape[0]):
        a = hinges[k, 0]
        b = hinges[k, 1]
        if b == a + 1:
            transport(director[a], tangent[a], tangent[b], moved)
            c = math.cos(reference_twist[k])
            s = math.sin(reference_twist[k])
            t = tangent[b]
            director[b, 0] = c * moved[0] + s * (t[1] * moved[2] - t[2] * moved[1])
            director[b, 1] = c * moved[1] + s * (t[2] * moved[0] - t[0] * moved[2])
            director[b, 2] = c * moved[2] + s * (t[0] * moved[1] - t[1] * moved[0])


compile_kernels(
    __name__,
    inline=("_measure_edge", "_half_solid_angle", "_swept", "small_atan", "transport"),
    owning=("spread_directors",),
)
