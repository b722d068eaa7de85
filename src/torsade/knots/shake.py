"""Ways out of a shape that is tight, but not the tightest: shaking it, and turning it inside out.

Both keep the knot. Shaking moves nodes by less than half the distance of strands. An inversion in a sphere,
its centre in a hole of the knot, carries strands through infinity, where nothing can be met; it makes a
mirror image, which a point reflection takes back.
"""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from torsade.arrays import Floats
from torsade.curve import length, resample
from torsade.knots.ropelength import thickness

__all__ = ["Strands", "inverted", "loosened", "shaken", "spaced"]

Strands = list[Floats]
"""Nodes of closed strands, shapes (n, 3), in units of the target radius."""

LEAST_NODES = 16
"""Of a strand."""

HOLE = 1.05
"""Least distance of a hole's centre from the curve [radii]."""

INVERTED_NODES = 300


def spaced(strands: Strands, spacing: float) -> Strands:
    """Strands with nodes about so far apart."""
    return [resample(x, n=max(LEAST_NODES, round(length(x, True) / spacing)), closed=True) for x in strands]


def shaken(strands: Strands, size: float, waves: int, random: Generator) -> Strands:
    """Strands moved at random by at most size, in so many waves along each."""
    moves = []
    for x in strands:
        angle = 2 * np.pi * np.arange(len(x)) / len(x)
        wave = np.arange(1, waves + 1)[:, None] * angle
        basis = np.concatenate([np.cos(wave), np.sin(wave)])
        moves.append(np.einsum("kn,kc->nc", basis, random.normal(size=(2 * waves, 3))))
    largest = max(float(np.sqrt((d * d).sum(axis=1)).max()) for d in moves)
    return [x + size / largest * d for x, d in zip(strands, moves, strict=True)]


def inverted(strands: Strands, longest: float, random: Generator) -> Strands | None:
    """Strands inverted about a hole of theirs and scaled to radius one; None if all tried are longer than
    that."""
    fine = spaced(strands, 0.2)
    nodes = np.concatenate(fine)
    low, high = nodes.min(axis=0), nodes.max(axis=0)
    centres = low + (high - low) * random.random((100, 3))
    holes = centres[cKDTree(nodes).query(centres)[0] > HOLE]
    for centre in holes[:5]:
        found = _about(fine, centre)
        if sum(length(x, True) for x in found) < longest:
            return found
    return None


def loosened(strands: Strands, ropelength: float) -> Strands:
    """Strands of radius one with their outermost part blown up, until length reaches the ropelength."""
    fine = spaced(strands, 0.1)
    nodes = np.concatenate(fine)
    outward = nodes - nodes.mean(axis=0)
    far = int(np.argmax((outward * outward).sum(axis=1)))
    outward = outward[far] / np.linalg.norm(outward[far])
    off = 8.0
    found = strands
    while sum(length(x, True) for x in found) < ropelength and off > 0.1:
        found = _about(fine, nodes[far] + off * outward)
        off *= 0.8
    return found


def _about(fine: Strands, centre: Floats) -> Strands:
    """Inverted about a centre, reflected, and scaled to radius one."""
    found = []
    for x in fine:
        r = centre - x
        found.append(r / (r * r).sum(axis=1)[:, None])
    whole = sum(length(x, True) for x in found)
    found = [
        resample(x, n=max(4 * LEAST_NODES, round(INVERTED_NODES * length(x, True) / whole)), closed=True)
        for x in found
    ]
    radius = thickness(found, 1).radius
    return [x / radius for x in found]
