"""What is seen of curves from one direction: crossings, and how far the projected curve turns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from torsade import curve
from torsade.arrays import Floats, Ints
from torsade.errors import TorsadeError
from torsade.topology._crossings import Degenerate, cross_over, polylines
from torsade.topology.polygons import Curves, polygon, unit_direction

__all__ = ["directional_crossing_number", "directional_writhe", "total_curvature", "turning_number"]


def directional_writhe(curves: Curves, closed: bool | Sequence[bool], direction: ArrayLike) -> int:
    """Sum of the signs of all crossings of one or several curves seen along a direction, shape (3,).

    A crossing has the sign of (t1 × t2) . (r1 - r2): positive when right-handed. The mean over all directions
    is the writhe (4.18).

    Raises:
        TorsadeError: edges that cannot be told apart from there, because one is seen to touch the other or
            end on, or three to meet in a point; or input that `polygons` refuses.
    """
    return int(_crossing_signs(curves, closed, direction).sum())


def directional_crossing_number(curves: Curves, closed: bool | Sequence[bool], direction: ArrayLike) -> int:
    """Number of crossings seen along a direction; see `directional_writhe`."""
    return len(_crossing_signs(curves, closed, direction))


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


def _crossing_signs(curves: Curves, closed: bool | Sequence[bool], direction: ArrayLike) -> Ints:
    """Signs of all crossings seen along a direction, shape (n_crossings,)."""
    view = _view(direction)
    try:
        return cross_over(polylines(curves, closed, "curve"), view.T).sign
    except Degenerate as reason:
        raise TorsadeError(f"seen along {view[:, 2]}, {reason}; look from another direction") from reason


def _view(direction: ArrayLike) -> Floats:
    """Columns right, up and towards the eye of a view, shape (3, 3): a rotation."""
    n = unit_direction(direction)
    up = curve.perpendicular(n)
    return np.stack([np.cross(up, n), up, n], axis=1)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
