"""Where to look from: the part of the strands that is the knot, the side that shows it best, the frame.

All lengths here are in one unit, whichever the caller uses; `radius` h is that of the fibers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from torsade.view.tube import SmoothCurve

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
        flat = (x - self.focus) @ np.stack([self.right, self.up], axis=1)
        return np.asarray(flat * self.scale(x)[:, None] + 0.5 * np.array(self.size))

    def scale(self, x: Floats) -> Floats:
        """Pixels per unit of length at points x (n, 3), larger nearer to the camera."""
        nearness = np.minimum((x - self.focus) @ self.toward / self.distance, 0.95)
        return np.asarray(0.5 * self.size[1] / self.half_height / (1.0 - nearness))


def knot_body(curves: Sequence[SmoothCurve], closed: Sequence[bool], radius: float) -> list[Floats]:
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
    curves: Sequence[SmoothCurve], closed: Sequence[bool], radius: float, reach: float
) -> list[NDArray[np.int64]]:
    """Points of each strand that another strand, or the same strand much further on, comes close to."""
    x = np.concatenate([c.x for c in curves])
    start = np.cumsum([0] + [len(c.x) for c in curves])
    strand = np.repeat(np.arange(len(curves)), np.diff(start))
    places = [_arclength(c.x) for c in curves]
    along = np.concatenate(places)
    once_round = np.array(
        [a[-1] + np.linalg.norm(c.x[-1] - c.x[0]) for a, c in zip(places, curves, strict=True)]
    )
    i, j = cKDTree(x).query_pairs(reach, output_type="ndarray").T
    gap = np.abs(along[i] - along[j])
    loop = np.array(closed)[strand[i]]
    gap = np.where(loop, np.minimum(gap, once_round[strand[i]] - gap), gap)
    apart = (strand[i] != strand[j]) | (gap > 0.5 * np.pi * reach + radius)
    touched = np.unique(np.concatenate([i[apart], j[apart]]))
    return [touched[strand[touched] == s] - start[s] for s in range(len(curves))]


def _arclength(x: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])


def best_side(curves: Sequence[Floats], body: Floats, radius: float, level: bool) -> tuple[Floats, Floats]:
    """Directions right and toward the camera (3,) from which the knot is plainest.

    Among many directions, the one with most of the body (n, 3) in sight, hidden neither by itself nor by
    the rest of the strands, whose points (m, 3) are `curves`, with few and clear crossings, and with no
    strand end on: the largest visible area over the square root of the number of crossings, an oblique one
    counting for more, times the projected share of the length.

    With `level`, the x axis, along which fibers are pulled, stays horizontal; without, the longest axis of
    the projected body does. Of two sides nearly as good, the one nearer to +z, where diagrams are seen from,
    is taken, and then the one nearer to +y.
    """
    if level:
        angle = np.radians(np.arange(-180.0, 180.0, 7.5))
        sides = np.stack([0.0 * angle, np.sin(angle), np.cos(angle)], axis=1)
    else:
        z = 1.0 - (2.0 * np.arange(128) + 1.0) / 128
        turn = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(128)
        rho = np.sqrt(1.0 - z * z)
        sides = np.stack([rho * np.cos(turn), rho * np.sin(turn), z], axis=1)
    low, high = body.min(axis=0), body.max(axis=0)
    centre, reach = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)) + 2.0 * radius
    near = [(c[np.linalg.norm(c - centre, axis=1) < reach] - centre) / radius for c in curves]
    near = [c[:: 1 + sum(map(len, near)) // 400] for c in near]
    inside = np.asarray(cKDTree((body - centre) / radius).query(np.concatenate(near))[0]) < SAMPLE
    score = np.empty(len(sides))
    rights = np.tile([1.0, 0.0, 0.0], (len(sides), 1))
    for k, toward in enumerate(sides):
        if not level:
            rights[k] = _longest(np.concatenate(near)[inside], toward)
        axes = np.stack([rights[k], np.cross(toward, rights[k]), toward], axis=1)
        turned = [c @ axes for c in near]
        area = _visible_area(np.concatenate(turned), inside)
        score[k] = area * _breadth(turned) / np.sqrt(1.0 + _crossings(turned))
    best = int(np.argmax(score * (1.0 + sides @ [0.0, 0.01, 0.03])))
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


def _visible_area(points: Floats, inside: NDArray[np.bool_]) -> float:
    """Area in which, of unit discs around points (n, 3) seen from +z, one of `inside` is in front."""
    flat = points[:, :2]
    low, high = flat[inside].min(axis=0) - 1.0, flat[inside].max(axis=0) + 1.0
    step = max(0.4, float((high - low).max()) / 64.0)
    columns, rows = np.arange(low[0], high[0], step), np.arange(low[1], high[1], step)
    front = np.zeros((len(columns), len(rows)), dtype=np.bool_)
    for k in np.argsort(points[:, 2], kind="stable"):
        a, b = flat[k]
        c0, c1 = np.searchsorted(columns, (a - 1.0, a + 1.0))
        r0, r1 = np.searchsorted(rows, (b - 1.0, b + 1.0))
        disc = (columns[c0:c1, None] - a) ** 2 + (rows[None, r0:r1] - b) ** 2 < 1.0
        front[c0:c1, r0:r1][disc] = inside[k]
    return float(front.sum() * step * step)


def _breadth(curves: Sequence[Floats]) -> float:
    """Length of polylines (n, 3) seen from +z over their length."""
    e = np.concatenate([np.diff(c, axis=0) for c in curves])
    return float(np.linalg.norm(e[:, :2], axis=1).sum() / np.linalg.norm(e, axis=1).sum())


def _crossings(curves: Sequence[Floats]) -> float:
    """Crossings of polylines (n, 3) seen from +z, each weighted with 1 over its sine, up to 5."""
    a = np.concatenate([c[:-1, :2] for c in curves])
    e = np.concatenate([np.diff(c[:, :2], axis=0) for c in curves])
    w = a[None] - a[:, None]
    area = e[:, None, 0] * e[None, :, 1] - e[:, None, 1] * e[None, :, 0]
    area[area == 0.0] = np.inf
    s = (w[..., 0] * e[None, :, 1] - w[..., 1] * e[None, :, 0]) / area
    i, j = np.nonzero(np.triu((s > 0.0) & (s <= 1.0) & (s.T > 0.0) & (s.T <= 1.0), 2))
    length = np.linalg.norm(e, axis=1)
    return float(np.sum(np.minimum(length[i] * length[j] / np.abs(area[i, j]), 5.0)))


def frame(
    body: Floats,
    radius: float,
    size: tuple[int, int],
    right: ArrayLike,
    toward: ArrayLike,
    fill: float,
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
