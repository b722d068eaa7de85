"""Thickness and ropelength of closed polygons, measured on the smooth curves of arcs that they stand for.

At every node an arc of a circle replaces the corner. It touches both edges at half the length of the shorter
one, which leaves a curve of straight lines and arcs with continuous tangent. Its reach, the radius of the
thickest tube around it, is the smaller of its smallest radius of curvature (Rawdon's MinRad of the polygon)
and half its smallest doubly critical distance (Litherland, Simon, Durumeric and Rawdon 1999; Cantarella,
Kusner and Sullivan 2002). Its length over its reach is therefore a true upper bound of the ropelength of its
knot, which the same quotient for the polygon is not: polygon and curve differ by terms of second order in the
edges, on either side.

Two points are doubly critical only if the curve turns by pi or more between them, both ways round: closed by
their chord, which meets it at right angles, it turns by at least 2 pi (Fenchel). Pairs with less turning
between them are left out; of all others the distance is bounded from below by that of chords less their
sagittas.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Bools, Floats, Ints
from torsade.curve import edge_lengths, tangents, turning_angles
from torsade.errors import TorsadeError
from torsade.segments import nearest_pair

__all__ = ["Thickness", "thickness"]

CHORDS = 8
"""Of an arc. With edges of a fifth of the radius they are within 1e-4 radii of it."""

PROBES = 150
"""Chords among which a first bound on the distance is sought."""


class Thickness(NamedTuple):
    """Of curves of arcs: length [m], radius h [m] of the thickest tube, and what limits it.

    `bend` is the smallest radius of curvature, `half_distance` half the smallest doubly critical distance;
    the radius is the smaller one.
    """

    length: float
    radius: float
    bend: float
    half_distance: float

    @property
    def ropelength(self) -> float:
        """L/h."""
        return self.length / self.radius


class _Chords(NamedTuple):
    """Chords of the curves of arcs: ends (n, 3), strand (n,), turning from node 0 to before and after
    (n,)."""

    p: Floats
    q: Floats
    strand: Ints
    before: Floats
    after: Floats
    whole: Floats


def thickness(strands: Sequence[ArrayLike], chords: int = CHORDS) -> Thickness:
    """Length and thickness of the curves of arcs inscribed in closed polygons, the thickness never too large.

    Args:
        strands: nodes [m] of each polygon, shapes (n, 3), the first not repeated.
        chords: in which each arc is divided; the more, the tighter the bound on the distance.

    Raises:
        TorsadeError: no strand, one of fewer than 3 nodes, an edge without length or folded back.

    A square of side 2 holds the unit circle:

    >>> square = [(1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0)]
    >>> print(f"{thickness([square]).ropelength / np.pi:.6f}")
    2.000000
    """
    if not len(strands):
        raise TorsadeError("there is no strand to measure; give at least one closed polygon")
    length, bend, sagitta = 0.0, np.inf, 0.0
    parts = []
    for k, x in enumerate(strands):
        found, least, worst, part = _arcs(np.asarray(x, dtype=np.float64), k, chords)
        length, bend, sagitta = length + found, min(bend, least), max(sagitta, worst)
        parts.append(part)
    c = _Chords(*(np.concatenate(field) for field in zip(*parts, strict=True)))

    def counts(i: Ints, j: Ints) -> Bools:
        between = c.after[j] - c.before[i]
        around = c.whole[i] - (c.before[j] - c.after[i])
        return np.asarray((c.strand[i] != c.strand[j]) | (np.minimum(between, around) >= np.pi - 1e-9))

    some = np.arange(0, len(c.p), max(1, len(c.p) // PROBES))
    i, j = np.meshgrid(some, some)
    distance, _, _ = nearest_pair(c.p, c.q, counts, (i.ravel(), j.ravel()))
    half = max(0.0, distance / 2 - sagitta)
    return Thickness(length, float(min(bend, half)), bend, half)


def _arcs(x: Floats, strand: int, chords: int) -> tuple[float, float, float, _Chords]:
    """Length, smallest radius and largest sagitta of the arcs of a polygon, and their chords with the
    lines."""
    t, l = tangents(x, True), edge_lengths(x, True)
    phi = turning_angles(x, True)
    before = np.roll(t, 1, axis=0)
    reach = np.minimum(np.roll(l, 1), l) / 2  # from a node to where its arc begins
    tangent = np.tan(phi / 2)
    if tangent.max() > 1e6:
        node = int(np.argmax(tangent))
        raise TorsadeError(f"strand {strand} folds straight back at node {node}; smooth it first")
    straight = phi < 1e-9
    safe = np.where(straight, 1.0, tangent)
    # reach/tan(phi/2) is the radius of an arc, infinite where the polygon is straight.
    turn = phi[:, None] * (np.arange(chords + 1) / chords)
    along = np.where(straight[:, None], 2 * np.arange(chords + 1) / chords, np.sin(turn) / safe[:, None])
    aside = np.where(straight[:, None], 0.0, (1 - np.cos(turn)) / safe[:, None])
    normal = t - np.cos(phi)[:, None] * before
    normal /= np.where(straight, 1.0, np.sin(phi))[:, None]
    p = (x - reach[:, None] * before)[:, None, :] + reach[:, None, None] * (
        along[:, :, None] * before[:, None, :] + aside[:, :, None] * normal[:, None, :]
    )
    arc = np.where(straight, 2.0, phi / safe) * reach
    length = float(l.sum() - 2 * reach.sum() + arc.sum())
    radius = np.where(straight, np.inf, reach / safe)
    sagitta = float((arc / chords * np.tan(phi / chords / 4) / 2).max())
    step = np.repeat(phi[:, None] / chords, chords + 1, axis=1)
    step[:, -1] = 0.0  # the line from an arc to the next
    after = np.cumsum(step)
    ends = p.reshape(-1, 3)
    beyond = np.roll(ends, -1, axis=0)
    used = np.sqrt(((beyond - ends) ** 2).sum(axis=1)) > 1e-12 * length
    found = _Chords(
        ends, beyond, np.full(len(ends), strand), after - step.ravel(), after, np.full(len(ends), after[-1])
    )
    return length, float(radius.min()), sagitta, _Chords(*(field[used] for field in found))
