"""Velocities of a knot in the frame in which its body is at rest: arrows, and profiles along strands."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade.arrays import Floats
from torsade.reptation import body_nodes, node_tangents
from torsade.results import Result
from torsade.view.arrows import Arrow

__all__ = ["Flow", "arrows", "flow"]

BETWEEN = 3.6  # from one arrow to the next along a strand [radii]
LENGTH = 2.5  # of an arrow whose velocity lies in the plane of the picture [radii]


class Flow(NamedTuple):
    """Velocities of strands in one frame.

    Attributes
    ----------
    strands : (n, 3) nodes of each [m]
    velocities : (n, 3) less the mean over the body of the knot, weighted by length [m/s]
    along : (n,) arclength of the nodes [m]
    sliding : (n,) v . t, t along the strand as its nodes are numbered [m/s]
    body : the first node of each that is in the body, and the one after the last
    alignment : cosine between v and t, (n,)
    """

    strands: list[Floats]
    velocities: list[Floats]
    along: list[Floats]
    sliding: list[Floats]
    body: list[tuple[int, int]]
    alignment: list[Floats]


def flow(result: Result, frame: int) -> Flow:
    """The velocities of a stored frame; the body is what touches, or everything if nothing does."""
    data = result.dataset.isel(time=frame)
    bounds = data["node_start"].values
    strands = np.split(data["position"].values.astype(float), bounds[1:-1])
    velocities = np.split(data["velocity"].values.astype(float), bounds[1:-1])
    body = body_nodes(data["self_torque"].values, bounds - np.arange(len(bounds)))
    body = [(0, len(x)) for x in strands] if body is None else body
    along = [_arclength(x) for x in strands]
    weight = np.concatenate([np.gradient(s)[slice(*b)] for s, b in zip(along, body, strict=True)])
    inside = np.concatenate([v[slice(*b)] for v, b in zip(velocities, body, strict=True)])
    moving = [v - weight @ inside / weight.sum() for v in velocities]
    tangents = [node_tangents(x) for x in strands]
    sliding = [np.einsum("ic,ic->i", v, t) for v, t in zip(moving, tangents, strict=True)]
    alignment = [
        s / np.maximum(np.linalg.norm(v, axis=1), 1e-300) for s, v in zip(sliding, moving, strict=True)
    ]
    return Flow(strands, moving, along, sliding, body, alignment)


def arrows(found: Flow, radius: float) -> list[Arrow]:
    """Arrows of one length along the strands, each in the direction of the velocity there."""
    drawn = []
    for k, (along, v) in enumerate(zip(found.along, found.velocities, strict=True)):
        for place in np.arange(0.5, along[-1] / (BETWEEN * radius)) * BETWEEN * radius:
            i = int(np.argmin(np.abs(along - place)))
            size = float(np.linalg.norm(v[i]))
            if size > 0:
                x, y, z = (LENGTH / size * v[i]).tolist()
                drawn.append(Arrow(k, i, (x, y, z)))
    return drawn


def _arclength(x: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1))])
