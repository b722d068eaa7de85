"""Fibers to test on and one way to evaluate their forces: the only place that knows kernel signatures."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from torsade.arrays import columns
from torsade.assembly import Assembly, State, assemble, initial_state
from torsade.material import Material, Section
from torsade.motion import rates as rates_module
from torsade.motion.ends import Boundary, free
from torsade.motion.overdamped import STANDARD, Laws, model
from torsade.rod.contact import Model, add_drag_torques, contacts_among
from torsade.rod.damping import apply_drag
from torsade.rod.factor import pattern
from torsade.rod.kinematics import edge_geometry
from torsade.rod.neighbours import edge_midpoints, neighbour_pairs

Floats = NDArray[np.float64]

TOY = Material("toy", E=1e3, E_b=1e3, nu=0.3, rho=1.0, eta=10.0)
"""A rubber whose internal relaxation time eta/E is 10 ms."""


def toy_model(h: float = 0.1, laws: Laws = STANDARD, **changes: float) -> Model:
    """Coefficients of fibers of radius h [m] made of TOY; changes replace fields of the model."""
    return model(TOY, Section(h), laws)._replace(**changes)


def random_strand(seed: int, n: int, l: float = 0.1, turn: float = 0.4) -> Floats:
    """An open polyline of n nodes, edges between 0.8 l and 1.2 l, turning by about `turn` at each node."""
    rng = np.random.default_rng(seed)
    t = rng.normal(size=3)
    steps = []
    for _ in range(n - 1):
        t = t / np.linalg.norm(t) + turn * rng.normal(size=3) / np.sqrt(3)
        steps.append(l * rng.uniform(0.8, 1.2) * t / np.linalg.norm(t))
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)]) + 0.1 * l * rng.normal(size=3)


def random_loop(seed: int, n: int, harmonics: int = 3) -> Floats:
    """A smooth random closed curve of size about 1, n nodes nearly evenly spaced."""
    rng = np.random.default_rng(seed)
    s = 2 * np.pi * np.arange(20 * n) / (20 * n)
    k = np.arange(1, harmonics + 1)
    c, d = rng.normal(size=(2, harmonics, 3)) / k[:, None] ** 1.0
    dense = np.cos(np.outer(s, k)) @ c + np.sin(np.outer(s, k)) @ d
    arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.roll(dense, -1, 0) - dense, axis=1))])
    at = np.interp(np.arange(n) * arc[-1] / n, arc, np.arange(20 * n + 1))
    s = 2 * np.pi * at / (20 * n)
    return np.cos(np.outer(s, k)) @ c + np.sin(np.outer(s, k)) @ d


def tangle(seed: int, closed: bool = True) -> tuple[Assembly, State, float]:
    """Two random fibers in contact with themselves and each other, and their radius h."""
    x, h = touching_loop(seed, 60, gap=1.5)
    other = x + 1.6 * h * np.array([0.3, 0.5, 0.81])
    strands = [x, other[:50]]
    a = assemble(strands, [closed, False])
    return a, initial_state(a, strands), h


def circle(n: int, radius: float) -> Floats:
    """A regular polygon whose edge midpoints lie on a circle of the given radius in the xy plane."""
    a = 2 * np.pi * (np.arange(n) - 0.5) / n
    outer = radius / np.cos(np.pi / n)
    return outer * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def straight(n: int, length: float, axis: int = 0, at: tuple[float, float, float] = (0, 0, 0)) -> Floats:
    """n evenly spaced nodes along an axis, the first one at the place given."""
    x = np.tile(np.array(at, dtype=float), (n, 1))
    x[:, axis] += np.linspace(0, length, n)
    return x


def touching_loop(seed: int, n: int, gap: float = 1.4) -> tuple[Floats, float]:
    """A random loop and the radius h for which its nearest strands are gap h apart."""
    x = random_loop(seed, n)
    mid = 0.5 * (x + np.roll(x, -1, axis=0))
    l = np.linalg.norm(x - np.roll(x, -1, axis=0), axis=1)
    arc = np.cumsum(l) - l / 2
    along = abs(arc[:, None] - arc)
    along = np.minimum(along, l.sum() - along)
    distance = np.linalg.norm(mid[:, None] - mid, axis=2)
    h = 1.0
    while (nearest := distance[along > np.pi * h].min(initial=np.inf)) < gap * h:
        h *= 0.98
    return x, min(h, nearest / gap)


def twist_closed(state: State, fiber_edges: slice, turns: float) -> State:
    """Turn the directors of a closed fiber steadily, so that its total twist grows by whole turns."""
    out = state.copy()
    n = fiber_edges.stop - fiber_edges.start
    assert turns == int(turns)
    angle = 2 * np.pi * turns / n
    assert abs(angle) < np.pi
    hinge = np.arange(fiber_edges.start, fiber_edges.stop)
    out.reference_twist[hinge] += angle
    return _rotated(out, fiber_edges, angle)


def _rotated(state: State, fiber_edges: slice, angle: float) -> State:
    tangent = np.roll(state.x[fiber_edges], -1, axis=0) - state.x[fiber_edges]
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    turn = angle * np.arange(len(tangent))[:, None]
    d = state.director[fiber_edges]
    state.director[fiber_edges] = np.cos(turn) * d + np.sin(turn) * np.cross(tangent, d)
    return state


class Probe:
    """Energies, forces and rates of a state at displaced nodes and angles, frames carried from the state.

    Velocities are solved for directly; with direct=False, by conjugate gradients.
    """

    def __init__(
        self,
        a: Assembly,
        m: Model,
        state: State,
        bc: Boundary | None = None,
        direct: bool = True,
    ) -> None:
        self.a, self.m, self.state, self.bc = a, m, state, bc or free(a)
        self.length, self.tangent = np.empty(len(a.edges)), columns(len(a.edges))
        edge_geometry(a, state.x, self.length, self.tangent)
        self.work = rates_module.rate_work(a)
        pairs = pairs_within(a, state.x, 3 * m.diameter, m.exclusion_edges, m.exclusion_length)
        self.contacts = contacts_among(pairs)
        edge_midpoints(state.x, a.edges, self.work.mid)
        made = pattern(a, self.contacts, self.work.mid, 3 * m.diameter, np.inf)
        self.factor = made if direct else ()

    def evaluate(self, x: Floats, theta: Floats) -> None:
        rates_module.forces(
            self.a, self.m, self.bc, x, theta, self.tangent, self.state.reference_twist,
            self.contacts, self.work,
        )  # fmt: skip

    def energies(self, x: Floats, theta: Floats) -> Floats:
        """Stretch, bend, twist and contact energy."""
        self.evaluate(x, theta)
        out = np.empty(4)
        rates_module.energies(self.a, self.m, self.contacts, self.work, out)
        return out

    def energy(self, x: Floats, theta: Floats) -> float:
        return float(self.energies(x, theta).sum())

    def forces(self, x: Floats, theta: Floats) -> tuple[Floats, Floats]:
        """Force on nodes and torque on edges."""
        self.evaluate(x, theta)
        return self.work.force.copy(), self.work.torque.copy()

    def rates(self, x: Floats, theta: Floats, tolerance: float = 1e-12) -> tuple[Floats, Floats, Floats]:
        """Node velocities, spins about the tangent, and rates of the material angles."""
        v, omega, angular = np.zeros_like(x), np.empty_like(theta), np.empty_like(theta)
        status = rates_module.rates(
            self.a, self.m, self.bc, x, theta, self.tangent, self.state.reference_twist,
            self.contacts, self.factor, tolerance, v, omega, angular, self.work,
        )  # fmt: skip
        assert status == rates_module.OK
        return v, omega, angular

    def powers(self, x: Floats, theta: Floats) -> tuple[float, float]:
        """External and dissipated power."""
        v, omega, _ = self.rates(x, theta)
        return rates_module.powers(self.a, self.m, self.bc, v, omega, self.contacts, self.work)

    def drag_forces(self, v: Floats, eta_A: float) -> Floats:
        """-M v of the couplings found last, with internal damping eta_A (0: collisions alone)."""
        out = np.empty_like(v)
        apply_drag(self.a, eta_A, self.contacts, v, out)
        return -out

    def drag_torques(self, v: Floats) -> tuple[Floats, Floats]:
        """Collision torques on edges that velocities v exert, and the weights that drag spins."""
        n = len(self.a.edges)
        torque, weight = np.zeros(n), np.zeros(n)
        add_drag_torques(self.a, self.m, v, self.work.tangent, self.contacts, torque, weight)
        return torque, weight

    def touching(self) -> NDArray[np.int64]:
        """Edge pairs (n, 2) found in contact last."""
        return self.contacts.edges[: self.contacts.count[0]].copy()

    def drag_matrix(self, x: Floats, theta: Floats) -> Floats:
        """M (n_nodes, n_nodes), one column at a time; the same for every component."""
        self.rates(x, theta)
        n = len(self.a.node_length)
        matrix, out = np.empty((n, n)), np.empty((n, 3))
        for i in range(n):
            v = np.zeros((n, 3))
            v[i] = 1.0
            apply_drag(self.a, self.m.eta_A, self.contacts, v, out)
            assert np.ptp(out, axis=1).max() == 0.0
            matrix[:, i] = out[:, 0]
        return matrix


def midpoints(a: Assembly, x: Floats) -> Floats:
    mid = np.empty((len(a.edges), 3))
    edge_midpoints(x, a.edges, mid)
    return mid


def pairs_within(a: Assembly, x: Floats, cutoff: float, edges: int, length: float) -> NDArray[np.int64]:
    return neighbour_pairs(a, midpoints(a, x), cutoff, edges, length)


def gradient(energy, x: Floats, step: float) -> Floats:
    """Fourth-order central differences of a scalar function of an array."""
    out = np.empty_like(x)
    for index in np.ndindex(*x.shape):
        values = []
        for k in (-2, -1, 1, 2):
            y = x.copy()
            y[index] += k * step
            values.append(energy(y))
        out[index] = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step)
    return out


def three_cases(n: int = 12, l: float = 0.1) -> list[tuple[Assembly, State]]:
    """An open fiber, a closed fiber and an assembly of both kinds, bent and twisted at random."""
    loop = 0.3 * random_loop(5, n)
    sets = [
        ([random_strand(1, n, l)], [False]),
        ([loop], [True]),
        (
            [random_strand(2, n, l), 0.3 * random_loop(6, n) + 0.1, random_strand(3, n, l)],
            [False, True, False],
        ),
    ]
    cases = []
    for k, (strands, closed) in enumerate(sets):
        rng = np.random.default_rng(k)
        at_rest = assemble(strands, closed)
        rest = at_rest.rest_length * rng.uniform(0.8, 1.2, len(at_rest.rest_length))
        a = assemble(strands, closed, np.split(rest, at_rest.edge_start[1:-1]))
        state = initial_state(a, strands)
        state.theta[:] += rng.normal(size=len(state.theta))
        cases.append((a, state))
    return cases


def writhe(x: Floats) -> float:
    """Writhe of a closed polygon, exactly: the Gauss integral of every two edges in closed form.

    Klenin and Langowski (2000), method 1a, each spherical quadrilateral cut into two triangles of van
    Oosterom and Strackee (1983), which loses no digits where arcsines do.
    """
    p, q = x, np.roll(x, -1, axis=0)
    n, total = len(x), 0.0
    i, j = np.array([(i, j) for i, j in combinations(range(n), 2) if (i - j) % n not in (1, n - 1)]).T
    a, b, c, d = (
        r / np.linalg.norm(r, axis=1, keepdims=True)
        for r in (p[j] - p[i], q[j] - p[i], q[j] - q[i], p[j] - q[i])
    )
    for u, v, w in ((a, b, c), (a, c, d)):
        dot = [np.einsum("ij,ij->i", r, s) for r, s in ((u, v), (v, w), (w, u))]
        triple = np.einsum("ij,ij->i", u, np.cross(v, w))
        total += 2 * np.arctan2(triple, 1 + dot[0] + dot[1] + dot[2]).sum()
    return float(-2 * total / (4 * np.pi))


def total_twist(a: Assembly, state: State) -> float:
    """Sum of the twist of all hinges [rad]."""
    m = state.theta[a.hinges[:, 1]] - state.theta[a.hinges[:, 0]] + state.reference_twist
    return float(m.sum())
