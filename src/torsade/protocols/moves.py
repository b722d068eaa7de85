"""The three Reidemeister moves as strands to begin with, and as ways on which grips carry their ends.

All is in units of the free length L of a strand, from the middle of the edge that the grip at its one end
holds to the middle of that at its other. The move is seen along z, strands lie on each other in z.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipj, ellipkm1, elliprd, elliprf

from torsade.arrays import Floats

__all__ = ["MOVES", "Leg", "Loop", "Move", "planar_loop"]

LOOP = (0.15, 0.97)
"""R1: distance of the two grips at the start and at the end."""

ARC, OVERLAP = 2 * math.pi / 3, 0.5
"""R2: angle of the arc that is slid over a straight strand, and how far, in its own height."""

SLANT, SLIDE = math.pi / 6, 0.15
"""R3: angle to x of the two strands that cross, and how far to each side the third is slid."""

CLEAR = 1.05
"""Distance of axes where strands only lie on each other, in diameters: no contact yet."""


class Leg(NamedTuple):
    """A straight part of the way of all grips, at constant speed.

    Attributes
    ----------
    share : part of the duration
    way : (n_fibers, 2, 3) where each end is carried from where it was
    travel : displacement that is counted, the way of the grips that make the move
    """

    share: float
    way: Floats
    travel: float


class Move(NamedTuple):
    """Strands at the start, (n, 3) each, and the legs of the way of their ends, in units of L."""

    strands: tuple[Floats, ...]
    legs: tuple[Leg, ...]


Curve = Callable[[Floats], Floats]


class Loop(NamedTuple):
    """The planar loop of an elastica: a pendulum that turns over once.

    Its direction is theta = π + 2 am(u, m) with u = (2 s/L - 1) K.

    Attributes
    ----------
    m, K, E : parameter k², and complete elliptic integrals of it
    """

    m: float
    K: float
    E: float

    @property
    def distance(self) -> float:
        """Distance of its ends, in L: 0 for the circle (m = 0), 1 - 2/K towards the loop in a long fiber."""
        return 1 - 2 * (self.E - (1 - self.m) * self.K) / (self.m * self.K)

    @property
    def energy(self) -> float:
        """Bending energy in units of B/L: 2π² for the circle, 16/(1 - distance) for the loop in a long fiber.

        There the tension T leaves a slack of 4 √(B/T), and energy and work of T add up to 8 √(BT).
        """
        return 8 * self.E * self.K

    @property
    def tension(self) -> float:
        """Force that draws the ends apart, in units of B/L²; the energy's slope with the distance."""
        return 4 * self.m * self.K**2


def _loop_of(slender: float) -> Loop:
    """The loop of parameter 1 - exp(-slender)."""
    p = math.exp(-slender)
    return Loop(1 - p, float(ellipkm1(p)), float(ellipe(1 - p)))


def planar_loop(distance: float) -> Loop:
    """The planar loop whose ends, with tangents along x, are so far apart (in L, from 1e-6 to 0.99)."""
    return _loop_of(brentq(lambda q: _loop_of(q).distance - distance, 1e-6, 700.0, xtol=1e-14))


def _loop(distance: float) -> Curve:
    """The planar loop, (n,) arclengths → (n, 3), its ends on the x axis."""
    m, K, E = planar_loop(distance)

    def at(s: Floats) -> Floats:
        u = (2 * s - 1) * K
        sn, cn, dn, _ = ellipj(u, m)
        # The integral of dn² from 0 to u by Carlson's forms; scipy's ellipeinc is wrong at single points.
        within = sn * elliprf(cn**2, dn**2, 1) - m / 3 * sn**3 * elliprd(cn**2, dn**2, 1)
        second = np.where(cn >= 0, within, 2 * E * np.sign(sn) - within)
        x = (2 * (u - second) / m - u) / (2 * K)
        y = (dn - math.sqrt(1 - m)) / (m * K)
        return np.stack([x, y, 0 * s], axis=1)

    return at


