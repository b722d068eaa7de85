"""Reptation: how a knot that is pulled moves as a whole, and how its strands slide through it.

Over the body of a knot, velocities are fitted by least squares with

    v(x) ≈ V + Omega × (x - c) + u_k t,

a rigid motion and one speed u_k along each strand k (thesis 4.4, "reptation"): c is the centroid of the body,
t the unit tangent. Nodes weigh as much as the length of fiber that they stand for.

The body reaches on every strand from the first to the last edge in contact, that is, with a self-torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Floats, Ints
from torsade.assembly import Assembly, State

__all__ = ["Reptation", "body_nodes", "fit", "fit_state", "node_tangents"]

Span = tuple[int, int]


class Reptation(NamedTuple):
    """How a knot moves.

    Attributes
    ----------
    velocity : (3,) V, of the centroid of the body [m/s]
    rotation : (3,) Omega, of the body [rad/s]
    speed : (n_strands,) u_k, along each strand as it is oriented [m/s]
    explained : share of the variance of velocities over the body that the fit explains
    alignment : mean cosine between v - V - Omega × (x - c) and the orientation of the strand
    centre : (3,) c [m]
    """

    velocity: Floats
    rotation: Floats
    speed: Floats
    explained: float
    alignment: float
    centre: Floats


def node_tangents(x: ArrayLike) -> Floats:
    """Unit tangents at the nodes x (n, 3) of an open polyline: the mean of those of the edges that meet."""
    x = np.asarray(x, np.float64)
    t = _unit(np.diff(x, axis=0))
    return _unit(np.concatenate([t[:1], t[1:] + t[:-1], t[-1:]]))


def body_nodes(self_torque: ArrayLike, edge_start: Ints) -> list[Span] | None:
    """For each strand the first node of its body and the one after the last, counted on the strand.

    None where a strand touches nothing: then there is no knot.

    Parameters
    ----------
    self_torque : (n_edges,), other than zero where an edge is in contact
    edge_start : (n_strands + 1,) offsets of the edges of each strand
    """
    touching = np.asarray(self_torque) != 0.0
    spans = []
    for first, last in pairwise(edge_start):
        found = np.flatnonzero(touching[first:last])
        if len(found) == 0:
            return None
        spans.append((int(found[0]), int(found[-1]) + 2))
    return spans


def fit(
    strands: Sequence[Floats],
    velocities: Sequence[Floats],
    body: Sequence[Span],
    orientation: Sequence[int],
) -> Reptation:
    """Fit a rigid motion and one speed along each strand.

    Parameters
    ----------
    strands : (n, 3) nodes of each [m]
    velocities : (n, 3) of the nodes [m/s]
    body : the first node of each strand that counts, and the one after the last
    orientation : +1 for a strand that runs from its first to its last node, -1 for the other way
    """
    parts = [_part(s, span, sign) for s, span, sign in zip(strands, body, orientation, strict=True)]
    x, t, weight = (np.concatenate(column) for column in zip(*parts, strict=True))
    v = np.concatenate([u[first:last] for u, (first, last) in zip(velocities, body, strict=True)])
    weight = weight / weight.sum()
    centre = weight @ x
    y = x - centre
    # In units of its size the body turns about as fast as it moves, and the equations are well scaled.
    size = float(np.sqrt(weight @ (y * y).sum(axis=1)))
    columns = np.zeros((len(x), 3, 6 + len(body)))
    columns[:, :, :3] = np.eye(3)
    columns[:, :, 3:6] = _turning(y / size)
    begin = 0
    for k, (first, last) in enumerate(body):
        mine = slice(begin, begin + last - first)
        columns[mine, :, 6 + k] = t[mine]
        begin += last - first
    flat = columns.reshape(-1, columns.shape[2])
    weighted = flat * np.repeat(weight, 3)[:, None]
    found = np.linalg.lstsq(weighted.T @ flat, weighted.T @ v.ravel(), rcond=1e-12)[0]
    rest, mean = v - columns @ found, v - weight @ v
    spread = weight @ (mean * mean).sum(axis=1)
    explained = 1.0 - weight @ (rest * rest).sum(axis=1) / spread if spread > 0 else 1.0
    sliding = v - columns[:, :, :6] @ found[:6]
    speed = np.sqrt((sliding * sliding).sum(axis=1))
    cosine = (sliding * t).sum(axis=1) / np.where(speed > 0, speed, 1.0)
    return Reptation(
        found[:3], found[3:6] / size, found[6:], float(explained), float(weight @ cosine), centre
    )


def fit_state(
    assembly: Assembly, state: State, self_torque: Floats, pulled: Sequence[int]
) -> Reptation | None:
    """The fit at a state; None where the strands do not touch.

    Parameters
    ----------
    self_torque : (n_edges,) as measured, which tells what is in contact
    pulled : the end of each strand, 0 or 1, towards which it is oriented
    """
    body = body_nodes(self_torque, assembly.edge_start)
    if body is None:
        return None
    cuts = assembly.node_start[1:-1]
    orientation = [1 if end else -1 for end in pulled]
    return fit(np.split(state.x, cuts), np.split(state.v, cuts), body, orientation)


def _part(x: Floats, span: Span, sign: int) -> tuple[Floats, Floats, Floats]:
    """Nodes of a strand's body (n, 3), tangents as it is oriented, and the length each stands for (n,)."""
    first, last = span
    before, after = max(first - 1, 0), min(last + 1, len(x))
    e = np.diff(x[before:after], axis=0)
    l = np.sqrt((e * e).sum(axis=1))
    t = node_tangents(x[before:after])
    length = 0.5 * (np.append(l, 0.0) + np.append(0.0, l))
    mine = slice(first - before, last - before)
    return x[first:last], sign * t[mine], length[mine]


def _turning(y: Floats) -> Floats:
    """Velocities (n, 3, 3) at points y (n, 3) of the three unit rotations: column k is e_k × y."""
    columns = np.zeros((len(y), 3, 3))
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        columns[:, i, k], columns[:, j, k] = -y[:, j], y[:, i]
    return columns


def _unit(e: Floats) -> Floats:
    return np.asarray(e / np.sqrt((e * e).sum(axis=1))[:, None])
