"""Arrows on strands: a velocity at a node, drawn where the strand is in sight."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.view._extra import require
from torsade.view.camera import View

__all__ = ["Arrow", "draw_arrows", "in_sight"]

Floats = NDArray[np.float64]

INK = "#16191c"
MARGIN = 0.03  # of the width: nearer to the border there are no arrows


class Arrow(NamedTuple):
    """An arrow in space with its middle on a node.

    Attributes
    ----------
    strand : number of the strand
    node : number of the node on it
    vector : (3,) direction and length, in radii
    colour : of its inside; its rim is dark
    """

    strand: int
    node: int
    vector: tuple[float, float, float]
    colour: str = "white"


def in_sight(arrow: Arrow, view: View, strands: Sequence[Floats], radius: float) -> bool:
    """Whether nothing stands between the camera and the axis of the strand where the arrow is.

    strands (n, 3) are the nodes of each; their radius is in the same unit.
    """
    x = strands[arrow.strand][arrow.node]
    for y in strands:
        away = y - x
        depth = away @ view.toward
        aside = np.linalg.norm(away - depth[:, None] * view.toward, axis=1)
        if np.any((depth > radius) & (aside < radius)):
            return False
    return True


def draw_arrows(
    axes: Any, arrows: Sequence[Arrow], view: View, strands: Sequence[Floats], radius: float
) -> None:
    """Draw the arrows that are in sight and in the frame, on axes that count pixels from the lower left."""
    patches = require("matplotlib.patches")
    for arrow in arrows:
        x = strands[arrow.strand][arrow.node]
        reach = 0.5 * radius * np.asarray(arrow.vector, np.float64)
        tail, tip = view.pixels(np.stack([x - reach, x + reach]))
        border = MARGIN * view.size[0]
        inside = all(np.all((end > border) & (end < np.array(view.size) - border)) for end in (tail, tip))
        length = float(np.linalg.norm(tip - tail))
        unit = radius * float(view.scale(x[None])[0])
        if not inside or length < 0.2 * unit or not in_sight(arrow, view, strands, radius):
            continue
        head = min(0.75 * unit, 0.6 * length)
        shape = patches.FancyArrow(
            *tail, *(tip - tail), width=0.24 * unit, head_width=0.85 * unit, head_length=head,
            length_includes_head=True, fc=arrow.colour, ec=INK, lw=0.035 * unit, joinstyle="round",
        )  # fmt: skip
        axes.add_patch(shape)
