"""Where the edges of polylines cross in a view, found for all at once, or why the view is not clear."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.segments import segment_distance
from torsade.topology.polygons import Curves, polygons

__all__ = ["TOLERANCE", "Degenerate", "Polylines", "View", "cross_over", "polylines"]

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]

TOLERANCE = 1e-9
"""What counts as on a node, parallel or at the same place, in lengths of an edge; far above rounding."""

_CHUNK = 1 << 21
"""Pairs of edges looked at in one go: it bounds the memory."""


class Degenerate(Exception):  # noqa: N818
    """This view does not show how the curves lie."""


@dataclass(frozen=True)
class Polylines:
    """Polylines and all their edges in a row.

    Attributes:
        nodes: of each polyline, shapes (n, 3).
        closed: which are closed.
        first: nodes at which edges begin, shape (n_edges, 3).
        last: nodes at which they end, shape (n_edges, 3).
        strand: the polyline of each edge, shape (n_edges,).
        edge: its number there, shape (n_edges,).
        exponent: coordinates are in units of 2^exponent.
        what: what a polyline is called in messages.
    """

    nodes: tuple[FloatArray, ...]
    closed: tuple[bool, ...]
    first: FloatArray
    last: FloatArray
    strand: IndexArray
    edge: IndexArray
    exponent: int
    what: str

    def follow(self, i: IndexArray, j: IndexArray) -> BoolArray:
        """Whether of edges i < j one follows the other at a node."""
        near: BoolArray = j - i == 1
        for k, closed in enumerate(self.closed):
            if closed:
                at = np.flatnonzero(self.strand == k)
                near |= (i == at[0]) & (j == at[-1])
        near &= self.strand[i] == self.strand[j]
        return near

    def name(self, e: int) -> str:
        """An edge in words."""
        return f"edge {self.edge[e]} of {self.what} {self.strand[e]}"


@dataclass(frozen=True)
class View:
    """The crossings of polylines along a direction, in the order in which strands meet them.

    Arrays have a row for each crossing, and columns for the upper and the lower strand; `nodes` are those
    of all polylines in the plane of the view. Lengths are in the unit of the polylines.
    """

    strand: IndexArray
    edge: IndexArray
    parameter: FloatArray
    height: FloatArray
    sign: IndexArray
    nodes: tuple[FloatArray, ...]


def polylines(curves: Curves, closed: bool | Sequence[bool], what: str = "strand") -> Polylines:
    """Checked polylines, called `what` in messages.

    Raises:
        TorsadeError: as `polygons` does.
    """
    given = polygons(curves, closed, what, TOLERANCE)
    corners = [given.corners(k) for k in range(len(given.curves))]
    counts = [len(x) - 1 for x in corners]
    strand = np.repeat(np.arange(len(counts)), counts)
    edge = np.concatenate([np.arange(n) for n in counts])
    first, last = np.concatenate([x[:-1] for x in corners]), np.concatenate([x[1:] for x in corners])
    return Polylines(given.curves, given.closed, first, last, strand, edge, given.exponent, what)


def cross_over(lines: Polylines, axes: FloatArray) -> View:
    """The crossings seen along the third of three axes (rows of an orthonormal right-handed matrix).

    Raises:
        Degenerate: the view is not clear.
        TorsadeError: edges meet in space.
    """
    p, q = lines.first @ axes.T, lines.last @ axes.T
    r = q - p
    length = np.hypot(r[:, 0], r[:, 1])
    full = np.linalg.norm(r, axis=1)
    if (length <= TOLERANCE * full).any():
        raise Degenerate(f"{lines.name(int(np.argmin(length / full)))} is seen end on")
    found: list[tuple[IndexArray, ...]] = []
    s_parts, t_parts = [], []
    for i, j in _near(p[:, :2], q[:, :2]):
        s, t, crosses = _crossed(lines, p, r, length, i, j)
        found.append((i[crosses], j[crosses]))
        s_parts.append(s[crosses])
        t_parts.append(t[crosses])
    i, j = (np.concatenate(part) for part in zip(*found, strict=True))
    st = np.stack([np.concatenate(s_parts), np.concatenate(t_parts)], axis=1)
    ij = np.stack([i, j], axis=1)
    height = p[ij, 2] + st * r[ij, 2]
    touching = np.abs(height[:, 0] - height[:, 1]) <= TOLERANCE * full[ij].max(axis=1, initial=0.0)
    if touching.any():
        raise TorsadeError(_meeting(lines, *ij[int(np.argmax(touching))]))
    swap = height[:, 0] < height[:, 1]
    for column in (ij, st, height):
        column[swap] = column[swap, ::-1]
    upper, lower = r[ij[:, 0]], r[ij[:, 1]]
    sign = np.sign(upper[:, 0] * lower[:, 1] - upper[:, 1] * lower[:, 0]).astype(np.intp)
    order = _first_met(ij, st)
    ij, st, height, sign = ij[order], st[order], height[order], sign[order]
    cuts = np.cumsum([len(x) for x in lines.nodes])[:-1]
    nodes = tuple(np.split(np.concatenate(lines.nodes) @ axes[:2].T, cuts))
    return View(lines.strand[ij], lines.edge[ij], st, height, sign, nodes)


def _near(p: FloatArray, q: FloatArray) -> Iterator[tuple[IndexArray, IndexArray]]:
    """Pairs i < j of edges whose boxes overlap, some at a time: sorted along one axis and swept."""
    low, high = np.minimum(p, q), np.maximum(p, q)
    axis = int(np.argmax(np.ptp(low, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    low, high = low[order], high[order]
    count = np.searchsorted(low[:, axis], high[:, axis], side="right") - np.arange(1, len(p) + 1)
    total = np.concatenate([[0], np.cumsum(count)])
    begin = 0
    while begin < len(p):
        end = max(begin + 1, int(np.searchsorted(total, total[begin] + _CHUNK, side="right")) - 1)
        i = np.repeat(np.arange(begin, end), count[begin:end])
        j = i + 1 + np.arange(len(i)) - np.repeat(total[begin:end] - total[begin], count[begin:end])
        other = 1 - axis
        overlap = (low[i, other] <= high[j, other]) & (low[j, other] <= high[i, other])
        a, b = order[i[overlap]], order[j[overlap]]
        yield np.minimum(a, b), np.maximum(a, b)
        begin = end


def _crossed(
    lines: Polylines, p: FloatArray, r: FloatArray, length: FloatArray, i: IndexArray, j: IndexArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Parameters along edges i and j where they cross in the view, and whether they do."""
    a, b, c = r[i], r[j], p[j] - p[i]
    det = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    size = length[i] * length[j]
    parallel = np.abs(det) <= TOLERANCE * size
    follow = lines.follow(i, j)
    safe = np.where(parallel, 1.0, det)
    s = (c[:, 0] * b[:, 1] - c[:, 1] * b[:, 0]) / safe
    t = (c[:, 0] * a[:, 1] - c[:, 1] * a[:, 0]) / safe
    near = (np.minimum(s, t) >= -TOLERANCE) & (np.maximum(s, t) <= 1 + TOLERANCE) & ~parallel & ~follow
    inside = (np.minimum(s, t) > TOLERANCE) & (np.maximum(s, t) < 1 - TOLERANCE) & near
    off = np.abs(c[:, 0] * a[:, 1] - c[:, 1] * a[:, 0]) / length[i]
    back = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] < 0
    on_line = parallel & (off <= TOLERANCE * np.maximum(length[i], length[j]))
    unclear = near & ~inside | on_line & (back | ~follow) & _overlap(a, b, c, length[i])
    if unclear.any():
        e, f = i[unclear], j[unclear]
        apart = segment_distance(lines.first[e], lines.last[e], lines.first[f], lines.last[f])
        meeting = (apart <= TOLERANCE * np.maximum(length[e], length[f])) & ~lines.follow(e, f)
        folded = lines.follow(e, f) & _folded(lines, e, f)
        if (meeting | folded).any():
            k = int(np.argmax(meeting | folded))
            raise TorsadeError(_meeting(lines, int(e[k]), int(f[k])))
        k = int(np.argmax(unclear))
        raise Degenerate(f"{lines.name(int(i[k]))} and {lines.name(int(j[k]))} touch or overlap")
    return s, t, inside


