"""The shape of fibers at the start: `Centerline`, and the check before a run."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from torsade import curve
from torsade.errors import TorsadeError

__all__ = ["Centerline", "check"]

FloatArray = NDArray[np.float64]

SHORTEST = 5.0
"""Shortest fiber, in diameters 2h: shorter ones are not slender, and no rod theory holds."""

LONGEST_EDGE = 1.0
"""Longest edge, in diameters 2h: a strand could slip between nodes farther apart."""

SHARPEST_TURN = 2 * math.pi / 3
"""Sharpest turn at a node [rad]: an axis bent no tighter than h turns by 60 degrees over an edge of
length h; beyond twice that the fiber folds back on itself and its curvature has no meaning."""

LEAST_CLEARANCE = 1 / 3
"""Smallest distance of two axes, in diameters 2h.

Centerlines of real knots overlap a little and must pass: of those published with the thesis one comes
as near as 0.52, the others to between 0.63 and 0.93. Below 1/4 the polyline no longer tells which
strand is on which side: an edge of length 2h on an axis of curvature 1/h departs from it by h/2. A
third stands between. There the compression is 0.67, and the contact potential, fitted up to 0.15, is
all stiffening: its linear part makes 2 % of the force.
"""


@dataclass(frozen=True, eq=False)
class Centerline:
    """The axes of one or several fibers.

    Attributes:
        strands: nodes [m] of each strand, shapes (n, 3), kept as read-only copies.
        closed: which strands are closed; the first node is not repeated. All open by default.

    Raises:
        TorsadeError: no strand, a strand that is not of shape (n, 3), or a wrong number of flags.
    """

    strands: tuple[FloatArray, ...]
    closed: tuple[bool, ...] = field(default=())

    def __post_init__(self) -> None:
        strands = tuple(np.array(x, dtype=np.float64, order="C") for x in self.strands)
        if not strands:
            raise TorsadeError("a centerline has no strand; give at least one, of shape (n, 3)")
        for k, x in enumerate(strands):
            if x.ndim != 2 or x.shape[1] != 3:
                raise TorsadeError(f"strand {k} has nodes of shape {x.shape}; give (n, 3), in metres")
            x.flags.writeable = False
        closed = tuple(bool(c) for c in self.closed) or (False,) * len(strands)
        if len(closed) != len(strands):
            raise TorsadeError(f"{len(strands)} strands have {len(closed)} closed flags; give one for each")
        object.__setattr__(self, "strands", strands)
        object.__setattr__(self, "closed", closed)


def check(centerline: Centerline, radius: float) -> None:
    """Raise TorsadeError, saying where, unless a fiber of this radius h [m] can lie along the centerline.

    Refused are nodes that are not finite, strands of fewer than 2 nodes (3 when closed), repeated
    nodes, fibers shorter than `SHORTEST` diameters, edges longer than `LONGEST_EDGE` diameters, turns
    sharper than `SHARPEST_TURN`, and axes nearer than `LEAST_CLEARANCE` diameters, on two strands or
    on parts of one that are more than pi h apart along it.
    """
    if not 0 < radius < math.inf:
        raise TorsadeError(f"the fiber's radius is {radius!r} m; give a finite length above 0")
    for k, (x, closed) in enumerate(zip(centerline.strands, centerline.closed, strict=True)):
        _check_nodes(k, x, closed)
        _check_edges(k, x, closed, 2 * radius)
    _check_clearance(centerline, radius)


def _check_nodes(k: int, x: FloatArray, closed: bool) -> None:
    least = 3 if closed else 2
    if len(x) < least:
        nodes = "only one node" if len(x) == 1 else f"{len(x)} nodes"
        raise TorsadeError(f"strand {k} has {nodes}; give at least {least}")
    finite = np.isfinite(x).all(axis=1)
    if not finite.all():
        i = int(np.argmin(finite))
        raise TorsadeError(f"node {i} of strand {k} is {_position(x[i])}; give finite coordinates, in metres")


def _check_edges(k: int, x: FloatArray, closed: bool, diameter: float) -> None:
    with np.errstate(over="ignore"):  # coordinates of 1e300 give infinite edges, refused below
        l = curve.edge_lengths(x, closed)
    # A millionth of the diameter is far below any resolution that resolves the fiber.
    if l.min() < 1e-6 * diameter:
        i = int(np.argmin(l))
        j = (i + 1) % len(x)
        raise TorsadeError(
            f"nodes {i} and {j} of strand {k} are the same point, {_position(x[i])}; remove one of them"
        )
    longest = LONGEST_EDGE * diameter
    if l.max() > longest * (1 + 1e-9):
        i = int(np.argmax(l))
        raise TorsadeError(
            f"edge {i} of strand {k} is {_mm(l[i])} long, more than the fiber's diameter {_mm(longest)}, and "
            "strands could slip through it; resample it, or give the unit that x, y, z have (--length-unit)"
        )
    if l.sum() < SHORTEST * diameter:
        raise TorsadeError(
            f"strand {k} is {_mm(l.sum())} long; give at least {SHORTEST:g} diameters, "
            f"{_mm(SHORTEST * diameter)} for a fiber {_mm(diameter)} thick"
        )
    phi = curve.turning_angles(x, closed)
    if phi.size and phi.max() > SHARPEST_TURN:
        i = int(np.argmax(phi)) + (0 if closed else 1)
        raise TorsadeError(
            f"strand {k} turns by {np.rad2deg(phi.max()):.0f} degrees at node {i}, {_position(x[i])}; "
            f"smooth or resample it (--smooth) to at most {math.degrees(SHARPEST_TURN):.0f} degrees"
        )


def _check_clearance(centerline: Centerline, radius: float) -> None:
    near = curve.clearance(centerline.strands, centerline.closed, math.pi * radius)
    least = LEAST_CLEARANCE * 2 * radius
    if near.distance >= least:
        return
    (a, b), (i, j) = near.strands, near.edges
    x = centerline.strands[a]
    who = f"strands {a} and {b} interpenetrate" if a != b else f"strand {a} passes through itself"
    raise TorsadeError(
        f"{who}: the axes are {_mm(near.distance)} apart at edges {i} and {j}, near {_position(x[i])}, and a "
        f"fiber {_mm(2 * radius)} thick needs at least {_mm(least)}; move them apart or give a smaller radius"
    )


def _position(x: FloatArray) -> str:
    return "(" + ", ".join(f"{c:.6g}" for c in x) + ") m"


def _mm(l: float) -> str:
    return f"{1e3 * l:.4g} mm"
