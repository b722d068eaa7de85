"""Open strands of a knot cut where they leave it, and led on to where they are held, pulled or left free."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsade.curve import edge_lengths

__all__ = ["cut_at", "radius_of", "way_out"]

FloatArray = NDArray[np.float64]

_BEND = 10.0  # reach of the bend that leads an end to its line [radii]
_SHARE = 0.7  # of a short lead that this bend may take
_SLOPE = 1.5  # least reach of a bend that leads to an axis, over the distance from it
_STRAIGHT = 2.0  # part at the end, even of a lead too short for its bend [radii]
_SAMPLES = 64


def radius_of(strands: Sequence[FloatArray], closed: Sequence[FloatArray]) -> float:
    """Distance from the origin within which closed strands lie and open ones turn back."""
    largest = max((float(np.linalg.norm(x, axis=1).max()) for x in closed), default=0.0)
    for x in strands:
        r = np.linalg.norm(x, axis=1)
        inwards = int(np.argmax(np.diff(r) >= 0))
        outwards = len(r) - 1 - int(np.argmax(np.diff(r[::-1]) >= 0))
        inner = r[min(inwards, outwards) : max(inwards, outwards) + 1]
        largest = max(largest, float(inner.max()))
    return largest


def cut_at(x: FloatArray, reach: float) -> FloatArray:
    """The part of an open strand between its first and its last passage of the sphere of radius `reach`."""
    r = np.linalg.norm(x, axis=1)
    inside = np.flatnonzero(r < reach)
    i, j = int(inside[0]), int(inside[-1])
    out = [x[i + 1 : j]]  # what is next to a passage could be too near to it
    if i > 0:
        out.insert(0, _passage(x[i - 1], x[i], reach)[None])
    if j < len(x) - 1:
        out.append(_passage(x[j + 1], x[j], reach)[None])
    return np.concatenate(out)


def _passage(a: FloatArray, b: FloatArray, reach: float) -> FloatArray:
    """The point between a, outside, and b, inside, at a distance from the origin."""
    d = b - a
    p, q = float(a @ d) / float(d @ d), (float(a @ a) - reach**2) / float(d @ d)
    return np.asarray(a + (-p - math.sqrt(max(0.0, p * p - q))) * d)


def way_out(x: FloatArray, angle: float, reach: float, on_axis: bool, length: float) -> FloatArray:
    """Nodes that lead on from the last node of x: a bend, and a straight part.

    Args:
        x: a strand [radii] that ends at the distance `reach` from the origin.
        angle: in the plane, of the straight part [rad].
        reach: of the knot [radii].
        on_axis: whether the straight part lies on a line through the origin.
        length: of all that is added [radii]; more where the bend takes more.
    """
    begin = x[-1]
    ahead = (x[-1] - x[-2]) / np.linalg.norm(x[-1] - x[-2])
    out = np.array([math.cos(angle), math.sin(angle), 0.0])
    if abs(out[1]) < 1e-12:
        out = np.array([math.copysign(1.0, out[0]), 0.0, 0.0])
    bend = min(_BEND, _SHARE * length)
    if on_axis:
        bend = max(bend, _SLOPE * float(np.linalg.norm(np.cross(begin, out))))
    if on_axis:
        end = (reach + bend) * out
    else:
        middle = ahead * (1, 1, 0) + out
        end = begin + bend * middle / np.linalg.norm(middle)
    arm = 0.4 * bend
    p = np.array([begin, begin + arm * ahead, end - arm * out, end])
    u = (np.arange(_SAMPLES + 1) / _SAMPLES)[:, None]
    curve = (1 - u) ** 3 * p[0] + 3 * u * (1 - u) ** 2 * p[1] + 3 * u**2 * (1 - u) * p[2] + u**3 * p[3]
    rest = max(length - float(edge_lengths(curve).sum()), _STRAIGHT)
    count = max(1, math.ceil(rest / bend * _SAMPLES))
    line = end + rest * np.arange(1, count + 1)[:, None] / count * out
    return np.concatenate([curve[1:], line])
