"""Shapes of least energy of a fiber that is bent and twisted at its ends.

The twist device of thesis 3.4 and 3.11: a straight fiber of length L is gripped at both ends, each grip
turns freely about an axis z across the line x of the ends, so that end tangents stay in the plane xy and
feel no moment about z. The fiber is twisted, which fixes its total twist Tw, uniform along it, and its
ends are brought to a distance from each other.
"""

from __future__ import annotations

import contextlib
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.special import j0

from torsade.arrays import Floats
from torsade.assembly import Assembly, State, assemble, initial_state
from torsade.errors import TorsadeError
from torsade.motion.branches import Path, carry, fold, follow
from torsade.motion.chain import Chain, Controls, Shape
from torsade.motion.spectrum import lowest, unstable_modes
from torsade.motion.supports import Fiber, Support, chain, controls_at, shape_along
from torsade.motion.trust import minimise, newton
from torsade.rod.elasticity import hinge_curvature

__all__ = ["Bent", "Range", "bent", "bent_until", "curvature_at_distance"]

PIVOT = Support("plane")
"""A grip of the twist device."""

STRAIGHT = 1e-9
"""End shortening, in units of L, below which a fiber is as good as straight: kappa L is then 2e-4."""

NEAREST = 1e-7
"""Least end distance, in units of L: an arch whose ends coincide would be free to turn about them."""

FEWEST_EDGES = 4

ACCURACY = 1e-9
"""Relative error of a curvature that is asked for."""

MOST_SECANTS = 25


class Bent(NamedTuple):
    """An equilibrium in the twist device.

    Attributes
    ----------
    fiber : what is bent
    x : (n_nodes, 3) nodes, the first at the origin, the last at (end_distance, 0, 0) [m]
    kappa : (n_nodes,) curvature, the ends included [1/m]
    total_twist : Tw [rad]
    rotation : how far one grip was turned against the other [rad]
    torque : twisting moment [N m]
    shape : edges and multipliers, grips included, in units of L and B
    controls : what is given, in the same units
    """

    fiber: Fiber
    x: Floats
    kappa: Floats
    total_twist: float
    rotation: float
    torque: float
    shape: Shape
    controls: Controls

    @property
    def end_distance(self) -> float:
        """Distance of the ends [m]."""
        return float(self.x[-1, 0])

    @property
    def grips(self) -> tuple[Floats, Floats]:
        """Directions of the fiber at its two ends, unit vectors (3,)."""
        first, last = self.shape.edge[0], self.shape.edge[-1]
        return first / np.linalg.norm(first), last / np.linalg.norm(last)

    @property
    def kappa_max(self) -> float:
        """Largest curvature [1/m]."""
        return _peak(self.kappa)

    @property
    def out_of_plane(self) -> float:
        """Largest distance from the plane of the end tangents [m]."""
        return _peak(np.abs(self.x[:, 2]))

    @property
    def force(self) -> Floats:
        """Force of the grip on the last end [N], shape (3,)."""
        problem, L = _device(self.fiber.edges, self.fiber.C / self.fiber.B), self.fiber.length
        return self.fiber.B / L**2 * _force(problem, _tangents(self.shape), self.x / L, self.shape.torque)

    @property
    def thrust(self) -> float:
        """Force that pushes the ends towards each other [N]."""
        return -float(self.force[0])

    @property
    def unstable(self) -> int:
        """Number of motions that would lower the energy, with the ends and both grips held."""
        gripped = _device(self.fiber.edges, self.fiber.C / self.fiber.B, rotation_held=True)
        controls = self.controls._replace(rotation=self.rotation)
        return unstable_modes(gripped, gripped.system(self.shape, controls))

    @property
    def stable(self) -> bool:
        """Whether energy is least, with the ends and both grips held."""
        return self.unstable == 0

    @property
    def energy_bend(self) -> float:
        """Bending energy [J]."""
        l = np.full(len(self.kappa), self.fiber.length / self.fiber.edges)
        l[[0, -1]] *= 0.5
        return float(0.5 * self.fiber.B * (l * self.kappa**2).sum())

    @property
    def energy_twist(self) -> float:
        """Twist energy [J]."""
        return 0.5 * self.torque * self.total_twist

    def stiffness(self) -> float:
        """Least eigenvalue of the constrained Hessian with the ends and both grips held [N]."""
        problem = _device(self.fiber.edges, self.fiber.C / self.fiber.B, rotation_held=True)
        d = max(self.end_distance / self.fiber.length, NEAREST)
        system = problem.system(self.shape, controls_at(problem, (d, 0.0, 0.0), rotation=self.rotation))
        return self.fiber.B / self.fiber.length**2 * float(lowest(problem, system)[0][0])

    def assembled(self) -> tuple[Assembly, State]:
        """Index arrays and a state at rest, evenly twisted, for whoever lets the fiber go on from here."""
        a = assemble([self.x])
        state = initial_state(a, [self.x])
        state.theta[:] = self.total_twist / self.fiber.length * a.edge_arclength
        return a, state


