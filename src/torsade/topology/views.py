"""What is seen of curves from one direction: crossings, and how far the projected curve turns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from torsade import curve
from torsade.arrays import Floats, Ints
from torsade.errors import TorsadeError
from torsade.topology.polygons import Curves, Polygons, polygon, polygons, unit_direction

__all__ = ["directional_crossing_number", "directional_writhe", "total_curvature", "turning_number"]


def directional_writhe(curves: Curves, closed: bool | Sequence[bool], direction: ArrayLike) -> int:
    """Sum of the signs of all crossings of one or several curves seen along a direction, shape (3,).

    A crossing has the sign of (t1 × t2) . (r1 - r2): positive when right-handed. The mean over all directions
    is the writhe (4.18). Every two edges are looked at: time and memory grow as the square of their number.

    Raises:
        TorsadeError: edges that cannot be told apart from there, because one is seen to touch the other; or
            input that `polygons` refuses.
    """
    return int(_crossing_signs(polygons(curves, closed), direction).sum())


def directional_crossing_number(curves: Curves, closed: bool | Sequence[bool], direction: ArrayLike) -> int:
    """Number of crossings seen along a direction; see `directional_writhe`."""
    return len(_crossing_signs(polygons(curves, closed), direction))


def turning_number(x: ArrayLike, closed: bool, direction: ArrayLike = (0.0, 0.0, 1.0)) -> float:
    """Turning number of a curve seen along a direction that points to the eye, counterclockwise positive.

    The sum of the angles in (-pi, pi) by which the projected edges turn, over 2 pi: the degree of the tangent
    map (Whitney 1937). Of a closed curve it is a whole number up to round-off.

    Args:
        x: nodes, shape (n, 3).
        closed: whether the last node joins the first.
        direction: shape (3,); by default the x, y plane is looked at from above.

    Raises:
        TorsadeError: an edge that is seen as a point or folds straight back on the one before, or input that
            `polygons` refuses.
    """
    return float(_projected_turning(polygon(x, closed), closed, direction).sum() / (2 * np.pi))


def total_curvature(x: ArrayLike, closed: bool, direction: ArrayLike | None = None) -> float:
    """Sum of the turning angles of a curve [rad], in space or, given a direction, as seen along it.

    In space it is the mean of what is seen over all directions (Fáry 1949). Arguments and errors are those
    of `turning_number`.
    """
    x = polygon(x, closed)
    if direction is None:
        return float(curve.turning_angles(x, closed).sum())
    return float(np.abs(_projected_turning(x, closed, direction)).sum())


def _projected_turning(x: Floats, closed: bool, direction: ArrayLike) -> Floats:
    """Angles [rad] by which the projected edges turn, shape (n - 2,) open or (n,) closed."""
    e = curve.edge_vectors(x, closed)
    view = _view(direction)
    f = e @ view[:, :2]
    point = np.linalg.norm(f, axis=1) <= 1e-12 * np.linalg.norm(e, axis=1)
    if point.any():
        raise TorsadeError(
            f"edge {int(np.argmax(point))} is seen as a point along {view[:, 2]}; look from another direction"
        )
    before, after = (np.roll(f, 1, axis=0), f) if closed else (f[:-1], f[1:])
    sine, cosine = _cross(before, after), np.einsum("ec,ec->e", before, after)
    folded = (cosine < 0) & (np.abs(sine) <= 1e-12 * np.abs(cosine))
    if folded.any():
        node = int(np.argmax(folded)) + (not closed)
        raise TorsadeError(
            f"the curve is seen to fold straight back at node {node} along {view[:, 2]}; "
            "look from another direction"
        )
    return np.asarray(np.arctan2(sine, cosine))


def _crossing_signs(p: Polygons, direction: ArrayLike) -> Ints:
    """Signs of all crossings seen along a direction, shape (n_crossings,)."""
    view = _view(direction)
    corners = [p.corners(k) @ view for k in range(len(p.curves))]
    start, stop = np.concatenate([c[:-1] for c in corners]), np.concatenate([c[1:] for c in corners])
    i, j = _pairs(p, [len(c) - 1 for c in corners])
    p0, p1, q0, q1 = start[i], stop[i], start[j], stop[j]
    e, f = p1 - p0, q1 - q0
    # On which side of one edge the ends of the other are seen.
    q0_side, q1_side = _cross(e, q0 - p0), _cross(e, q1 - p0)
    p0_side, p1_side = _cross(f, p0 - q0), _cross(f, p1 - q0)
    seen = (q0_side * q1_side <= 0) & (p0_side * p1_side <= 0)
    clear = (q0_side * q1_side < 0) & (p0_side * p1_side < 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        height = (p0 + (p0_side / (p0_side - p1_side))[:, None] * e)[:, 2]
        height -= (q0 + (q0_side / (q0_side - q1_side))[:, None] * f)[:, 2]
    unclear = seen & ~(clear & (height != 0))
    if unclear.any():
        k = int(np.argmax(unclear))
        raise TorsadeError(
            f"edges {i[k]} and {j[k]} are seen to touch along {view[:, 2]}; look from another direction"
        )
    return np.asarray((np.sign(_cross(e, f)) * np.sign(height))[seen].astype(np.int64))


def _pairs(p: Polygons, count: Sequence[int]) -> tuple[Ints, Ints]:
    """All pairs i < j of edges that do not share a node; edges are counted through all curves."""
    i, j = np.triu_indices(sum(count), 1)
    owner = np.repeat(np.arange(len(count)), count)
    first = np.cumsum([0, *count])
    meets = (owner[i] == owner[j]) & (j == i + 1)
    seam = np.array(p.closed)[owner[i]] & (i == first[owner[i]]) & (j == first[owner[i] + 1] - 1)
    apart = ~(meets | seam)
    return i[apart], j[apart]


def _view(direction: ArrayLike) -> Floats:
    """Columns right, up and towards the eye of a view, shape (3, 3): a rotation."""
    n = unit_direction(direction)
    up = curve.perpendicular(n)
    return np.stack([np.cross(up, n), up, n], axis=1)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
