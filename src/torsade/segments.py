"""Line segments in space: the distance of two, and the nearest pair among many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["nearest_pair", "segment_distance"]

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]

# Segments searched at a time. It bounds the memory: all pairs of this many with all others at worst.
_CHUNK = 256


def segment_distance(p0: ArrayLike, p1: ArrayLike, q0: ArrayLike, q1: ArrayLike) -> FloatArray:
    """Distance between the segments p0 p1 and q0 q1 [m], shape (...,), of points of shape (..., 3).

    Exact: two segments are nearest either at an end of one of them or, if their lines are skew,
    where both lines are crossed by their common perpendicular. All five cases are measured and the
    smallest taken, so nothing is lost when the segments are parallel, cross or are single points.
    """
    p0, p1, q0, q1 = (np.asarray(point, dtype=np.float64) for point in (p0, p1, q0, q1))
    p, q, r = p1 - p0, q1 - q0, p0 - q0
    pp, qq, pq, pr, qr = _dot(p, p), _dot(q, q), _dot(p, q), _dot(p, r), _dot(q, r)
    determinant = pp * qq - pq * pq
    safe = np.where(determinant > 0, determinant, 1.0)
    # Clipped to the segments, s and t give the distance of two of their points whatever happened
    # before; it is the smallest when the common perpendicular stands inside both.
    s, t = np.clip((pq * qr - qq * pr) / safe, 0, 1), np.clip((pp * qr - pq * pr) / safe, 0, 1)
    across = _norm(r + s[..., None] * p - t[..., None] * q)
    at_ends = np.minimum(
        np.minimum(_point_distance(p0, q0, q), _point_distance(p1, q0, q)),
        np.minimum(_point_distance(q0, p0, p), _point_distance(q1, p0, p)),
    )
    return np.minimum(across, at_ends)


def nearest_pair(
    p: FloatArray,
    q: FloatArray,
    counts: Callable[[IndexArray, IndexArray], NDArray[np.bool_]],
    probes: tuple[IndexArray, IndexArray],
) -> tuple[float, int, int]:
    """Find the nearest two of the segments p q, exactly; return their distance [m] and indices i < j.

    Args:
        p: first ends [m], shape (n, 3).
        q: second ends [m], shape (n, 3).
        counts: says for index arrays i < j which pairs count.
        probes: some pairs (i, j) of which at least one counts if any does. The nearer they are, the
            less there is to search.

    Returns:
        The distance, infinite when no pair counts, and the pair (-1, -1 then). Of equally near
        pairs the one with the smallest i, then j.
    """
    from scipy.spatial import cKDTree

    middle, l = (p + q) / 2, _norm(q - p)
    best = _nearest_of(p, q, counts, (np.inf, -1, -1), *probes)
    if not np.isfinite(best[0]):
        return best
    tree = cKDTree(middle)
    for start in range(0, len(p), _CHUNK):
        chunk = np.arange(start, min(start + _CHUNK, len(p)))
        # Middles are farther apart than their segments by at most the two half lengths. The slack
        # keeps pairs at the very edge from being lost to round-off.
        reach = (best[0] + (l[chunk].max() + l.max()) / 2) * (1 + 1e-12)
        near = cKDTree(middle[chunk]).sparse_distance_matrix(tree, reach, output_type="ndarray")
        i, j = chunk[near["i"]], near["j"].astype(np.intp)
        close = (i < j) & (near["v"] <= (best[0] + (l[i] + l[j]) / 2) * (1 + 1e-12))
        best = _nearest_of(p, q, counts, best, i[close], j[close])
    return best


def _nearest_of(
    p: FloatArray,
    q: FloatArray,
    counts: Callable[[IndexArray, IndexArray], NDArray[np.bool_]],
    best: tuple[float, int, int],
    i: IndexArray,
    j: IndexArray,
) -> tuple[float, int, int]:
    """The nearer of `best` and the nearest of the pairs (i, j) that count."""
    i, j = np.minimum(i, j), np.maximum(i, j)
    use = (i < j) & counts(i, j)
    i, j = i[use], j[use]
    if len(i) == 0:
        return best
    distance = segment_distance(p[i], q[i], p[j], q[j])
    first = np.lexsort((j, i, distance))[0]
    return min(best, (float(distance[first]), int(i[first]), int(j[first])))


def _point_distance(x: FloatArray, q0: FloatArray, q: FloatArray) -> FloatArray:
    """Distance from points x to the segments from q0 to q0 + q."""
    r, qq = x - q0, _dot(q, q)
    t = np.clip(_dot(r, q) / np.where(qq > 0, qq, 1.0), 0, 1)
    return _norm(r - t[..., None] * q)


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("...k,...k->...", a, b))


def _norm(a: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(_dot(a, a)))
