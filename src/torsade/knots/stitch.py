"""Sutures tied around a wound: one strand, whose two throws close a loop around two parallel cylinders.

Seen along z, which is the direction of the cylinders, the strand lies as a surgeon lays it: a belt around
both, the first throw upon its upper side, the second throw upon the first, and the two ends to the left and
to the right. A throw is two helices about one axis along x. Turned by 180 degrees about y it is the same
shape, the ends exchanged, and the mirror image (-b, -t) of a suture (b, t) is the mirror image z → -z: both
to the bit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.curve import resample
from torsade.errors import TorsadeError
from torsade.knots.reading import reads_as
from torsade.knots.sutures import suture_diagram
from torsade.topology.projection import project

__all__ = ["Stitch", "stitch"]

FloatArray = NDArray[np.float64]

HELIX = 1.1  # radius of the helices of a throw: strands are 2.2 radii apart [radii]
HALF_TURN = 5.2  # length along x of a half turn of a throw [radii]
EASE = 5.2  # length over which a throw begins and ends to turn [radii]
RETURN = 5.0  # diameter of the arcs from the first throw to the second [radii]
LEAD = 16.0  # straight ends beyond the second throw [radii]
SLACK = 0.2  # between the belt and the cylinders [radii]
MARGIN = 1.0  # from the first throw to where the belt bends [radii]
DENSE = 0.05  # distance of points from which nodes are taken [radii]


class Stitch(NamedTuple):
    """A strand around two cylinders.

    Attributes
    ----------
    strand : (n, 3) nodes, from the left end to the right one [m]
    cylinders : (2, 3) where the axes of the cylinders, a to the left and b to the right, meet z = 0 [m]
    loop : the nodes farthest to the left and to the right, between which lies the lower half of the belt
    """

    strand: FloatArray
    cylinders: FloatArray
    loop: tuple[int, int]


def stitch(
    bottom: int, top: int, radius: float, skin_radius: float, gap: float, spacing: float | None = None
) -> Stitch:
    """A suture of two throws, tied loosely around two cylinders; nothing touches.

    Parameters
    ----------
    bottom, top : half turns of the throw tied first and of the one on it, odd, right-handed if positive
    radius : of the fiber h [m]
    skin_radius : of the cylinders h_s [m]
    gap : between the cylinders [m]
    spacing : greatest distance between nodes [m]; by default half a radius

    Raises
    ------
    TorsadeError
        When the numbers are no suture (see `suture_diagram`).
    """
    wanted = suture_diagram(bottom, top)
    h_s, half_gap = skin_radius / radius, gap / (2 * radius)
    half = _left_half(bottom, top, h_s, half_gap)
    other = half[-2::-1] * (-1, 1, -1)
    apart = 0.5 if spacing is None else spacing / radius
    x = resample(np.concatenate([half, other]), spacing=apart)
    x = 0.5 * (x + x[::-1] * (-1, 1, -1))
    first = int(np.argmax(x[:, 1] < 0))
    last = len(x) - 1 - first
    read = project([x[: first + 1][::-1], x[last:]], [False, False]).diagram
    if not reads_as(read, wanted):
        raise TorsadeError(f"the curve made of the suture {bottom},{top} is another knot")
    cylinders = np.array([[-h_s - half_gap, 0.0, 0.0], [h_s + half_gap, 0.0, 0.0]])
    return Stitch(radius * x, radius * cylinders, (first, last))


def _throw(turns: int, belt: float) -> tuple[FloatArray, float]:
    """The helix that comes in below on the left and leaves above on the right, (n, 3), and its half length.

    Its axis is y = belt, z = 0.
    """
    n = abs(turns)
    length = n * HALF_TURN + EASE
    s = np.linspace(0.0, length, max(2, math.ceil(length / DENSE)) + 1)
    # The rate of turning rises and falls evenly over the ease, and is constant between.
    up = np.minimum(s, EASE) ** 2 / (2 * EASE) + np.clip(s - EASE, 0.0, length - 2 * EASE)
    down = np.maximum(s - (length - EASE), 0.0)
    turned = math.pi / HALF_TURN * (up + down - down**2 / (2 * EASE))
    hand = 1.0 if turns > 0 else -1.0
    y, z = belt - HELIX * np.cos(turned), hand * HELIX * np.sin(turned)
    return np.column_stack([s - length / 2, y, z]), length / 2


def _left_half(bottom: int, top: int, h_s: float, half_gap: float) -> FloatArray:
    """Points (n, 3) from the left end of the strand to the middle of the lower side of the belt [radii]."""
    belt = h_s + 1.0 + SLACK
    first, first_reach = _throw(bottom, belt + HELIX)
    second, second_reach = _throw(top, belt + 3 * HELIX + RETURN)
    turn = max(first_reach, second_reach)
    side = max(h_s + half_gap, first_reach + MARGIN)
    rise = np.linspace(-math.pi / 2, math.pi / 2, math.ceil(math.pi * RETURN / 2 / DENSE) + 1)
    back = RETURN / 2 * np.column_stack([np.cos(rise), np.sin(rise), 0 * rise])
    back += [turn, belt + 2 * HELIX + RETURN / 2, 0.0]
    round_ = np.linspace(math.pi / 2, 3 * math.pi / 2, math.ceil(math.pi * belt / DENSE) + 1)
    around = belt * np.column_stack([np.cos(round_), np.sin(round_), 0 * round_]) - [side, 0.0, 0.0]
    # From the end: through the second throw to the right, back on the right, through the first to the left.
    up = second * (-1, 1, -1)
    end = up[-1] - [LEAD, 0.0, 0.0]
    parts = [end[None], up[::-1], back[::-1], first[::-1], around, np.array([[0.0, -belt, 0.0]])]
    x = np.concatenate(parts)
    keep = np.append(True, np.linalg.norm(np.diff(x, axis=0), axis=1) > 1e-9)
    return np.asarray(x[keep])
