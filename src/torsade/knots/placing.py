"""Curves enlarged, their ends led out, and pieces put side by side. Lengths are in radii."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from torsade.knots.leads import cut_at, way_out
from torsade.knots.lift import angles_of_ends
from torsade.knots.shape import Shapes, last_edge, pieces

__all__ = ["placed"]

FloatArray = NDArray[np.float64]

_GAP = 4.0  # between pieces side by side, beyond what they reach [radii]


def placed(shapes: Shapes, factor: float, lead: float, tail: float) -> list[FloatArray]:
    """The curves enlarged, open strands led out, closed pieces beside them or beside each other."""
    diagram = shapes.diagram
    angles = angles_of_ends(diagram, shapes.pulled)
    out: dict[int, FloatArray] = {}
    edge = -math.inf
    gap_angle, gap_width = _widest_gap([last for _, last in angles.values()])
    for strands in sorted(pieces(diagram), key=lambda s: not diagram.is_open(s[0])):
        x = [factor * shapes.curves[k] for k in strands]
        if diagram.is_open(strands[0]):
            x = [
                _led_out(shapes, k, c, factor, angles, (lead, tail)) if diagram.is_open(k) else c
                for k, c in zip(strands, x, strict=True)
            ]
            edge = factor * shapes.reach
        else:
            x, edge = _beside(x, edge, gap_angle, gap_width if angles else math.pi)
        out |= dict(zip(strands, x, strict=True))
    return [out[k] for k in range(diagram.n_strands)]


def _widest_gap(angles: Sequence[float]) -> tuple[float, float]:
    """Middle and width [rad] of the widest gap between directions; all around where there are none."""
    if not angles:
        return 0.0, 2 * math.pi
    around = sorted(a % (2 * math.pi) for a in angles)
    widths = [
        (b - a) % (2 * math.pi) or 2 * math.pi for a, b in zip(around, around[1:] + around[:1], strict=True)
    ]
    k = int(np.argmax(np.round(widths, 9)))
    return around[k] + widths[k] / 2, widths[k]


def _beside(x: list[FloatArray], edge: float, angle: float, width: float) -> tuple[list[FloatArray], float]:
    """A piece moved out along an angle until it is clear of what reaches to the edge, and of leads."""
    nodes = np.concatenate(x)
    middle = (nodes.min(axis=0) + nodes.max(axis=0)) / 2
    size = float(np.linalg.norm(nodes - middle, axis=1).max())
    if edge == -math.inf:
        return [c - middle for c in x], size
    away = edge + _GAP + size
    if width < math.pi:
        away = max(away, (size + _GAP) / math.sin(width / 2))
    shift = away * np.array([math.cos(angle), math.sin(angle), 0.0]) - middle
    return [c + shift for c in x], away + size


def _led_out(
    shapes: Shapes,
    strand: int,
    x: FloatArray,
    factor: float,
    angles: dict[str, tuple[float, float]],
    lengths: tuple[float, float],
) -> FloatArray:
    """An open strand with its two leads."""
    diagram = shapes.diagram
    reach = factor * shapes.reach
    x = cut_at(x, reach)
    tips = diagram.starts[strand], diagram.edges[last_edge(diagram, strand)][1]
    for tip in reversed(tips):
        name = diagram.ends[tip]
        is_pulled = shapes.pulled is None or name in (shapes.pulled[:2], shapes.pulled[2:])
        out = way_out(x, angles[name][1], reach, is_pulled, lengths[0 if is_pulled else 1])
        x = np.concatenate([x, out])[::-1]
    return x