def _overlap(a: FloatArray, b: FloatArray, c: FloatArray, length: FloatArray) -> BoolArray:
    """Whether edges on one line have a stretch in common, or a point."""
    u = a[:, :2] / length[:, None]
    begin = np.einsum("ij,ij->i", c[:, :2], u)
    end = begin + np.einsum("ij,ij->i", b[:, :2], u)
    slack = TOLERANCE * length
    low, high = np.minimum(begin, end), np.maximum(begin, end)
    overlap: BoolArray = (low <= length + slack) & (high >= -slack)
    return overlap


def _folded(lines: Polylines, e: IndexArray, f: IndexArray) -> BoolArray:
    """Whether edges that follow each other lie on each other in space."""
    a, b = lines.last[e] - lines.first[e], lines.last[f] - lines.first[f]
    size = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    folded: BoolArray = np.einsum("ij,ij->i", a, b) <= -(1 - TOLERANCE**2) * size
    return folded


def _first_met(ij: IndexArray, st: FloatArray) -> IndexArray:
    """The order in which crossings are met along the strands; refuses two at one point of an edge."""
    n = len(ij)
    edge, along = ij.ravel(), st.ravel()
    order = np.lexsort((along, edge))
    e, x = edge[order], along[order]
    if ((e[1:] == e[:-1]) & (x[1:] - x[:-1] <= TOLERANCE)).any():
        raise Degenerate("three strands meet in a point")
    _, first = np.unique(order // 2, return_index=True)
    return np.argsort(first, kind="stable") if n else np.arange(0)


def _meeting(lines: Polylines, e: int, f: int) -> str:
    return f"{lines.name(e)} and {lines.name(f)} meet in space; move them apart"
