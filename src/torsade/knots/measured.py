"""Measured centerlines: noise smoothed away and nodes spread evenly, without changing the knot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsade import curve
from torsade.centerline import Centerline
from torsade.errors import TorsadeError
from torsade.spline import ArclengthSpline
from torsade.topology.isotopy import carried_over, thinned_to
from torsade.units import metres

__all__ = ["Cleaned", "clean"]

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

LEAST_SHARE = 1 / 8
"""The least smoothing that is tried, of what is asked for."""

MOST_NODES = 100_000
"""Most nodes that are compared with each other: those of the largest run."""

_ROUNDS = 5
_LEAST_EDGE = 0.05  # of the mean


@dataclass(frozen=True, eq=False)
class Cleaned(Centerline):
    """A centerline smoothed and resampled.

    Attributes:
        strands: nodes [m] of each strand, shapes (n, 3).
        scale: smoothing length that was used [m]; what was asked for, or less.
    """

    scale: float = 0.0


def clean(
    centerline: Centerline, scale: float | str, spacing: float | str | None = None, every: int = 1
) -> Cleaned:
    """Smooth away what is shorter than a scale, and spread nodes evenly; the knot stays what it is.

    That no strand passes through another on the way from the nodes as given to the result is shown by a
    chain of triangle moves (`torsade.topology.isotopy`). Where none is found half as much smoothing is tried,
    down to an eighth. Ends of open strands stay where they are. As `torsade.curve.smooth` has it, a wave of
    wave number k is reduced by 1 + (k scale)^4, with arclength along the smoothed curve.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        centerline: strands of measured nodes [m], in their order along the strand.
        scale: smoothing length [m], 0 for none; below the distance of strands from each other.
        spacing: greatest distance between nodes of the result [m]; as many as are given, if left out.
        every: of the nodes as given take every so many only. Where noise is larger than the distance of nodes
            it may tie small knots; with fewer nodes there are none, and theirs is the knot that stays.

    Raises:
        TorsadeError: strands that touch each other or themselves, nodes that are not finite, a length out of
            range, or a knot that may change.

    >>> from torsade.topology import braid_curves
    >>> (x,) = clean(Centerline(tuple(braid_curves([1, 1, 1])), (True,)), 0.1, spacing=0.25).strands
    >>> len(x) < 200
    True
    """
    s = metres("scale", scale)
    if not 0 <= s < math.inf:
        raise TorsadeError(f"the smoothing length is {s:g} m; give a length of at least 0")
    step = None if spacing is None else metres("spacing", spacing)
    if not 1 <= every <= MOST_NODES:
        raise TorsadeError(f"every is {every}; give a whole number from 1, such as 4 for every fourth node")
    given, closed = _sound(centerline, every), centerline.closed
    _check_apart(given, closed)
    if step is not None and step > 0:
        _check_count(sum(curve.length(x, c) / step for x, c in zip(given, closed, strict=True)))
    counts = [len(x) for x in given]
    if s == 0:
        return Cleaned(_resampled(given, closed, counts, step), closed, 0.0)
    fine = [_refined(x, c, s) for x, c in zip(given, closed, strict=True)]
    _check_count(sum(map(len, fine)))
    share = 1.0
    while share >= LEAST_SHARE:
        smoother = [_smoothed(x, c, share * s) for x, c in zip(fine, closed, strict=True)]
        if carried_over(fine, smoother, closed, share * s):
            return Cleaned(_resampled(smoother, closed, counts, step), closed, share * s)
        share /= 2
    raise TorsadeError(
        f"smoothing over {_mm(s)} may pull strands through each other, and so may an eighth of it; give "
        "a smaller length or, where noise is larger than the distance of nodes, every few nodes only "
        "(torsade convert --every 4)"
    )


def _sound(centerline: Centerline, every: int) -> list[FloatArray]:
    """Every so many nodes of each strand, without repetitions, refused where they make no curve."""
    found = []
    for k, (x, closed) in enumerate(zip(centerline.strands, centerline.closed, strict=True)):
        if not np.isfinite(x).all():
            i = int(np.argmin(np.isfinite(x).all(axis=1)))
            raise TorsadeError(f"node {i} of strand {k} is not finite; give finite coordinates, in metres")
        moved = np.ones(len(x), dtype=bool)
        moved[1:] = (np.diff(x, axis=0) != 0).any(axis=1)
        nodes = x[moved]
        if closed and len(nodes) > 1 and (nodes[0] == nodes[-1]).all():
            nodes = nodes[:-1]
        last = [] if closed or (len(nodes) - 1) % every == 0 else [len(nodes) - 1]
        nodes = nodes[[*range(0, len(nodes), every), *last]]
        least = 3 if closed else 2
        if len(nodes) < least:
            raise TorsadeError(f"strand {k} has {len(nodes)} different nodes left; give at least {least}")
        found.append(nodes)
    _check_count(sum(map(len, found)))
    return found


def _check_apart(strands: list[FloatArray], closed: tuple[bool, ...]) -> None:
    """Refuse edges that meet: they are no knot."""
    mean = np.mean(np.concatenate([curve.edge_lengths(x, c) for x, c in zip(strands, closed, strict=True)]))
    near = curve.clearance(strands, closed, 0.0)
    if near.distance > 1e-6 * mean:
        return
    (a, b), (i, j) = near.strands, near.edges
    who = f"strands {a} and {b} meet" if a != b else f"strand {a} meets itself"
    raise TorsadeError(f"{who} at edges {i} and {j}, which leaves open what knot it is; move them apart")


def _check_count(nodes: float) -> None:
    if nodes > MOST_NODES:
        raise TorsadeError(
            f"smoothing and resampling would need {nodes:.0f} nodes, more than {MOST_NODES}; give fewer, or "
            "a larger smoothing length or spacing"
        )


def _refined(x: FloatArray, closed: bool, longest: float) -> FloatArray:
    """The same polyline with nodes added on edges that are longer than a length."""
    ends = np.concatenate([x, x[:1]]) if closed else x
    parts = np.ceil(curve.edge_lengths(x, closed) / longest)
    _check_count(float(parts.sum()))
    count = parts.astype(int)
    edge = np.repeat(np.arange(len(count)), count)
    share = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)) / count[edge]
    nodes = ends[edge] + share[:, None] * (ends[edge + 1] - ends[edge])
    return nodes if closed else np.concatenate([nodes, x[-1:]])


def _smoothed(x: FloatArray, closed: bool, scale: float) -> FloatArray:
    """Nodes smoothed, with arclength taken along the result."""
    lengths, y = None, x
    for _ in range(_ROUNDS):
        y = curve.smooth(x, scale, closed, lengths)
        l = curve.edge_lengths(y, closed)
        lengths = np.maximum(l, _LEAST_EDGE * l.mean())
    return y


def _resampled(
    strands: list[FloatArray], closed: tuple[bool, ...], counts: list[int], spacing: float | None
) -> tuple[FloatArray, ...]:
    """Nodes spread evenly along splines; these, with old and new nodes, are thinned to either."""
    both, old, new = [], [], []
    for x, c, count in zip(strands, closed, counts, strict=True):
        fresh = curve.resample(x, n=count if spacing is None else None, spacing=spacing, closed=c)
        nodes, is_old, is_new = _together(x, fresh, c)
        both.append(nodes)
        old.append(is_old)
        new.append(is_new)
    if not (thinned_to(both, closed, old) and thinned_to(both, closed, new)):
        raise TorsadeError(
            "with nodes so far apart strands would pass through each other; give a smaller spacing"
        )
    return tuple(nodes[is_new] for nodes, is_new in zip(both, new, strict=True))


def _together(x: FloatArray, fresh: FloatArray, closed: bool) -> tuple[FloatArray, BoolArray, BoolArray]:
    """Nodes of a polyline and new ones on its spline in their order, and which are old and which new."""
    knots = np.concatenate([x, x[:1]]) if closed else x
    parameter = np.concatenate([[0.0], np.cumsum(curve.edge_lengths(knots))])
    s = ArclengthSpline(knots, parameter, closed).arclength if len(knots) > 2 else parameter
    t = np.linspace(0.0, s[-1], len(fresh) + closed)
    if closed:
        s, t = s[:-1], t[:-1]
    at = np.concatenate([s, t])
    order = np.argsort(at, kind="stable")
    nodes, is_old = np.concatenate([x, fresh])[order], order < len(x)
    is_new = ~is_old
    # Where an old and a new node are the same, one of them is both.
    twin = np.flatnonzero(np.diff(at[order]) <= 1e-9 * s[-1] / len(order))
    keep = np.ones(len(order), dtype=bool)
    for i in twin:
        is_old[i + 1] |= is_old[i]
        is_new[i + 1] |= is_new[i]
        keep[i] = False
    return nodes[keep], is_old[keep], is_new[keep]


def _mm(l: float) -> str:
    return f"{1e3 * l:.4g} mm"
