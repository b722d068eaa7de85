"""The surface of a fiber: a watertight tube around a smooth curve through its nodes.

Between nodes the centerline is a cubic through four nodes (Overhauser's spline on chord length), so a
fiber of few nodes still looks round. Rings of vertices follow a rotation-minimising frame, so the mesh
does not twist more than it must. On a closed fiber the frame comes back turned by the holonomy of the
curve; that angle is taken back evenly along the length and no seam is left. On an open fiber each
end is closed by a cap with a rounded edge, a hemisphere at most.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.errors import TorsadeError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Mesh(NamedTuple):
    """A triangulated closed surface.

    Attributes
    ----------
    vertices : (n_vertices, 3) [m]
    normals : (n_vertices, 3) outward unit normals
    faces : (n_faces, 3) vertices of each triangle, counter-clockwise seen from outside
    node : (n_vertices,) place along the fiber, counted in nodes: 3.25 is a quarter from node 3 to node 4
    """

    vertices: Floats
    normals: Floats
    faces: Ints
    node: Floats

    def volume(self) -> float:
        """Enclosed volume [m³], positive when faces point outward."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return float(np.sum(a * np.cross(b, c)) / 6.0)

    def at_vertices(self, values: ArrayLike) -> Floats:
        """Node values (n_nodes,) or (n_nodes, k), linear in between, at every vertex.

        On a closed fiber the value between the last and the first node is linear too.
        """
        v = np.asarray(values, dtype=np.float64)
        before = np.floor(self.node).astype(np.int64)
        s = self.node - before
        if v.ndim > 1:
            s = s[:, None]
        return np.asarray((1.0 - s) * v[before % len(v)] + s * v[(before + 1) % len(v)])


class SmoothCurve(NamedTuple):
    """A curve sampled more finely than its nodes: points (m, 3) [m], unit tangents (m, 3), node (m,)."""

    x: Floats
    t: Floats
    node: Floats