def _peak(values: Floats) -> float:
    """Largest of evenly spaced values (n,), where it lies between them by the parabola through three."""
    k = int(values.argmax())
    if k in (0, len(values) - 1):
        return float(values[k])
    before, top, after = (float(v) for v in values[k - 1 : k + 2])
    bend = before - 2.0 * top + after
    return top - (after - before) ** 2 / (8.0 * bend) if bend < 0.0 else top


def bent(
    fiber: Fiber,
    end_distance: float,
    total_twist: float = 0.0,
    near: Bent | None = None,
    *,
    rotation: float | None = None,
) -> Bent:
    """The equilibrium at an end distance [m] and a total twist [rad], on the branch of the planar one.

    The untwisted fiber is bent first, in the plane of its end tangents and towards +y, then twisted. With an
    equilibrium `near` of the same fiber the path starts there, and is shorter; where it does not lead to the
    end, the planar arch is tried. With `rotation` the angle between the grips [rad] is given, in place of the
    twist.

    Raises
    ------
    TorsadeError
        When the ends are as far apart as the fiber is long, or there is no such equilibrium.
    """
    d = end_distance / fiber.length
    if not 0.0 <= d <= 1.0 - STRAIGHT:
        raise TorsadeError(
            f"ends {end_distance:g} m apart are not those of a bent fiber of length {fiber.length:g} m; give "
            "a distance from 0 to less than its length."
        )
    if not math.isfinite(total_twist if rotation is None else rotation):
        raise TorsadeError(
            f"a twist of {total_twist if rotation is None else rotation:g} rad is none; give a finite angle."
        )
    d = max(d, NEAREST)
    problem = _device(fiber.edges, fiber.C / fiber.B, rotation_held=rotation is not None)

    def given(d: float, torque: float, angle: float) -> Controls:
        return controls_at(problem, (d, 0.0, 0.0), torque=torque, rotation=angle)

    wanted = given(d, problem.C * total_twist, 0.0 if rotation is None else rotation)
    if near is not None:
        begin = given(near.end_distance / fiber.length, near.shape.torque, near.rotation)
        with contextlib.suppress(TorsadeError):
            shape = _followed(problem, near.shape, Path(begin, wanted))
            # A long step to a nearly straight arch can go through the straight fiber to the other side.
            if shape.edge[0, 1] * near.shape.edge[0, 1] > 0.0:
                return _measured(fiber, problem, shape, wanted)
    begin = given(d, 0.0, 0.0)
    shape = _planar(problem, d, begin)
    return _measured(fiber, problem, _followed(problem, shape, Path(begin, wanted)), wanted)


def bent_until(fiber: Fiber, kappa_max: float, total_twist: float = 0.0, near: Bent | None = None) -> Bent:
    """The equilibrium at which the largest curvature [1/m] is reached, at a total twist [rad].

    The end distance is found by secants in the square root of the end shortening, of which the curvature of a
    nearly straight fiber is a multiple.

    Raises
    ------
    TorsadeError
        When no end distance gives this curvature.
    """
    wanted = kappa_max * fiber.length
    if not wanted > 0.0:
        raise TorsadeError(f"a largest curvature of {kappa_max:g} 1/m is none; give one above 0.")

    found, before = near, (0.0, 0.0)
    root = min(wanted / (2.0 * math.pi), 0.5)
    for _ in range(MOST_SECANTS):
        try:
            now = bent(fiber, fiber.length * (1.0 - root * root), total_twist, found)
        except TorsadeError:
            root = 0.5 * (root + before[0])
            continue
        curvature = now.kappa_max * fiber.length
        if abs(curvature - wanted) <= ACCURACY * wanted:
            return now
        slope = (curvature - before[1]) / (root - before[0]) if root != before[0] else 0.0
        if slope <= 0.0:
            break
        found, before = now, (root, curvature)
        root = min(max(root + (wanted - curvature) / slope, 0.5 * root), 0.5 * (1.0 + root))
        if abs(root - before[0]) * root < 1e-15:  # distances nearer to each other are one number
            return now
    raise TorsadeError(
        f"no end distance is known that bends a fiber of length {fiber.length:g} m to a curvature of "
        f"{kappa_max:g} 1/m at a total twist of {total_twist:g} rad; give a smaller one."
    )


class Range(NamedTuple):
    """A curvature that follows from a measured distance [1/m], and the range that its error leaves."""

    value: float
    low: float
    high: float