def _lifted(flat: Curve, gap: float) -> Curve:
    """A loop whose strands keep a gap where they cross: the first passage goes below, the second above."""
    crossing = brentq(lambda s: float(flat(np.array([s]))[0, 0]), 1e-3, 0.45)

    def at(s: Floats) -> Floats:
        x = flat(s)
        near = np.minimum(s, 1 - s)
        rise = np.where(
            near < crossing,
            np.sin(np.pi * near / (2 * crossing)) ** 2,
            np.cos(np.pi * (near - crossing) / (1 - 2 * crossing)),
        )
        x[:, 2] = -0.5 * gap * rise * np.sign(0.5 - s)
        return x

    return at


def _nodes(curve: Curve, spacing: float) -> Floats:
    """Nodes of a strand: the grips hold its first and its last edge, whose middles are the ends of L."""
    n = math.ceil(1 / spacing * (1 - 1e-9))
    return curve((np.arange(n + 2) - 0.5) / n)


def _straight(angle: float, middle: tuple[float, float, float]) -> Curve:
    """A straight strand at an angle to x, about a point."""
    direction = np.array([math.cos(angle), math.sin(angle), 0.0])
    return lambda s: np.array(middle) + np.outer(s - 0.5, direction)


def _first(radius: float, spacing: float) -> Move:
    """R1: a loop comes to rest; then its ends are drawn apart until it is gone."""
    start, end = LOOP
    strand = _nodes(_lifted(_loop(start), 2 * CLEAR * radius), spacing)
    apart = 0.5 * (end - start) * np.array([[[-1.0, 0, 0], [1.0, 0, 0]]])
    return Move((strand,), (Leg(0.1, 0 * apart, 0.0), Leg(0.9, apart, end - start)))


def _second(radius: float, spacing: float) -> Move:
    """R2: an arc is slid over a straight strand, and its ends are set down into the plane of the other's."""
    lift = 2 * CLEAR * radius
    bend = 1 / ARC
    height = bend * (1 - math.cos(ARC / 2))
    before, slide = 2 * lift, 2 * lift + OVERLAP * height

    def arc(s: Floats) -> Floats:
        a = (s - 0.5) * ARC
        return np.stack([bend * np.sin(a), bend * (np.cos(a) - 1) - before, 0 * s + lift], axis=1)

    strands = (_nodes(_straight(0.0, (0.0, 0.0, 0.0)), spacing), _nodes(arc, spacing))
    return Move(strands, (Leg(0.4, _carry(2, 1, (0, slide, 0)), slide), _down(2, {1: -lift}, 0.6)))


def _third(radius: float, spacing: float) -> Move:
    """R3: two strands that cross and a third on top are set down into one plane; the third is slid across."""
    lift = 2 * CLEAR * radius
    strands = tuple(
        _nodes(_straight(angle, (x, 0.0, z)), spacing)
        for angle, x, z in ((SLANT, 0.0, -lift), (-SLANT, 0.0, 0.0), (math.pi / 2, -SLIDE, lift))
    )
    slide = _carry(3, 2, (2 * SLIDE, 0, 0))
    return Move(strands, (_down(3, {0: lift, 2: -lift}, 0.4), Leg(0.6, slide, 2 * SLIDE)))


def _carry(fibers: int, moved: int, way: tuple[float, float, float]) -> Floats:
    """Both ends of one strand carried along a way, the others held."""
    carried = np.zeros((fibers, 2, 3))
    carried[moved] = way
    return carried


def _down(fibers: int, heights: dict[int, float], share: float) -> Leg:
    """Strands whose ends are set down, or up, by heights."""
    way = np.zeros((fibers, 2, 3))
    for fiber, height in heights.items():
        way[fiber, :, 2] = height
    return Leg(share, way, max(abs(height) for height in heights.values()))


MOVES: dict[str, Callable[[float, float], Move]] = {"R1": _first, "R2": _second, "R3": _third}
"""Each from the radius of the fiber and the greatest distance of nodes, both in L."""