def smooth_centerline(
    x: ArrayLike, closed: bool, spacing: float, parts: ArrayLike | None = None
) -> SmoothCurve:
    """Smooth curve through the nodes x (n, 3) [m], sampled at most `spacing` [m] apart.

    A closed curve is sampled from node 0 up to, and without, node 0 again. With `parts`, how many parts
    every edge is divided into, these are taken, however long the edges are.
    """
    x = _distinct(np.asarray(x, dtype=np.float64), closed)
    n = len(x)
    chord = _chords(x, closed)
    slope = _slopes(x, chord, closed)
    pieces = _divided(chord, spacing) if parts is None else np.asarray(parts, dtype=np.int64)
    edge = np.repeat(np.arange(len(chord)), pieces)
    s = (np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[edge]
    if not closed:
        edge, s = np.append(edge, n - 2), np.append(s, 1.0)
    points, tangents = _hermite(x, slope, chord, edge, s)
    return SmoothCurve(points, tangents, edge + s)


def divisions(x: ArrayLike, closed: bool, spacing: float) -> Ints:
    """How many parts every edge of the polyline x (n, 3) is divided into, each at most `spacing` long."""
    return _divided(_chords(np.asarray(x, dtype=np.float64), closed), spacing)


def _chords(x: Floats, closed: bool) -> Floats:
    after = np.roll(x, -1, axis=0) if closed else x[1:]
    return np.asarray(np.linalg.norm(after - x[: len(after)], axis=1))


def _divided(chord: Floats, spacing: float) -> Ints:
    return np.maximum(1, np.ceil(chord / spacing - 1e-9)).astype(np.int64)


def _distinct(x: Floats, closed: bool) -> Floats:
    if x.ndim != 2 or x.shape[1] != 3 or len(x) < (3 if closed else 2) or not np.all(np.isfinite(x)):
        least = 3 if closed else 2
        raise TorsadeError(
            f"a tube was asked around nodes of shape {x.shape}; it needs at least {least} finite nodes in "
            "an array (n, 3): check the centerline."
        )
    step = np.diff(x, axis=0, append=x[:1]) if closed else np.diff(x, axis=0)
    if not np.all(np.any(step != 0.0, axis=1)):
        raise TorsadeError("two nodes that follow each other are at one place; remove one of them.")
    return x


def _slopes(x: Floats, chord: Floats, closed: bool) -> Floats:
    """dx/ds (n, 3) at the nodes, of the parabola through each node and its two neighbours."""
    if closed:
        rate = (np.roll(x, -1, axis=0) - x) / chord[:, None]
        before, after, a, b = np.roll(rate, 1, axis=0), rate, np.roll(chord, 1), chord
        return np.asarray((before * b[:, None] + after * a[:, None]) / (a + b)[:, None])
    rate = np.diff(x, axis=0) / chord[:, None]
    slope = np.empty_like(x)
    a, b = chord[:-1, None], chord[1:, None]
    slope[1:-1] = (rate[:-1] * b + rate[1:] * a) / (a + b)
    slope[0] = 2.0 * rate[0] - slope[1] if len(x) > 2 else rate[0]
    slope[-1] = 2.0 * rate[-1] - slope[-2] if len(x) > 2 else rate[-1]
    return slope


def _hermite(x: Floats, slope: Floats, chord: Floats, edge: Ints, s: Floats) -> tuple[Floats, Floats]:
    """Points and unit tangents (m, 3) of the cubics with given ends and slopes."""
    p, q = x[edge], x[(edge + 1) % len(x)]
    length, s = chord[edge][:, None], s[:, None]
    u, w = slope[edge] * length, slope[(edge + 1) % len(x)] * length
    points = p + s * (u + s * (3.0 * (q - p) - 2.0 * u - w + s * (2.0 * (p - q) + u + w)))
    rate = u + s * (2.0 * (3.0 * (q - p) - 2.0 * u - w) + 3.0 * s * (2.0 * (p - q) + u + w))
    return points, _unit(rate)


def _unit(v: Floats) -> Floats:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def minimal_frame(curve: SmoothCurve, closed: bool) -> tuple[Floats, Floats]:
    """Two directors (m, 3) each, orthonormal to the tangents, that turn about them as little as possible.

    Directors are parallel transported from point to point. On a closed curve the angle left after one
    round is taken back in proportion to arclength.
    """
    t = curve.t
    turns = _transports(t[:-1], t[1:])
    frames = _prefix_products(np.concatenate([np.eye(3)[None], turns]))
    first = np.eye(3)[np.argmin(np.abs(t[0]))]
    first = _unit(first - (first @ t[0]) * t[0])
    u = frames @ first
    u = _unit(u - np.sum(u * t, axis=1, keepdims=True) * t)
    v = np.cross(t, u)
    if not closed:
        return u, v
    home = (_transports(t[-1:], t[:1]) @ u[-1])[0]
    angle = np.arctan2(home @ v[0], home @ u[0])
    gaps = np.linalg.norm(np.roll(curve.x, -1, axis=0) - curve.x, axis=1)
    phi = (-angle * (np.cumsum(gaps) - gaps) / gaps.sum())[:, None]
    return np.cos(phi) * u + np.sin(phi) * v, np.cos(phi) * v - np.sin(phi) * u


def _transports(a: Floats, b: Floats) -> Floats:
    """Smallest rotations (m, 3, 3) that bring unit vectors a to b, none of them opposite."""
    c = np.cross(a, b)
    cosine = np.sum(a * b, axis=1)
    cross = np.zeros((len(a), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = c
    cross[:, [1, 2, 0], [2, 0, 1]] = -c
    scale = 1.0 / np.maximum(1.0 + cosine, 1e-12)
    return np.asarray(np.eye(3) + cross + scale[:, None, None] * (cross @ cross))


def _prefix_products(m: Floats) -> Floats:
    """Products m[k] ... m[1] m[0] for every k, by doubling: log2(n) passes over the whole array."""
    product = m.copy()
    step = 1
    while step < len(product):
        product[step:] = product[step:] @ product[:-step]
        step *= 2
    return product


def tube(
    x: ArrayLike,
    radius: float,
    closed: bool = False,
    *,
    sides: int = 32,
    spacing: float = 0.25,
    rounding: float = 1.0,
    parts: ArrayLike | None = None,
) -> Mesh:
    """Watertight tube around the polyline x.

    Parameters
    ----------
    x : (n, 3) node positions [m]
    radius : h [m]
    closed : whether the last node is joined to the first
    sides : vertices on a ring
    spacing : distance between rings, at most, in radii
    rounding : radius of the rounded edge of the end caps, in radii: 1 is a hemisphere, near 0 a clean cut
    parts : rings on every edge, in place of `spacing`: a fiber that moves keeps its triangles
    """
    if not (radius > 0 and sides >= 3 and spacing > 0 and 0 < rounding <= 1):
        raise TorsadeError(
            f"a tube was asked with radius {radius}, {sides} sides, spacing {spacing} and rounding "
            f"{rounding}; radius and spacing must be positive, sides 3 or more, rounding in (0, 1]."
        )
    curve = smooth_centerline(x, closed, spacing * radius, parts)
    u, v = minimal_frame(curve, closed)
    phi = 2.0 * np.pi * np.arange(sides) / sides
    normals = np.cos(phi)[None, :, None] * u[:, None] + np.sin(phi)[None, :, None] * v[:, None]
    if closed:
        rings = curve.x[:, None] + radius * normals
        faces = _wall(len(rings), sides, closed=True)
        node = np.repeat(curve.node, sides)
        return Mesh(rings.reshape(-1, 3), normals.reshape(-1, 3), faces, node)
    return _capped(curve, normals, radius, rounding)


def _wall(rings: int, sides: int, closed: bool) -> Ints:
    """Triangles (m, 3) between successive rings of vertices."""
    k = np.arange(rings if closed else rings - 1)[:, None]
    i = np.arange(sides)[None, :]
    after, right = (k + 1) % rings, (i + 1) % sides
    a, b, c, d = k * sides + i, k * sides + right, after * sides + right, after * sides + i
    return np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]).reshape(-1, 3)


def _capped(curve: SmoothCurve, out: Floats, radius: float, rounding: float) -> Mesh:
    """Tube of an open curve: rings (m, sides, 3) along it, a few more around each rounded edge, two poles."""
    sides = out.shape[1]
    edge = rounding * radius
    steps = max(4, sides // 4)
    psi = 0.5 * np.pi * np.arange(1, steps + (rounding < 1.0)) / steps
    reach = (radius - edge + edge * np.cos(psi))[:, None, None]
    lift = (edge * np.sin(psi))[:, None, None]
    rings, normals = [], []
    for end, sign in ((0, -1.0), (-1, 1.0)):
        axis = sign * curve.t[end]
        ring = curve.x[end] + reach * out[end] + lift * axis
        normal = np.cos(psi)[:, None, None] * out[end] + np.sin(psi)[:, None, None] * axis
        rings.append(ring if sign > 0 else ring[::-1])
        normals.append(normal if sign > 0 else normal[::-1])
    all_rings = np.concatenate([rings[0], curve.x[:, None] + radius * out, rings[1]])
    all_normals = np.concatenate([normals[0], out, normals[1]])
    poles = np.stack([curve.x[0] - edge * curve.t[0], curve.x[-1] + edge * curve.t[-1]])
    n = len(all_rings)
    i = np.arange(sides)
    right = (i + 1) % sides
    low, high, top = n * sides, n * sides + 1, (n - 1) * sides
    first = np.stack([np.full(sides, low), right, i], axis=1)
    last = np.stack([np.full(sides, high), top + i, top + right], axis=1)
    ends = curve.node[[0, -1]]
    along = np.concatenate([np.full(len(psi), ends[0]), curve.node, np.full(len(psi), ends[1])])
    return Mesh(
        vertices=np.concatenate([all_rings.reshape(-1, 3), poles]),
        normals=np.concatenate([all_normals.reshape(-1, 3), -curve.t[:1], curve.t[-1:]]),
        faces=np.concatenate([_wall(n, sides, closed=False), first, last]),
        node=np.concatenate([np.repeat(along, sides), ends]),
    )
