"""From a drawing in the disc to strands in space, with open ends led out under given angles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from torsade.knots.packing import Drawing, packed
from torsade.topology.diagram import Diagram

__all__ = ["angles_of_ends", "lifted"]

FloatArray = NDArray[np.float64]

# The starting length, near that of the knot drawn tight, is only that: a start [radii].
_LENGTH = 20.0
_LENGTH_PER_CROSSING = 14.0
_PARTS = 2  # edges between two points of the drawing, at least
_LONGEST = 1.2  # edge at the start, so that strands feel each other [radii]
_RIM = 1.1  # of the greatest distance of a crossing from the centre: where leads begin
_LEADS = 1.3  # of the rim: where leads reach their angle
_BEYOND = 6.0  # and how much farther they go [radii]
_TURNS = 6  # points of a lead on its way to its angle

NARROW = np.deg2rad(20)
TAIL = np.deg2rad(60)


def angles_of_ends(diagram: Diagram, pulled: str | None) -> dict[str, tuple[float, float]]:
    """For every end the angles [rad] under which its strand leaves the knot, and under which it then goes on.

    The end named first in `pulled` goes on along -x, the second along +x. The others leave that line by 60
    degrees, in the order of the diagram; where they can, they go on past the pulled end of the other strand,
    so that their strand turns least. Forces of equal size under the first angles balance. Without `pulled`
    ends leave evenly, the first along -x.
    """
    names = diagram.ends
    if pulled is None:
        even = np.pi + 2 * np.pi * np.arange(len(names)) / max(1, len(names))
        return {name: (float(a), float(a)) for name, a in zip(names, even, strict=True)}
    first, second = pulled[:2], pulled[2:]
    k = names.index(first)
    around = names[k:] + names[:k]
    at = around.index(second)
    below, above = around[1:at], around[at + 1 :]
    if len(below) == len(above) == 1:
        low = TAIL if below[0][:1] == second[:1] else np.pi - TAIL
        high = TAIL if above[0][:1] == first[:1] else np.pi - TAIL
        angles = {first: np.pi, below[0]: np.pi + low, second: 2 * np.pi, above[0]: 2 * np.pi + high}
        return {name: (float(a), float(a)) for name, a in angles.items()}
    if not below and not above:
        return {first: (np.pi, np.pi), second: (2 * np.pi, 2 * np.pi)}
    side = 1.0 if below else -1.0
    # Both tails on one side: the pulled ends begin on the other, and come back to their line.
    tails = below if below else above[::-1]
    return {
        first: (np.pi - side * NARROW, np.pi),
        tails[0]: (np.pi + side * NARROW, np.pi + side * TAIL),
        tails[1]: (2 * np.pi - side * NARROW, 2 * np.pi - side * TAIL),
        second: (2 * np.pi + side * NARROW, 2 * np.pi),
    }


def lifted(diagram: Diagram, strands: Sequence[int], angles: Mapping[str, float]) -> list[FloatArray]:
    """Polylines [radii], shapes (n, 3), of the strands of one piece; seen along z they are its drawing.

    Args:
        diagram: the diagram.
        strands: numbers of the strands of a piece that is not a circle without crossings.
        angles: of the ends, increasing counterclockwise; the last node of a lead is seen under its angle.
    """
    drawing = packed(diagram, strands)
    is_open = [diagram.is_open(k) for k in strands]
    inner = np.concatenate([z[2:-2] if o else z for z, o in zip(drawing.points, is_open, strict=True)])
    rim = _RIM * float(np.abs(inner).max())
    total = sum(
        float(np.abs(np.diff(z[2:-2] if o else np.append(z, z[0]))).sum())
        for z, o in zip(drawing.points, is_open, strict=True)
    )
    scale = (_LENGTH + _LENGTH_PER_CROSSING * diagram.n_crossings) / total
    turn = _turns(diagram, drawing, rim, angles)
    out = []
    for k, z, height, o in zip(strands, drawing.points, drawing.heights, is_open, strict=True):
        if o:
            z, height = _with_leads(diagram, k, z, height, rim, turn, scale)
        elif turn:
            z = z * np.exp(1j * turn[""])
        x = scale * np.column_stack([z.real, z.imag, height])
        out.append(_divided(x, closed=not o))
    return out


def _turns(diagram: Diagram, drawing: Drawing, rim: float, angles: Mapping[str, float]) -> dict[str, float]:
    """By how much each lead has to turn, and, under "", by how much the drawing is turned as a whole."""
    if not angles:
        return {}
    seen: dict[str, float] = {}
    for k, z in zip(drawing.strands, drawing.points, strict=True):
        if diagram.is_open(k):
            first, last = _tips(diagram, k)
            seen[first] = float(np.angle(_crossing(z, rim)[1]))
            seen[last] = float(np.angle(_crossing(z[::-1], rim)[1]))
    order = [name for name in angles if name in seen]
    order.sort(key=lambda name: angles[name])
    start = seen[order[0]]
    turn = {name: angles[name] - angles[order[0]] - (seen[name] - start) % (2 * np.pi) for name in order}
    mean = sum(turn.values()) / len(turn)
    whole = angles[order[0]] - start + mean
    return {"": whole} | {name: t - mean for name, t in turn.items()}


def _tips(diagram: Diagram, strand: int) -> tuple[str, str]:
    """Names of the two ends of an open strand."""
    own = [e for e, k in enumerate(diagram.edge_strand) if k == strand]
    return diagram.ends[diagram.edges[own[0]][0]], diagram.ends[diagram.edges[own[-1]][1]]


def _crossing(z: NDArray[np.complex128], rim: float) -> tuple[int, complex]:
    """Where a lead, which begins at z[0], first comes to the rim: the point after, and where."""
    i = int(np.argmax(np.abs(z) < rim))
    a, b = complex(z[i - 1]), complex(z[i])
    # |a + s (b - a)| = rim
    d = b - a
    p, q = (a.conjugate() * d).real / abs(d) ** 2, (abs(a) ** 2 - rim**2) / abs(d) ** 2
    return i, a + (-p - np.sqrt(max(0.0, p * p - q))) * d


def _with_leads(
    diagram: Diagram,
    strand: int,
    z: NDArray[np.complex128],
    height: FloatArray,
    rim: float,
    turn: Mapping[str, float],
    scale: float,
) -> tuple[NDArray[np.complex128], FloatArray]:
    """An open strand with what lies outside the rim replaced by leads that turn to their angles."""
    first, last = _tips(diagram, strand)
    i, a = _crossing(z, rim)
    j, b = _crossing(z[::-1], rim)
    leads = []
    for name, at in ((first, a), (last, b)):
        s = np.arange(_TURNS + 1) / _TURNS
        lead = at * (1 + (_LEADS - 1) * s) * np.exp(1j * turn[name] * s)
        leads.append(np.append(lead, lead[-1] * (1 + _BEYOND / scale / abs(lead[-1]))))
    keep = slice(i, len(z) - j)
    run = np.concatenate([leads[0][::-1], z[keep], leads[1]]) * np.exp(1j * turn[""])
    flat = np.zeros(len(leads[0]))
    return run, np.concatenate([flat, height[keep], flat])


def _divided(x: FloatArray, closed: bool) -> FloatArray:
    """Each edge cut into equal parts."""
    nodes = np.concatenate([x, x[:1]]) if closed else x
    out = []
    for a, b in pairwise(nodes):
        parts = max(_PARTS, math.ceil(float(np.linalg.norm(b - a)) / _LONGEST))
        out.append(a + (b - a) * np.arange(parts)[:, None] / parts)
    return np.concatenate(out if closed else [*out, nodes[-1:]])
