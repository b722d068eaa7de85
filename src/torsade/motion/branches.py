"""Continuation: families of equilibria as what is given changes, through folds and onto other branches.

A path runs through controls from `start` (p = 0) to `stop` (p = 1). Points on it are found by
pseudo-arclength continuation (Keller 1977): a step along the tangent, then Newton's method in the plane
across it, in which the share p is unknown too, so that folds, where a load is largest, are passed like
any other point. The metric of a step is the mean square of the angle that edges turn by, plus the square
of the change of the controls in their natural units.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from torsade.arrays import Floats
from torsade.motion import newton_kernels
from torsade.motion.chain import Chain, Controls, Shape, System
from torsade.motion.lagrangian import towards
from torsade.motion.newton_kernels import MOST_CORRECTIONS, MOST_STEPS, Tangent, Way
from torsade.motion.spectrum import lowest, unstable_modes
from torsade.motion.trust import as_modes, newton, upwards

__all__ = ["Path", "Point", "bifurcation", "carry", "fold", "follow", "switch"]

SMALLEST_STEP = 1e-6

LONGEST_AT_ONCE = 0.15, 0.7
"""Up to which a path is taken in one step: the angle that edges turn by [rad], and the change of controls in
units of B and L."""


class _LostError(Exception):
    """A branch could not be followed."""


@dataclass(frozen=True, eq=False)
class Path:
    """Controls from one end, p = 0, to the other, p = 1, and beyond."""

    start: Controls
    stop: Controls

    def at(self, p: float) -> Controls:
        """The controls at the share p of the path."""
        return towards(self.start, self.rate, float(p))

    @cached_property
    def rate(self) -> Controls:
        """How the controls change with p."""
        start, stop = self.start, self.stop
        return Controls(
            stop.value - start.value,
            stop.load - start.load,
            stop.torque - start.torque,
            stop.rotation - start.rotation,
        )

    @cached_property
    def _lengths(self) -> tuple[float, float]:
        """Largest load and length of all values that change from end to end."""
        return float(np.abs(self.rate.load).max()), float(np.linalg.norm(self.rate.value))

    def size(self, chain: Chain) -> float:
        """How far controls change from end to end, in units of B and L and in radians; never nothing."""
        L, rate, (load, value) = chain.twisted_length, self.rate, self._lengths
        return math.hypot(load * L**2 / chain.B, value / L, rate.torque * L / chain.B, rate.rotation, 1e-6)


class Point(NamedTuple):
    """An equilibrium on a branch.

    Attributes
    ----------
    chain : what is bent
    p : share of the path
    shape : the equilibrium
    system : derivatives there
    tangent : direction of the branch; p changes sign at folds
    """

    chain: Chain
    p: float
    shape: Shape
    system: System
    tangent: Tangent

    @property
    def unstable(self) -> int:
        """Number of motions that would lower its energy."""
        return unstable_modes(self.chain, self.system)


def follow(
    chain: Chain,
    shape: Shape,
    path: Path,
    *,
    first: float = 0.4,
    largest: float = 0.8,
    most: int = 500,
    tangent: Tangent | None = None,
    p: float = 0.0,
) -> Iterator[Point]:
    """Points of the branch through an equilibrium at share p, until p = 1 is reached or p = 0 again.

    The last point has p = 1 exactly if the path's end was reached. `first` and `largest` are steps, `tangent`
    the direction to set out in, towards greater p unless given.
    """
    begun = _met(chain, path, shape, p, tangent or upwards(chain))
    if begun is None:
        return
    now, length = begun, first
    yield now
    for _ in range(most):
        found = _correct(chain, path, now, now.tangent, length)
        if found is None:
            length *= 0.5
            if length < SMALLEST_STEP:
                return
            continue
        point, corrections = found
        if point.p >= 1.0 > now.p:
            last = _land(chain, path, now, point)
            if last is not None:
                yield last
                return
        now = point
        yield now
        if now.p < 0.0:
            return
        length = min(largest, length * (1.5 if corrections <= 3 else 1.0 if corrections <= 5 else 0.7))


def fold(chain: Chain, path: Path, before: Point, after: Point) -> Point:
    """The last point before the branch turns back between two points, in controls to 1e-6 of their size."""
    now, length = before, 0.5 * _distance(chain, path, before, after)
    while length > 3e-4:
        found = _correct(chain, path, now, now.tangent, length)
        if found is None or found[0].tangent.p <= 0.0:
            length *= 0.5
        else:
            now = found[0]
    return now


def carry(chain: Chain, shape: Shape, path: Path) -> Shape | None:
    """The equilibrium at the end of a short path, in one predicted step; None when it is not short."""
    turn, change = LONGEST_AT_ONCE
    if path.size(chain) > change:
        return None
    begun = _met(chain, path, shape, 0.0, upwards(chain))
    if begun is None or begun.tangent.p <= 0.0:
        return None
    whole = 1.0 / begun.tangent.p
    angle = whole * float(np.linalg.norm(begun.tangent.change[:, :3])) / math.sqrt(len(shape.edge))
    if angle > turn * float(np.linalg.norm(shape.edge, axis=1).max()):
        return None
    found = _found(chain, path, begun.shape, 1.0, begun.tangent, whole)
    return None if found is None else found[0].shape


def bifurcation(chain: Chain, path: Path, before: Point, after: Point) -> tuple[Point, Floats] | None:
    """Where another branch leaves between two points, and the mode (n_edges, 4) along which it does.

    None when as many modes are unstable on both sides, or when a fold lies between them.
    """
    first, number = sorted((before.unstable, after.unstable))
    if first == number or before.tangent.p * after.tangent.p <= 0:
        return None
    modes = lowest(chain, chain.system(before.shape, path.at(before.p)), number)[1][first:]

    def at(p: float) -> tuple[Shape, System]:
        share = (p - before.p) / (after.p - before.p)
        near = before.shape if share < 0.5 else after.shape
        found = newton(chain, near, path.at(p), still=modes)
        if found is None:
            raise _LostError
        return found

    def critical(p: float) -> float:
        return float(lowest(chain, at(p)[1], number)[0][first])

    try:
        if critical(before.p) * critical(after.p) > 0.0:
            return None
        p = float(brentq(critical, before.p, after.p, xtol=1e-13, rtol=1e-12))
        shape, system = at(p)
    except _LostError:
        return None
    return before._replace(p=p, shape=shape), lowest(chain, system, number)[1][first]


def switch(chain: Chain, path: Path, at: Point, mode: Floats, amplitude: float) -> Point | None:
    """A point on the branch that leaves along a mode, this far from where it does; None if there is none.

    amplitude is the root mean square of the angle that edges turn by [rad]; its sign chooses the side.
    """
    outwards = math.copysign(math.sqrt(chain.twisted_length), amplitude) * mode
    found = _correct(chain, path, at, Tangent(outwards, np.zeros(chain.held), 0.0), abs(amplitude))
    return None if found is None else found[0]


def _distance(chain: Chain, path: Path, before: Point, after: Point) -> float:
    """Length of the step between two points."""
    turned = float(np.linalg.norm(after.shape.edge - before.shape.edge))
    turned /= float(np.linalg.norm(after.shape.edge, axis=1).max()) * math.sqrt(len(after.shape.edge))
    return math.hypot(turned, path.size(chain) * (after.p - before.p))


def _met(chain: Chain, path: Path, shape: Shape, p: float, along: Tangent) -> Point | None:
    """The point next to a shape at share p, where the branch goes on along a direction."""
    found = _found(chain, path, shape, p, along, onwards=True)
    return None if found is None else found[0]


def _correct(chain: Chain, path: Path, now: Point, along: Tangent, length: float) -> tuple[Point, int] | None:
    """Newton's method in the plane across a direction, a length away from a point."""
    return _found(chain, path, now.shape, now.p, along, length, free=True, onwards=True)


def _land(chain: Chain, path: Path, before: Point, after: Point) -> Point | None:
    """The point at p = 1 between two others."""
    near = before if 1.0 - before.p < after.p - 1.0 else after
    return _met(chain, path, near.shape, 1.0, before.tangent)


def _found(
    chain: Chain,
    path: Path,
    shape: Shape,
    p: float,
    along: Tangent,
    length: float = 0.0,
    *,
    free: bool = False,
    onwards: bool = False,
) -> tuple[Point, int] | None:
    """The point that Newton's method finds, and how many corrections it took; see `newton_kernels`."""
    way = Way(path.start, path.rate, path.size(chain), free, onwards)
    most = MOST_CORRECTIONS + 1 if free else MOST_STEPS
    corrections, p, shape, system, tangent = newton_kernels.newton(
        chain, way, shape, float(p), along, float(length), as_modes((), chain), most
    )
    return None if corrections < 0 else (Point(chain, p, shape, system, tangent), corrections)
