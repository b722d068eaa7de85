"""What is measured on fibers: curvature, strain, twist, lengths, and the friction of a pulled bend.

Functions of an assembly and a state return arrays per hinge, node or fiber; functions of recorded
histories return numbers. Nothing here moves anything.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Floats
from torsade.assembly import Assembly, State
from torsade.material import Material, Section

__all__ = [
    "SETTLED",
    "Friction",
    "SurfaceStrain",
    "edge_lengths",
    "energy_density",
    "fastest",
    "fiber_lengths",
    "friction",
    "h_kappa",
    "hinge_curvature",
    "hinge_twist",
    "integral",
    "log_strain",
    "mean_torsion",
    "non_planarity",
    "pull_speed",
    "surface_strain",
    "surface_stress",
    "twist",
]

SETTLED = 0.3
"""Time [s] from which a pulled bend is taken to be tight: the start of the mean pull speed."""

SLIP_RATIO = 1.5
"""A bend slips when its ends part this many times faster than they did on average since `SETTLED`, for good.

Some bends speed up to about twice the mean and stay there while their tails pass, so that a ratio of 2
is met sooner or later by chance; with 1.5 slip times converge under refinement (docs/convergence.md).
"""


def edge_lengths(assembly: Assembly, state: State) -> Floats:
    """Present length of every edge [m], shape (n_edges,)."""
    return np.asarray(np.linalg.norm(_edge_vectors(assembly, state), axis=1))


def fiber_lengths(assembly: Assembly, state: State) -> Floats:
    """Present length of every fiber [m], shape (n_fibers,)."""
    return _sum_by_fiber(edge_lengths(assembly, state), assembly.edge_start)


def hinge_curvature(assembly: Assembly, state: State) -> Floats:
    """Curvature kappa = |kb|/lbar of every hinge per present arclength [1/m], shape (n_hinges,).

    |kb| = 2 tan(phi/2) with phi the turning angle; lbar is the mean present length of the two edges.
    """
    e = _edge_vectors(assembly, state)
    l = np.linalg.norm(e, axis=1)
    a, b = assembly.hinges[:, 0], assembly.hinges[:, 1]
    t = e / l[:, None]
    curvature_binormal = 2 * np.cross(t[a], t[b]) / (1 + np.sum(t[a] * t[b], axis=1))[:, None]
    return np.asarray(np.linalg.norm(curvature_binormal, axis=1) / (0.5 * (l[a] + l[b])))


def h_kappa(assembly: Assembly, state: State, radius: float) -> Floats:
    """Curvature in units of 1/h at every hinge, shape (n_hinges,); h is the radius [m]."""
    return radius * hinge_curvature(assembly, state)


def hinge_twist(assembly: Assembly, state: State) -> Floats:
    """Twist theta_b - theta_a + reference twist of every hinge [rad], shape (n_hinges,)."""
    a, b = assembly.hinges[:, 0], assembly.hinges[:, 1]
    return np.asarray(state.theta[b] - state.theta[a] + state.reference_twist)


def twist(assembly: Assembly, state: State) -> Floats:
    """Total twist of every fiber [rad], shape (n_fibers,)."""
    return _sum_by_fiber(hinge_twist(assembly, state), assembly.hinge_start)


class SurfaceStrain(NamedTuple):
    """The parts of the strain on the surface at every node, each of shape (n_nodes,), without unit.

    Attributes
    ----------
    stretch : |x'| - 1, averaged over the edges that meet at the node
    bend : h kappa, kappa per present length
    twist : h |theta'|/√2, theta' the hinge twist per rest length

    At the ends of an open fiber kappa and theta' are zero.
    """

    stretch: Floats
    bend: Floats
    twist: Floats

    @property
    def total(self) -> Floats:
        """√(eps:eps) where it is largest on the surface, √(twist² + (bend + stretch)²) (thesis 4.3)."""
        return np.hypot(self.twist, self.bend + self.stretch)

    @property
    def log(self) -> Floats:
        """True strain log(1 + √(eps:eps)), the measure that colours show (thesis 4.3)."""
        return np.log1p(self.total)


def surface_strain(assembly: Assembly, state: State, radius: float) -> SurfaceStrain:
    """Stretch, bend and twist on the surface at every node; radius is h [m]."""
    node = assembly.hinges[:, 2]
    bend = np.zeros(len(assembly.node_length))
    twisted = np.zeros_like(bend)
    bend[node] = h_kappa(assembly, state, radius)
    twisted[node] = radius * np.abs(hinge_twist(assembly, state)) / assembly.hinge_length / math.sqrt(2)
    extension = edge_lengths(assembly, state) / assembly.rest_length - 1
    ends, nodes = assembly.edges.ravel(), len(bend)
    total = np.bincount(ends, np.repeat(extension, 2), nodes)
    return SurfaceStrain(total / np.bincount(ends, minlength=nodes), bend, twisted)


def surface_stress(assembly: Assembly, state: State, material: Material, radius: float) -> Floats:
    """Von Mises stress at every hinge where it is largest on the surface [Pa], shape (n_hinges,).

    √(σ² + 3τ²) with σ = |E ε| + E_b h κ, of stretch ε and bending, and τ = μ h |θ'|, of twist; ε is the mean
    of the two edges, κ per present and θ' per rest length.
    """
    strain = edge_lengths(assembly, state) / assembly.rest_length - 1
    a, b = assembly.hinges[:, 0], assembly.hinges[:, 1]
    bend = material.E_b * h_kappa(assembly, state, radius)
    normal = np.abs(0.5 * material.E * (strain[a] + strain[b])) + bend
    shear = material.mu * radius * hinge_twist(assembly, state) / assembly.hinge_length
    return np.asarray(np.sqrt(normal**2 + 3 * shear**2))


def energy_density(assembly: Assembly, state: State, material: Material, section: Section) -> Floats:
    """Stretch, bending and twist energy per rest length at every node [J/m], shape (n_nodes,).

    Stretch is that of the edges that meet there; where a fiber ends it is all there is.
    """
    stretch = 0.5 * material.E * section.A * (edge_lengths(assembly, state) / assembly.rest_length - 1) ** 2
    ends, nodes = assembly.edges.ravel(), len(assembly.node_length)
    shared = np.repeat(0.5 * stretch * assembly.rest_length, 2)
    density = np.bincount(ends, shared, nodes) / assembly.node_length
    kappa = _rest_curvature(assembly, state)
    twist_density = hinge_twist(assembly, state) / assembly.hinge_length
    B, C = material.E_b * section.I, material.mu * section.J
    density[assembly.hinges[:, 2]] += 0.5 * (B * kappa**2 + C * twist_density**2)
    return density


def _rest_curvature(assembly: Assembly, state: State) -> Floats:
    """Curvature of every hinge per rest arclength [1/m], shape (n_hinges,)."""
    l = edge_lengths(assembly, state)
    a, b = assembly.hinges[:, 0], assembly.hinges[:, 1]
    present = 0.5 * (l[a] + l[b])
    return np.asarray(hinge_curvature(assembly, state) * present / assembly.hinge_length)


def log_strain(assembly: Assembly, state: State, radius: float) -> Floats:
    """Strain log(1 + √(eps:eps)) on the surface at every node, shape (n_nodes,); see `SurfaceStrain`."""
    return surface_strain(assembly, state, radius).log


def non_planarity(x: Floats) -> float:
    """Smallest over largest principal radius of gyration of nodes (n, 3): 0 in a plane, 1 as wide as long.

    Of a fiber that is nearly straight it is small too.
    """
    apart = x - x.mean(axis=0)
    squares = np.linalg.eigvalsh(apart.T @ apart)
    return math.sqrt(max(float(squares[0]), 0.0) / max(float(squares[2]), 1e-300))


def mean_torsion(x: Floats, radius: float) -> float:
    """Mean |torsion| of an open polyline (n, 3) times the radius h, weighted with the curvature squared.

    Torsion is the angle between the binormals at both ends of an edge over its length. What is straight has
    no weight; 0 in a plane.
    """
    e = np.diff(x, axis=0)
    l = np.linalg.norm(e, axis=1)
    t = e / l[:, None]
    b = np.cross(t[:-1], t[1:])
    size = np.linalg.norm(b, axis=1)
    across = np.linalg.norm(np.cross(b[:-1], b[1:]), axis=1)
    angle = np.arctan2(across, np.einsum("kc,kc->k", b[:-1], b[1:]))
    weight = size[:-1] * size[1:]
    return float(radius * (weight * angle / l[1:-1]).sum() / max(float(weight.sum()), 1e-300))


def fastest(state: State) -> float:
    """Speed of the fastest node [m/s]."""
    return float(np.linalg.norm(state.v, axis=1).max())


def pull_speed(time: ArrayLike, separation: ArrayLike) -> Floats:
    """Mean speed of parting over the interval that ends at each frame [m/s], shape (n,); nan at the first.

    Parameters
    ----------
    time : (n,) increasing [s]
    separation : (n,) distance of the pulled end from the clamped one, along the pull [m]
    """
    t, s = np.asarray(time, np.float64), np.asarray(separation, np.float64)
    speed = np.full(len(t), np.nan)
    speed[1:] = np.diff(s) / np.diff(t)
    return speed


def integral(time: ArrayLike, rate: ArrayLike) -> Floats:
    """Integral of a rate since the first frame, by the trapezoidal rule, shape (n,).

    Parameters
    ----------
    time : (n,) increasing [s]
    rate : (n,) at these times [something/s]
    """
    t, r = np.asarray(time, np.float64), np.asarray(rate, np.float64)
    return np.concatenate([[0.0], np.cumsum(0.5 * np.diff(t) * (r[1:] + r[:-1]))])


class Friction(NamedTuple):
    """How a bend resists: c_f, the mean pull speed v [m/s] behind it, and when it slipped [s] or None.

    c_f is None when the ends did not part. start [s] is the time from which v is the mean.
    """

    c_f: float | None
    speed: float
    slipped_at: float | None
    start: float


def friction(
    time: ArrayLike,
    separation: ArrayLike,
    *,
    force: float,
    radius: float,
    eta: float,
    loose_at: float | None = None,
) -> Friction:
    """Topological friction c_f = F 2h/(eta A v) of a pulled bend (thesis 4.6), and when it slips.

    v is the mean pull speed, separation difference over time, from 0.3 s to the end or to slipping.
    The bend slips when the pull speed exceeds 1.5 times the mean since 0.3 s (between frames, by linear
    interpolation of their ratio) and never again falls to that mean while the ends part by a diameter or
    more, or when nothing resists the pull any more, whichever is earlier. A bend that gives way for a moment
    and holds again has not slipped.
    When it slips before 0.3 s, or the history is no longer than that, v is the mean from the start.

    Parameters
    ----------
    time : (n,) increasing [s]
    separation : (n,) distance of the pulled end from the clamped one, along the pull [m]
    force : F [N]
    radius : h [m]; the area is A = pi h²
    eta : internal viscosity [Pa s]
    loose_at : when nothing resisted the pull any more [s], if that happened
    """
    t, s = np.asarray(time, np.float64), np.asarray(separation, np.float64)
    slipped = _slip(t, s, 2 * radius)
    if loose_at is not None and (slipped is None or loose_at < slipped):
        slipped = loose_at
    end = float(t[-1]) if slipped is None else slipped
    start = SETTLED if end > SETTLED * (1 + 1e-9) else float(t[0])
    if not end > start:
        return Friction(None, math.nan, slipped, start)
    first, last = np.interp([start, end], t, s)
    v = float((last - first) / (end - start))
    return Friction(2 * force / (eta * math.pi * radius * v) if v > 0 else None, v, slipped, start)


def _slip(t: Floats, s: Floats, diameter: float) -> float | None:
    """When a bend begins to slip for good [s]; t and s (n,) are its history, None while it holds.

    The pull speed passes `SLIP_RATIO` times the mean since `SETTLED`, never falls back to that mean, and the
    ends part by a diameter [m] more.
    """
    after = t > SETTLED * (1 + 1e-9)
    mean = (s - np.interp(SETTLED, t, s)) / np.where(after, t - SETTLED, np.inf)
    speed = pull_speed(t, s)
    ratio = np.where(after & (mean > 0), speed / np.where(mean > 0, mean, 1.0), 1.0)
    slowest = np.minimum.accumulate(speed[::-1])[::-1]  # from each time on
    begins = (ratio[1:] > SLIP_RATIO) & (ratio[:-1] <= SLIP_RATIO)
    begins &= (slowest[1:] > mean[1:]) & (s[-1] - s[1:] >= diameter)
    if not begins.any():
        return None
    k = int(np.argmax(begins)) + 1
    return float(t[k - 1] + (t[k] - t[k - 1]) * (SLIP_RATIO - ratio[k - 1]) / (ratio[k] - ratio[k - 1]))


def _edge_vectors(assembly: Assembly, state: State) -> Floats:
    return np.asarray(state.x[assembly.edges[:, 1]] - state.x[assembly.edges[:, 0]])


def _sum_by_fiber(values: Floats, start: ArrayLike) -> Floats:
    """Sums of consecutive values, offsets (n_fibers + 1,); a fiber without any sums to zero."""
    cumulative = np.concatenate([[0.0], np.cumsum(values)])
    return np.diff(cumulative[np.asarray(start)])