def curvature_at_distance(
    fiber: Fiber, end_distance: float, total_twist: float = 0.0, error: float = 0.0
) -> Range:
    """Largest curvature of a fiber seen to break at an end distance [m], known within an error [m].

    The range is that between the two distances: curvature falls as the ends part, and steeply when the fiber
    is nearly straight, so that it is not symmetric. At a distance of the fiber's length there is none.

    Raises
    ------
    TorsadeError
        As by `bent`, for the distance itself and for the smaller one.
    """
    here = bent(fiber, end_distance, total_twist)
    if error == 0.0:
        return Range(here.kappa_max, here.kappa_max, here.kappa_max)
    high = bent(fiber, max(end_distance - error, 0.0), total_twist, here).kappa_max
    far = end_distance + error
    straight = far > fiber.length * (1.0 - STRAIGHT)
    low = 0.0 if straight else bent(fiber, far, total_twist, here).kappa_max
    return Range(here.kappa_max, low, high)


@lru_cache(maxsize=16)
def _device(edges: int, C: float, *, rotation_held: bool = False) -> Chain:
    """The twist device in units of L and B."""
    if edges < FEWEST_EDGES:
        raise TorsadeError(f"{edges} edges are too few for a bent fiber; give at least {FEWEST_EDGES}.")
    return chain(Fiber(edges=edges, C=C), (PIVOT, PIVOT), rotation_held=rotation_held)


def _arch(problem: Chain, d: float) -> Shape:
    """An arch over the distance d: its angle is a cosine, of which the mean direction is J_0."""
    s = np.clip(problem.assembly.edge_arclength, 0.0, 1.0)
    angle = float(brentq(lambda a: j0(a) - d, 0.0, 3.8)) * np.cos(math.pi * s)
    return shape_along(problem, np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle]))


def _planar(problem: Chain, d: float, controls: Controls) -> Shape:
    """The stable arch over the distance d, without twist."""
    near = _arch(problem, d)
    found = newton(problem, near, controls)
    if found is not None and unstable_modes(problem, found[1]) == 0:
        return found[0]
    return minimise(problem, near, controls)


def _followed(problem: Chain, shape: Shape, path: Path) -> Shape:
    """The shape at the end of a path, in one step if it is short."""
    at_once = carry(problem, shape, path)
    if at_once is not None:
        return at_once
    before = point = None
    for point in follow(problem, shape, path):
        if point.p == 1.0:
            return point.shape
        if point.tangent.p <= 0.0:
            break
        before = point
    if before is not None and point is not None and point.tangent.p <= 0.0:
        before = fold(problem, path, before, point)
        found = newton(problem, before.shape, path.stop) if before.p >= 1.0 else None
        if found is not None:
            return found[0]
    last = path.start if before is None else path.at(before.p)
    held = problem.rotation_held
    what = "grips turned by" if held else "a total twist of"
    asked, snaps = (math.degrees(c.rotation if held else c.torque / problem.C) for c in (path.stop, last))
    raise TorsadeError(
        f"no arch holds {what} {asked:.5g} deg at an end distance of {path.stop.value[0]:.5g} lengths: there "
        f"it snaps at {snaps:.4g} deg; give less twist."
    )


def _measured(fiber: Fiber, problem: Chain, shape: Shape, controls: Controls) -> Bent:
    """An equilibrium in the units of its fiber."""
    L = fiber.length
    x = L * np.concatenate([np.zeros((1, 3)), np.cumsum(shape.edge[1:-1], axis=0)])
    kappa = np.empty(len(problem.assembly.hinges))
    hinge_curvature(problem.assembly, _tangents(shape), kappa)
    return Bent(
        fiber=fiber,
        x=x,
        kappa=kappa / L,
        total_twist=problem.total_twist(shape),
        rotation=problem.rotation(shape),
        torque=fiber.B / L * shape.torque,
        shape=shape,
        controls=controls,
    )


def _tangents(shape: Shape) -> Floats:
    """Unit tangents (n_edges, 3), grips among them."""
    return np.asarray(shape.edge / np.linalg.norm(shape.edge, axis=1)[:, None])


def _force(problem: Chain, tangent: Floats, x: Floats, torque: float) -> Floats:
    """Force (3,) on the last end that balances moments best, M + x x F = const at all nodes x (n_nodes, 3).

    With M = B kb/lbar + M_t t. The reaction that holds the end of the discrete fiber is the exact slope of
    its energy, and a little larger, since |kb| = 2 tan(phi/2) grows faster than the angle phi: by a share of
    (kappa l)^2/4 in a sharp bend. Taken from moments the error is about ten times smaller.
    """
    a, b = tangent[:-1], tangent[1:]
    cosine = np.einsum("kc,kc->k", a, b)[:, None]
    kb = 2.0 * np.cross(a, b) / (1.0 + cosine)
    along = (a + b) / np.sqrt(2.0 * (1.0 + cosine))
    moment = problem.B * kb / problem.assembly.hinge_length[:, None] + torque * along
    unknown = np.zeros((len(x), 3, 6))
    unknown[:, :, :3] = np.cross(np.eye(3), x[:, None]).transpose(0, 2, 1) * -1.0
    unknown[:, :, 3:] = -np.eye(3)
    return np.asarray(np.linalg.lstsq(unknown.reshape(-1, 6), -moment.ravel(), rcond=None)[0][:3])
