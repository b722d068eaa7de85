"""Where to look from: the part of the strands that is the knot, the side that shows it best, the frame.

All lengths here are in one unit, whichever the caller uses; `radius` h is that of the fibers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from torsade.view.tube import Centerline

Floats = NDArray[np.float64]

VIEW_ANGLE = np.radians(14.0)
"""Height of the field of view: a long lens, so that sizes near and far can be compared."""

SAMPLE = 0.5
"""Spacing of the centerline points that the choices are made on, in radii."""


class View(NamedTuple):
    """A camera.

    Attributes
    ----------
    right, up, toward : (3,) orthonormal: along the frame, up the frame, and from the knot to the camera
    focus : (3,) the point in the middle of the frame
    half_height : half the height of the frame at the focus
    size : (width, height) of the frame in pixels
    """

    right: Floats
    up: Floats
    toward: Floats
    focus: Floats
    half_height: float
    size: tuple[int, int]

    @property
    def distance(self) -> float:
        """Distance from the focus to the camera."""
        return float(self.half_height / np.tan(0.5 * VIEW_ANGLE))

    def pixels(self, x: Floats) -> Floats:
        """Where points x (n, 3) fall in the frame: (n, 2) pixels, rightward and upward from its corner."""
        r = x - self.focus
        scale = 0.5 * self.size[1] / self.half_height / (1.0 - (r @ self.toward) / self.distance)
        flat = np.stack([r @ self.right, r @ self.up], axis=1)
        return np.asarray(flat * scale[:, None] + 0.5 * np.array(self.size))


def knot_body(curves: Sequence[Centerline], closed: Sequence[bool], radius: float) -> list[Floats]:
    """Points (m, 3) of each strand from its first to its last contact; whole strands if nothing is close.

    Contact is looked for at 2.2 radii between centerlines, then further away, up to 10 radii, so
    that a knot that is still loose is found too. A strand without contact has no points.
    """
    for reach in (2.2, 3.0, 5.0, 10.0):
        touched = _contacts(curves, closed, radius, reach * radius)
        if any(len(k) for k in touched):
            return [
                c.x if loop and len(k) else c.x[k.min() : k.max() + 1] if len(k) else c.x[:0]
                for c, k, loop in zip(curves, touched, closed, strict=True)
            ]
    return [c.x for c in curves]


def _contacts(
    curves: Sequence[Centerline], closed: Sequence[bool], radius: float, reach: float
) -> list[NDArray[np.int64]]:
    """Points of each strand that another strand, or the same strand much further on, comes close to."""
    x = np.concatenate([c.x for c in curves])
    start = np.cumsum([0] + [len(c.x) for c in curves])
    strand = np.repeat(np.arange(len(curves)), np.diff(start))
    along = np.concatenate([_arclength(c.x) for c in curves])
    round_trip = np.array([a + np.linalg.norm(c.x[-1] - c.x[0]) for c, a in
                           ((c, _arclength(c.x)[-1]) for c in curves)])
    i, j = cKDTree(x).query_pairs(reach, output_type="ndarray").T
    gap = np.abs(along[i] - along[j])
    loop = np.array(closed)[strand[i]]
    gap = np.where(loop, np.minimum(gap, round_trip[strand[i]] - gap), gap)
    apart = (strand[i] != strand[j]) | (gap > 0.5 * np.pi * reach + radius)
    touched = np.unique(np.concatenate([i[apart], j[apart]]))
    return [touched[strand[touched] == s] - start[s] for s in range(len(curves))]


def _arclength(x: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])


def best_side(body: Floats, radius: float, level: bool) -> tuple[Floats, Floats]:
    """Directions right and toward the camera (3,) from which the strands hide each other least.

    Among many directions, the one with the largest silhouette of the body (n, 3). With `level`, the x axis,
    along which fibers are pulled, stays horizontal; without, the longest axis of the silhouette does.
    Opposite directions have equal silhouettes; the side of +z is taken, where diagrams are seen from.
    """
    if level:
        angle = np.radians(np.arange(-90.0, 90.0, 7.5))
        sides = np.stack([0.0 * angle, np.sin(angle), np.cos(angle)], axis=1)
    else:
        z = (np.arange(96) + 0.5) / 96
        turn = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(96)
        rho = np.sqrt(1.0 - z * z)
        sides = np.stack([rho * np.cos(turn), rho * np.sin(turn), z], axis=1)
    centred = body - body.mean(axis=0)
    rights = [np.array([1.0, 0.0, 0.0]) if level else _longest(centred, d) for d in sides]
    area = [_silhouette(centred, r, d, radius) for r, d in zip(rights, sides, strict=True)]
    best = int(np.argmax(np.array(area) * (1.0 + 0.05 * sides[:, 2])))
    return rights[best], sides[best]


def level_right(toward: Floats) -> Floats:
    """The horizontal of the frame (3,) for a given side: the x axis as nearly as possible, else y."""
    axis = np.array([1.0, 0.0, 0.0]) if abs(toward[0]) < 0.95 else np.array([0.0, 1.0, 0.0])
    right = axis - (axis @ toward) * toward
    return np.asarray(right / np.linalg.norm(right))


def _longest(centred: Floats, toward: Floats) -> Floats:
    """Longest principal axis (3,) of points (n, 3) projected along a direction, pointing to +x or +y."""
    flat = centred - np.outer(centred @ toward, toward)
    axis = np.linalg.eigh(flat.T @ flat)[1][:, 2]
    return np.asarray(axis if axis[0] + 1e-3 * axis[1] >= 0 else -axis)


def _silhouette(centred: Floats, right: Floats, toward: Floats, radius: float) -> float:
    """Area that discs of the given radius around the points (n, 3) cover, seen from one side."""
    up = np.cross(toward, right)
    flat = np.stack([centred @ right, centred @ up], axis=1)
    cell = 0.25 * radius
    low, high = flat.min(axis=0) - radius, flat.max(axis=0) + radius
    axes = [np.arange(low[k], high[k], max(cell, (high[k] - low[k]) / 200.0)) for k in (0, 1)]
    grid = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    covered = cKDTree(flat).query(grid, distance_upper_bound=radius)[0] < radius
    return float(covered.mean() * np.prod(high - low))


def frame(
    body: Floats,
    radius: float,
    size: tuple[int, int],
    right: ArrayLike,
    toward: ArrayLike,
    fill: float = 0.74,
) -> View:
    """The view whose frame the body (n, 3) fills to the given fraction, in width or in height."""
    r, d = np.asarray(right, dtype=np.float64), np.asarray(toward, dtype=np.float64)
    u = np.cross(d, r)
    view = View(r, u, d, body.mean(axis=0), float(np.ptp(body @ u) + np.ptp(body @ r) + 2.0 * radius), size)
    for _ in range(6):
        unit = view.half_height / (0.5 * size[1])
        at = (view.pixels(body) - 0.5 * np.array(size)) * unit
        low, high = at.min(axis=0) - radius, at.max(axis=0) + radius
        middle, span = 0.5 * (low + high), high - low
        half = 0.5 * max(span[1], span[0] * size[1] / size[0]) / fill
        view = view._replace(focus=view.focus + middle[0] * r + middle[1] * u, half_height=float(half))
    return view
