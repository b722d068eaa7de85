"""How near two edges are: a kernel."""

from __future__ import annotations

import math

from torsade._compile import compile_kernels
from torsade.arrays import Floats


def _clamped(value: float) -> float:
    return min(1.0, max(0.0, value))


def segment_distance(p0: Floats, p1: Floats, q0: Floats, q1: Floats) -> float:
    """Smallest distance [m] between the segments p0 p1 and q0 q1, each point (3,)."""
    ux = p1[0] - p0[0]
    uy = p1[1] - p0[1]
    uz = p1[2] - p0[2]
    vx = q1[0] - q0[0]
    vy = q1[1] - q0[1]
    vz = q1[2] - q0[2]
    rx = p0[0] - q0[0]
    ry = p0[1] - q0[1]
    rz = p0[2] - q0[2]
    uu = ux * ux + uy * uy + uz * uz
    vv = vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    ur = ux * rx + uy * ry + uz * rz
    vr = vx * rx + vy * ry + vz * rz
    determinant = uu * vv - uv * uv
    s = 0.0
    if determinant > 1e-12 * uu * vv:
        s = _clamped((uv * vr - ur * vv) / determinant)
    t = (uv * s + vr) / vv
    if t < 0.0 or t > 1.0:
        t = _clamped(t)
        s = _clamped((uv * t - ur) / uu)
    dx = rx + s * ux - t * vx
    dy = ry + s * uy - t * vy
    dz = rz + s * uz - t * vz
    return math.sqrt(dx * dx + dy * dy + dz * dz)


compile_kernels(__name__, inline=("_clamped", "segment_distance"))
