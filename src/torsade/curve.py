"""Polylines: arclength, resampling, smoothing, curvature, frames and clearance.

A polyline is an array of nodes `x` [m], shape (n, 3). Open, it has n - 1 edges, and edge i joins
nodes i and i + 1. Closed, it has n edges: the last joins node n - 1 to node 0, which is not repeated.
Hinges are the nodes where two edges meet: nodes 1 ... n - 2 when open, all n when closed.

Every function is pure and expects finite numbers; user input is judged in `torsade.centerline`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.errors import TorsadeError
from torsade.segments import nearest_pair, segment_distance
from torsade.spline import ArclengthSpline

__all__ = [
    "Clearance",
    "Frames",
    "arclength",
    "clearance",
    "curvature",
    "edge_lengths",
    "edge_vectors",
    "length",
    "perpendicular",
    "resample",
    "rotation_minimising_frames",
    "segment_distance",
    "smooth",
    "tangents",
    "turning_angles",
]

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]
_MOST_NODES = 10_000_000
Method = Literal["linear", "cubic"]


def edge_vectors(x: ArrayLike, closed: bool = False) -> FloatArray:
    """Edge vectors [m], shape (n - 1, 3) open or (n, 3) closed, of nodes `x` [m], shape (n, 3).

    Raises:
        TorsadeError: not of shape (n, 3), or fewer than 2 nodes (3 when closed).
    """
    x = _nodes(x, closed)
    return np.roll(x, -1, axis=0) - x if closed else np.diff(x, axis=0)


def edge_lengths(x: ArrayLike, closed: bool = False) -> FloatArray:
    """Edge lengths [m], shape (n - 1,) open or (n,) closed."""
    return _norm(edge_vectors(x, closed))


def tangents(x: ArrayLike, closed: bool = False) -> FloatArray:
    """Unit tangents of the edges, shape (n - 1, 3) open or (n, 3) closed.

    Raises:
        TorsadeError: an edge has no length.
    """
    e = edge_vectors(x, closed)
    return e / _positive_lengths(_norm(e))[:, None]


def arclength(x: ArrayLike, closed: bool = False) -> FloatArray:
    """Arclength of the nodes from node 0 [m], shape (n,); the closing edge is not part of it."""
    l = edge_lengths(x, closed)
    return np.concatenate([[0.0], np.cumsum(l[:-1] if closed else l)])


def length(x: ArrayLike, closed: bool = False) -> float:
    """Total length [m], the closing edge included."""
    return float(edge_lengths(x, closed).sum())


def turning_angles(x: ArrayLike, closed: bool = False) -> FloatArray:
    """Angles phi between successive tangents [rad], from 0 to pi, shape (n - 2,) open or (n,) closed."""
    before, after = _tangents_at_hinges(x, closed)
    return 2 * np.arctan2(_norm(after - before), _norm(after + before))


def curvature(x: ArrayLike, closed: bool = False) -> FloatArray:
    """Curvature kappa = 2 tan(phi/2)/lbar at the hinges [1/m], shape (n - 2,) open or (n,) closed.

    lbar is the mean length of the two edges. This is the curvature of discrete elastic rods: it grows
    without bound as a hinge folds over (phi → pi), where it is infinite or very large.
    """
    before, after = _tangents_at_hinges(x, closed)
    l = edge_lengths(x, closed)
    lbar = (np.roll(l, 1) + l) / 2 if closed else (l[:-1] + l[1:]) / 2
    with np.errstate(divide="ignore"):
        kappa: FloatArray = 2 * _norm(after - before) / _norm(after + before) / lbar
    return kappa


def perpendicular(t: ArrayLike) -> FloatArray:
    """Unit vectors perpendicular to `t`, same shape (..., 3).

    Each is t × e, with e the coordinate axis farthest from t: a fixed choice, not a continuous one.

    Raises:
        TorsadeError: a vector is zero.
    """
    t = np.asarray(t, dtype=np.float64)
    e = np.zeros_like(t)
    np.put_along_axis(e, np.argmin(np.abs(t), axis=-1)[..., None], 1.0, axis=-1)
    u = np.cross(t, e)
    size = _norm(u)
    if not np.all(size > 0):
        raise TorsadeError("a zero vector has no perpendicular; give vectors of positive length")
    return u / size[..., None]


class Frames(NamedTuple):
    """Orthonormal right-handed frames (u, v, t) on the edges, each of shape (number of edges, 3).

    `holonomy` [rad], in (-pi, pi], is the angle about the first tangent from u[0] to what u[0]
    becomes when it is carried once round a closed curve; it is 0 for an open one.
    """

    t: FloatArray
    u: FloatArray
    v: FloatArray
    holonomy: float


def rotation_minimising_frames(x: ArrayLike, closed: bool = False, u0: ArrayLike | None = None) -> Frames:
    """Frames that turn about the tangent as little as possible: parallel transport from edge to edge.

    Also known as Bishop frames. On a closed curve of writhe Wr they come back turned by
    2 pi Wr (mod 2 pi), exactly so for polygons.

    Args:
        x: nodes [m], shape (n, 3).
        closed: whether the last node joins the first.
        u0: first director, shape (3,); only its part perpendicular to the first edge counts.

    Raises:
        TorsadeError: an edge has no length or folds straight back, or `u0` is along the first edge.
    """
    t = tangents(x, closed)
    # Any perpendicular field a will do: carry each a to the next edge, note the angle by which it
    # arrives ahead of the a found there, and the frame that does not turn is a turned by their sum.
    a = perpendicular(t)
    b = np.cross(t, a)
    count = len(t) if closed else len(t) - 1
    next_t, next_a, next_b = (np.roll(field, -1, axis=0)[:count] for field in (t, a, b))
    carried = _transport(a[:count], t[:count], next_t)
    ahead = np.arctan2(_dot(carried, next_b), _dot(carried, next_a))
    total = np.concatenate([[0.0], np.cumsum(ahead)])
    angle = total[: len(t)] + _angle_of(u0, t[0], a[0], b[0])
    u = a * np.cos(angle)[:, None] + b * np.sin(angle)[:, None]
    holonomy = float(np.pi - (np.pi - total[-1]) % (2 * np.pi)) if closed else 0.0
    return Frames(t, u, np.cross(t, u), holonomy)


def _transport(u: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
    """Turn `u`, perpendicular to `before`, by the smallest rotation that takes `before` to `after`."""
    c = 1 + _dot(before, after)
    if np.any(c < 1e-12):
        edge = int(np.argmin(c))
        raise TorsadeError(
            f"the curve folds straight back after edge {edge}, where no frame can follow; smooth it first"
        )
    carried: FloatArray = u - (_dot(u, after) / c)[:, None] * (before + after)
    return carried


def _angle_of(u0: ArrayLike | None, t: FloatArray, a: FloatArray, b: FloatArray) -> float:
    """Angle of `u0` about t from a, which with b spans the plane perpendicular to t."""
    if u0 is None:
        return 0.0
    u = np.asarray(u0, dtype=np.float64)
    along_a, along_b = float(u @ a), float(u @ b)
    if not np.hypot(along_a, along_b) > 1e-12 * np.linalg.norm(u):
        raise TorsadeError(f"u0 = {u0} is along the first edge, {t}; give a direction across it")
    return float(np.arctan2(along_b, along_a))


def resample(
    x: ArrayLike,
    *,
    n: int | None = None,
    spacing: float | None = None,
    closed: bool = False,
    method: Method = "cubic",
) -> FloatArray:
    """Nodes spread evenly in arclength along the curve through `x` [m]; shape (n, 3).

    The first node, and the last of an open curve, are kept to the last bit.

    Args:
        x: nodes [m], shape (m, 3), of one polyline.
        n: number of new nodes; or
        spacing: greatest distance between them along the curve [m]: the edges are the fewest that do.
        closed: whether the last node joins the first.
        method: "cubic" runs a C2 cubic spline through the nodes, periodic when closed (its chords
            are then shorter than the even spacing by a fraction (spacing * kappa)^2/24); "linear"
            stays on the polyline and cuts its corners.

    Raises:
        TorsadeError: both or neither of n and spacing, too few nodes, an edge without length.
    """
    x = _nodes(x, closed)
    _positive_lengths(edge_lengths(x, closed))
    knots = np.concatenate([x, x[:1]]) if closed else x
    parameter = np.concatenate([[0.0], np.cumsum(edge_lengths(knots))])
    # Two nodes are a straight line; the spline adds nothing to it.
    path = ArclengthSpline(knots, parameter, closed) if method == "cubic" and len(knots) > 2 else None
    s = path.arclength if path else parameter
    edges = _edge_count(n, spacing, closed, float(s[-1]))
    target = np.linspace(0.0, s[-1], edges + 1)
    new = path.at(target) if path else np.stack([np.interp(target, s, c) for c in knots.T], axis=1)
    new[0], new[-1] = knots[0], knots[-1]
    return new[:-1] if closed else new


def _edge_count(n: int | None, spacing: float | None, closed: bool, total: float) -> int:
    if (n is None) == (spacing is None):
        raise TorsadeError("resampling needs either the number of nodes n or their spacing; give one of them")
    least = 3 if closed else 1
    if spacing is not None:
        if not 0 < spacing < np.inf:
            raise TorsadeError(f"the spacing of nodes cannot be {spacing}; give a length above 0 [m]")
        # The slack keeps a curve resampled at its own spacing from gaining a node by round-off.
        edges = max(least, np.ceil(total / spacing * (1 - 1e-9)))
    else:
        edges = (n or 0) - (0 if closed else 1)
    if not least <= edges <= _MOST_NODES:
        kind = "a closed" if closed else "an open"
        raise TorsadeError(
            f"{kind} curve cannot have {edges:.0f} edges; ask for {least} to {_MOST_NODES} by n or spacing"
        )
    return int(edges)


def smooth(x: ArrayLike, scale: float, closed: bool = False, lengths: ArrayLike | None = None) -> FloatArray:
    """Smooth away what is shorter than `scale`; shape (n, 3), ends kept to the last bit.

    Minimises the sum of |y - x|^2 + scale^4 |y''|^2 over arclength: a wave of wave number k is
    reduced by 1 + (k scale)^4, so long waves stay and waves shorter than 2 pi scale go. A circle of
    radius R shrinks by 1 + (scale/R)^4.

    Args:
        x: nodes [m], shape (n, 3).
        scale: smoothing length [m]; 0 changes nothing.
        closed: whether the last node joins the first.
        lengths: of the edges [m], shape (n - 1,) open or (n,) closed, where arclength is known better than
            along x: noise makes edges longer than the curve is.

    Raises:
        TorsadeError: `scale` negative or not finite, an edge without length, or a wrong number of lengths.
    """
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import spsolve

    x = _nodes(x, closed)
    if not 0 <= scale < np.inf:
        raise TorsadeError(f"the smoothing length cannot be {scale}; give a length of at least 0 [m]")
    n = len(x)
    if scale == 0 or n < 3:
        return x.copy()
    l = edge_lengths(x, closed)
    if lengths is not None and np.shape(lengths) != l.shape:
        raise TorsadeError(f"{len(l)} edges have lengths of shape {np.shape(lengths)}; give one for each")
    l = _positive_lengths(l if lengths is None else np.asarray(lengths, dtype=np.float64))
    hinge = np.arange(n) if closed else np.arange(1, n - 1)
    before, after = l[hinge - 1], l[hinge % len(l)]
    lbar = (before + after) / 2
    # y'' at a hinge is the difference of the slopes after and before it, over the length between.
    columns = np.concatenate([hinge - 1, hinge, hinge + 1]) % n
    entries = np.concatenate([1 / before, -(1 / before + 1 / after), 1 / after]) / np.tile(lbar, 3)
    rows = np.tile(np.arange(len(hinge)), 3)
    second = csc_array((entries, (rows, columns)), shape=(len(hinge), n))
    weight = diags_array(scale**4 * lbar)
    # Solve for the change y - x of the hinges alone: ends cannot move, straight lines stay exactly.
    load = -(second[:, hinge].T @ (weight @ (second @ x)))
    system = csc_array(second[:, hinge].T @ weight @ second[:, hinge] + diags_array(lbar))
    y = x.copy()
    y[hinge] += np.asarray(spsolve(system, load))
    return y


class Clearance(NamedTuple):
    """The nearest approach of edges that are not neighbours; infinite, with indices -1, if none are."""

    distance: float
    strands: tuple[int, int]
    edges: tuple[int, int]


def clearance(strands: Sequence[ArrayLike], closed: Sequence[bool], exclusion_length: float) -> Clearance:
    """Smallest distance between edges of different strands, or far apart along one.

    Args:
        strands: nodes [m] of each strand, shapes (n, 3).
        closed: which strands are closed.
        exclusion_length: edges of one strand count only if more than this arclength [m] lies
            between them, the shorter way round. An axis that bends no tighter than the fiber's
            radius h needs an arc of pi h to come back within 2h of itself: a natural choice.

    Returns:
        The distance between the axes [m] (a fiber of radius h touches itself at 2h), and which
        edges of which strands attain it.

    Raises:
        TorsadeError: no strand, or one of the wrong shape or too few nodes; a negative exclusion.
    """
    if not exclusion_length >= 0:
        raise TorsadeError(f"the exclusion cannot be {exclusion_length}; give a length of at least 0 [m]")
    if len(strands) == 0:
        raise TorsadeError("there is no strand to find the clearance of; give at least one")
    e = [edge_vectors(x, c) for x, c in zip(strands, closed, strict=True)]
    s = [np.concatenate([[0.0], np.cumsum(_norm(edges))]) for edges in e]
    p = [np.asarray(x, dtype=np.float64)[: len(edges)] for x, edges in zip(strands, e, strict=True)]
    first = np.cumsum([0, *(len(edges) for edges in e)])  # where the edges of each strand begin
    strand = np.repeat(np.arange(len(e)), np.diff(first))
    begin, end = np.concatenate([k[:-1] for k in s]), np.concatenate([k[1:] for k in s])
    way_round = np.array([k[-1] if c else np.inf for k, c in zip(s, closed, strict=True)])[strand]

    def far(i: IndexArray, j: IndexArray) -> NDArray[np.bool_]:
        between = np.minimum(begin[j] - end[i], way_round[i] - end[j] + begin[i])
        return np.asarray((strand[i] != strand[j]) | (between > exclusion_length))

    all_p = np.concatenate(p)
    probes = _probes([x + edges / 2 for x, edges in zip(p, e, strict=True)], s, first, exclusion_length)
    distance, i, j = nearest_pair(all_p, all_p + np.concatenate(e), far, probes)
    if i < 0:
        return Clearance(distance, (-1, -1), (-1, -1))
    a, b = int(strand[i]), int(strand[j])
    return Clearance(distance, (a, b), (i - int(first[a]), j - int(first[b])))


def _probes(
    middle: list[FloatArray], s: list[FloatArray], first: IndexArray, exclusion: float
) -> tuple[IndexArray, IndexArray]:
    """Pairs of edges likely to be near: just beyond the exclusion, and neighbours on the next strand."""
    from scipy.spatial import cKDTree

    i, j = [], []
    for k, (x, at) in enumerate(zip(middle, s, strict=True)):
        beyond = np.searchsorted(at[:-1], at[1:] + exclusion, side="right")
        for step in (0, 1):  # round-off may leave the first edge beyond just inside
            i.append(first[k] + np.arange(len(x)))
            j.append(first[k] + np.minimum(beyond + step, len(x) - 1))
        if k > 0:
            i.append(first[k - 1] + np.asarray(cKDTree(middle[k - 1]).query(x)[1]))
            j.append(first[k] + np.arange(len(x)))
    return np.concatenate(i), np.concatenate(j)


def _nodes(x: ArrayLike, closed: bool) -> FloatArray:
    x = np.asarray(x, dtype=np.float64)
    least = 3 if closed else 2
    if x.ndim != 2 or x.shape[1] != 3 or len(x) < least:
        kind = "a closed" if closed else "an open"
        raise TorsadeError(
            f"{kind} curve cannot have nodes of shape {x.shape}; give (n, 3) with n of at least {least}"
        )
    return x


def _positive_lengths(l: FloatArray) -> FloatArray:
    if not np.all(l > 0):
        edge = int(np.argmin(l > 0))
        raise TorsadeError(f"edge {edge} has no length; remove the repeated node at its end")
    return l


def _tangents_at_hinges(x: ArrayLike, closed: bool) -> tuple[FloatArray, FloatArray]:
    t = tangents(x, closed)
    return (np.roll(t, 1, axis=0), t) if closed else (t[:-1], t[1:])


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("...k,...k->...", a, b))


def _norm(a: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(a, axis=-1))
