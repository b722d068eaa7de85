"""Curves that tests of topology measure."""

from __future__ import annotations

import numpy as np

from torsade import curve
from torsade.arrays import Floats


def around(n: int) -> Floats:
    """Parameters (n,) of a closed curve."""
    return 2 * np.pi * np.arange(n) / n


def torus_knot(p: int, q: int, n: int, phase: float = 0.0) -> Floats:
    """T(p, q), left-handed, on a torus of radii 2 and 1; phase turns it on the torus."""
    t = around(n)
    r = 2 + np.cos(q * t + phase)
    return np.stack([r * np.cos(p * t), r * np.sin(p * t), np.sin(q * t + phase)], axis=1)


def ring(n: int = 40, radius: float = 1.0) -> Floats:
    """A regular polygon in the x, y plane, counterclockwise."""
    t = around(n)
    return radius * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)


def hopf_link(n: int = 30) -> list[Floats]:
    """Two rings through each other, Lk = -1."""
    x = ring(n)
    return [x, x[:, [0, 2, 1]] + np.array([1.0, 0.0, 0.0])]


def random_polygon(seed: int, n: int) -> Floats:
    """Corners at random."""
    return np.random.default_rng(seed).normal(size=(n, 3))


def random_loop(seed: int, n: int, waves: int = 3) -> Floats:
    """A smooth closed curve of a few random waves."""
    rng = np.random.default_rng(seed)
    t = around(n)[:, None, None]
    k = np.arange(1, waves + 1)[None, :, None]
    a, b = rng.normal(size=(2, 1, waves, 3)) / k
    return np.asarray((a * np.cos(k * t) + b * np.sin(k * t)).sum(axis=1))


def random_directions(seed: int, count: int) -> Floats:
    """Directions (count, 3), uniform on the sphere."""
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(v / np.linalg.norm(v, axis=1, keepdims=True))


def rotation(seed: int) -> Floats:
    """A random rotation matrix."""
    q = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return np.asarray(q * np.sign(np.linalg.det(q)))


def turned_directors(x: Floats, closed: bool, angle: Floats) -> Floats:
    """Directors at angles (n_edges,) from a frame that does not turn."""
    f = curve.rotation_minimising_frames(x, closed)
    return np.asarray(f.u * np.cos(angle)[:, None] + f.v * np.sin(angle)[:, None])


def half_solid_angles(p: Floats, q: Floats, i: Floats, j: Floats) -> Floats:
    """Minus Omega/2 of edges p q of numbers i, j, triangle by triangle of unit vectors, in plain numpy."""
    total = np.zeros(len(i))
    a, b, c, d = (
        r / np.linalg.norm(r, axis=1, keepdims=True)
        for r in (p[j] - p[i], q[j] - p[i], q[j] - q[i], p[j] - q[i])
    )
    for u, v, w in ((a, b, c), (a, c, d)):
        dots = sum(np.einsum("ec,ec->e", r, s) for r, s in ((u, v), (v, w), (w, u)))
        total -= np.arctan2(np.einsum("ec,ec->e", u, np.cross(v, w)), 1 + dots)
    return total


def brute_force(x: Floats, closed: bool) -> tuple[float, float, Floats]:
    """Writhe, average crossing number and writhe of each edge, by plain numpy over all pairs of edges."""
    p, q = (x, np.roll(x, -1, axis=0)) if closed else (x[:-1], x[1:])
    n = len(p)
    i, j = np.triu_indices(n, 2)
    if closed:
        apart = j - i < n - 1
        i, j = i[apart], j[apart]
    each = half_solid_angles(p, q, i, j) / np.pi
    density = (np.bincount(i, each, n) + np.bincount(j, each, n)) / 2
    return float(each.sum()), float(np.abs(each).sum()), np.asarray(density)
