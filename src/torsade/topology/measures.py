"""Linking number, writhe and average crossing number of polygons, open or closed, exactly.

All three are sums of the Gauss integral over pairs of edges, which `torsade.topology.gauss` has in closed
form: nothing is sampled, and the only error is round-off. Crossings are positive when right-handed. Curves
are nodes of shape (n, 3), in any unit; one curve or a sequence of curves.

Thesis (4.14), (4.15) with C all the curves together: over two different curves the double integral counts
their every pair of edges twice. So the writhe of several curves is the sum of their own writhes and of
twice their Gauss integrals, as the mean over all projections of the sum of all crossing signs is (4.18).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from torsade.arrays import Bools, Floats, Ints
from torsade.errors import TorsadeError
from torsade.segments import nearest_pair
from torsade.topology import gauss
from torsade.topology.polygons import Curves, Polygons, polygons

__all__ = ["average_crossing_number", "linking", "writhe", "writhe_density", "writhe_matrix"]

TOUCHING = 1e-9
"""Edges nearer than this fraction of their lengths touch: on which side they pass is lost in round-off."""

WORTH_THREADS = 1_000_000
"""Pairs from which on threads take less time than it takes to start them."""


def linking(curves: Curves, closed: bool | Sequence[bool], threads: int | None = None) -> Floats:
    """Gauss linking number of every pair of curves, shape (n_curves, n_curves), zero on the diagonal.

    (4.14): Lk = 1/(4 pi) ∫∫ (t1 × t2) . (r1 - r2)/|r1 - r2|^3 ds1 ds2. Of closed curves it is a whole number
    up to round-off, half the sum of the signs of their mutual crossings in any diagram. Of open curves it
    is any number: half the mean sum of signs over all projections.

    Args:
        curves: nodes, shapes (n, 3).
        closed: whether the last node joins the first, for all curves or for each.
        threads: how many to use at most; the numbers are the same to the bit. By default as many as there
            are processors, where there is work for them.

    Raises:
        TorsadeError: two curves touch, or input that `polygons` refuses.
    """
    return _matrices(polygons(curves, closed), threads, selves=False).signed


def writhe_matrix(curves: Curves, closed: bool | Sequence[bool], threads: int | None = None) -> Floats:
    """Writhe of every curve on the diagonal, Gauss linking of every pair beside it; their sum is the writhe.

    Shape (n_curves, n_curves), symmetric. Arguments and errors are those of `writhe`.
    """
    return _matrices(polygons(curves, closed), threads).signed


def writhe(curves: Curves, closed: bool | Sequence[bool], threads: int | None = None) -> float:
    """Writhe Wr of one curve, or of several: the sum of their own writhes and of twice their linkings.

    (4.15): Wr = 1/(4 pi) ∫∫ (t × t') . (r - r')/|r - r'|^3 ds ds', over all the curves. It is the mean sum of
    crossing signs over all projections (4.18). Edges that share a node, and those in one plane, add nothing.

    Args:
        curves: nodes, shapes (n, 3).
        closed: whether the last node joins the first, for all curves or for each.
        threads: how many to use at most; see `linking`.

    Raises:
        TorsadeError: two edges touch that do not share a node, or input that `polygons` refuses.
    """
    return float(writhe_matrix(curves, closed, threads).sum())


def average_crossing_number(
    curves: Curves, closed: bool | Sequence[bool], threads: int | None = None
) -> float:
    """Number of crossings in the mean over all projections, ACN: `writhe` with every sign taken as plus."""
    return float(_matrices(polygons(curves, closed), threads).unsigned.sum())


def writhe_density(curves: Curves, closed: bool | Sequence[bool], threads: int | None = None) -> Floats:
    """What each edge adds to the writhe; shape (n_edges of all curves,), in order. Their sum is the writhe.

    Each of two edges has half of what they add together. Divided by the lengths of the edges it is the
    density along the curve, ∫ Wr(s, s') ds' of thesis chapter 4 over 4 pi. Arguments and errors are those
    of `writhe`.
    """
    p = polygons(curves, closed)
    s = _pack(p)
    density = np.zeros(s.first[-1])
    for a in range(len(p.curves)):
        for block in [_before(s, a), *(_block(s, a, b) for b in range(len(p.curves)))]:
            density[s.first[a] : s.first[a + 1]] -= _row_sums(s, block, threads)[:, 0] / (2 * np.pi)
    return density


class _Packed(NamedTuple):
    """All curves in the arrays that kernels take.

    Edge k joins nodes k and k + 1. Curve a has the edges from start[a] to before start[a] + n_edges; the edge
    after them joins it to the next curve and is never used. first counts the edges in use.
    """

    nodes: Floats
    edges: Floats
    start: Ints
    first: Ints
    closed: tuple[bool, ...]

    def rows(self, a: int) -> tuple[int, int]:
        """The first edge of curve a, and the one after its last."""
        return int(self.start[a]), int(self.start[a + 1] - 1)


class _Block(NamedTuple):
    """Pairs of every edge offset + r with the edges from begin[r] to before end[r]."""

    offset: int
    begin: Ints
    end: Ints


def _pack(p: Polygons) -> _Packed:
    corners = [p.corners(k) for k in range(len(p.curves))]
    nodes = np.ascontiguousarray(np.concatenate(corners).T)
    e = np.diff(nodes, axis=1)
    edges = np.concatenate([e, (e * e).sum(axis=0)[None]])
    count = np.array([len(c) for c in corners])
    return _Packed(nodes, edges, np.cumsum([0, *count]), np.cumsum([0, *(count - 1)]), p.closed)


def _block(s: _Packed, a: int, b: int) -> _Block:
    """Pairs of the edges of curve a with those of curve b, or with later ones of its own: each pair once."""
    first, last = s.rows(a)
    start, stop = s.rows(b)
    end = np.full(last - first, stop)
    if a != b:
        return _Block(first, np.full(last - first, start), end)
    end[0] -= s.closed[a]  # the last edge meets the first
    return _Block(first, np.minimum(np.arange(first, last) + 2, end), end)


def _before(s: _Packed, a: int) -> _Block:
    """Pairs of the edges of curve a with earlier ones of its own."""
    first, last = s.rows(a)
    begin = np.full(last - first, first)
    begin[-1] += s.closed[a]
    return _Block(first, begin, np.maximum(np.arange(first, last) - 1, begin))


class _Matrices(NamedTuple):
    """Gauss integral over 4 pi of every two curves, and that of its size; shapes (n_curves, n_curves)."""

    signed: Floats
    unsigned: Floats


def _matrices(p: Polygons, threads: int | None, selves: bool = True) -> _Matrices:
    """Sum over the pairs of edges of every two curves; of each with itself too if selves says so."""
    s, count = _pack(p), len(p.curves)
    found = _Matrices(np.zeros((count, count)), np.zeros((count, count)))
    for a in range(count):
        for b in range(a + (not selves), count):
            signed, unsigned = _row_sums(s, _block(s, a, b), threads).sum(axis=0)
            turns = np.pi if a == b else 2 * np.pi
            found.signed[a, b] = found.signed[b, a] = (0.0 - signed) / turns  # no minus zero
            found.unsigned[a, b] = found.unsigned[b, a] = unsigned / turns
    return found


def _row_sums(s: _Packed, block: _Block, threads: int | None) -> Floats:
    """Sums of Omega/2 and of |Omega|/2 over every row of a block, shape (n_rows, 2)."""
    rows = len(block.begin)
    sums, suspects = np.zeros((rows, 2)), np.zeros(rows, np.int64)

    def work(first: int, last: int) -> None:
        gauss.row_sums(s.nodes, s.edges, *block, first, last, sums, suspects)

    workers = _threads(threads, int((block.end - block.begin).sum()))
    if workers == 1:
        work(0, rows)
    else:
        share = gauss.ROWS * max(1, rows // (16 * workers * gauss.ROWS))
        starts = range(0, rows, share)
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, starts, [min(rows, first + share) for first in starts]))
    if suspects.any():
        _refuse_touching(s, block, int(np.argmax(suspects > 0)))
    return sums


def _threads(asked: int | None, pairs: int) -> int:
    if asked is not None and asked < 1:
        raise TorsadeError(f"{asked} threads cannot work; give at least 1, or None for all processors")
    return (asked or os.cpu_count() or 1) if pairs >= WORTH_THREADS else 1


def _refuse_touching(s: _Packed, block: _Block, suspect: int) -> None:
    """Find the nearest two edges of a block, and refuse them if they touch; suspect is a row where some may.

    Raises:
        TorsadeError: they touch.
    """
    begin = np.zeros(s.edges.shape[1], np.int64)
    end = begin.copy()
    rows = slice(block.offset, block.offset + len(block.begin))
    begin[rows], end[rows] = block.begin, block.end
    used = np.concatenate([np.arange(*s.rows(a)) for a in range(len(s.closed))])

    def counts(i: Ints, j: Ints) -> Bools:
        first, second = used[i], used[j]
        return np.asarray((begin[first] <= second) & (second < end[first]))

    x = s.nodes.T[used], s.nodes.T[used + 1]
    row = np.flatnonzero(used == block.offset + suspect)
    columns = np.flatnonzero((used >= block.begin[suspect]) & (used < block.end[suspect]))
    distance, i, j = nearest_pair(*x, counts, (np.repeat(row, len(columns)), columns))
    lengths = float(np.sqrt(s.edges[3, used[[i, j]]]).sum())
    if distance <= TOUCHING * lengths:
        a, b = (int(np.searchsorted(s.first, k, side="right")) - 1 for k in (i, j))
        raise TorsadeError(
            f"edge {i - s.first[a]} of curve {a} and edge {j - s.first[b]} of curve {b} touch, so that the "
            "sign of their crossing is lost; move them apart"
        )
