"""How near to its strength a rod comes at its third break, and what other inertia of bending does to that.

Bending waves of wave number k have the frequency a k^2 (1 - beta k^2/2), a = h c_s/2. In the package beta is
l^2/6, of masses at nodes l apart. Here it is any: with rotary inertia beta = h^2/4 more, with shear after
Timoshenko as well (1 + 2 (1 + nu)/0.886) h^2/4 more, with mass spread along edges l^2/6 less. The matrix of
masses is then tridiagonal; everything else is as in the package, and with nothing added it is the package.

Writes its tables into docs/fracture.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from benchmarks import common
from benchmarks.breaking import PAGE
from torsade.fracture.cascade import Cascade, Fracture
from torsade.motion.grips import gripped
from torsade.motion.inertial import Inertial
from torsade.protocols import SnapTwist
from torsade.rod.elasticity import add_elastic_forces, hinge_twist
from torsade.rod.kinematics import carry_directors, edge_geometry, reference_twist_change

UNBREAKABLE = 1e30
TIMOSHENKO = 1 + 2 * 1.3 / 0.886
"""Of rotary inertia: with the shear of a circular section, nu = 0.3 (Cowper 1966)."""

FOLLOWED = 9e-4
"""Time [s], in which the third break comes and the waves of the second reach the grips."""


class Third(NamedTuple):
    """The largest stress over strength after the second break, if nothing more breaks, and when [s]."""

    ratio: float
    time: float


class Rod:
    """A rod after its first break that breaks when told to, with beta [m^2] added to that of its nodes."""

    def __init__(self, spec: SnapTwist, beta: float) -> None:
        shape, weakest = spec.limit(spec.twist)
        material, section = spec.fiber_material, spec.section
        a, state, boundary = gripped(shape.x, shape.grips, spec.twist)
        motion = Inertial(a, material, section, boundary, state, spec.step)
        never = Fracture(np.full(len(a.hinges), UNBREAKABLE))
        self.cascade = Cascade(motion, never, material, section)
        self.density, self.beta = material.rho * section.A, beta
        self.snap([weakest + 1])

    def snap(self, hinges: list[int]) -> None:
        """Break, and find what the new pieces weigh."""
        self.cascade.snap(hinges)
        m = self.cascade.motion
        a, n = m.assembly, len(m.assembly.node_length)
        ends = np.zeros((len(a.edges), n))
        rows = np.arange(len(a.edges))
        ends[rows, a.edges[:, 0]], ends[rows, a.edges[:, 1]] = -1.0, 1.0
        real = a.rest_length > 1e-6 * a.rest_length.max()
        mass = np.diag(m.inertia.mass)
        mass += (ends[real].T * (self.density * self.beta / a.rest_length[real])) @ ends[real]
        free = np.flatnonzero(~m.boundary.held)
        self.inverse = np.zeros((n, n))
        self.inverse[np.ix_(free, free)] = np.linalg.inv(mass[np.ix_(free, free)])
        between = ends @ self.inverse @ ends.T
        self.moves = np.flatnonzero(np.diag(between) > 0.0)
        self.ends, self.between = ends[self.moves], between[np.ix_(self.moves, self.moves)]
        self._forces()

    def _forces(self) -> None:
        """Forces, torques and tangents of the present state."""
        m = self.cascade.motion
        a, state, work = m.assembly, m.state, m.work
        edge_geometry(a, state.x, work.length, work.tangent)
        hinge_twist(state.theta, state.reference_twist, a.hinges, work.m)
        work.force[:], work.torque[:] = 0.0, 0.0
        B, C = m.rod.B, m.rod.C
        add_elastic_forces(
            a, 0.0, B, C, False, work.length, work.tangent, work.m, work.edge_force, work.force, work.torque
        )

    def _pulled(self, tangent: np.ndarray, pull: np.ndarray) -> np.ndarray:
        """What impulses along edges (n,) do to nodes (n_nodes, 3)."""
        return np.asarray(-self.inverse @ (self.ends.T @ (tangent * pull[:, None])))

    def step(self) -> None:
        """One step of the scheme of `torsade.motion.verlet`, masses coupled."""
        m = self.cascade.motion
        a, state, work, dt = m.assembly, m.state, m.work, m.rod.dt
        spins, l = ~m.boundary.turned, a.rest_length[self.moves]
        before = work.tangent.copy()
        tangent = before[self.moves]
        state.omega[spins] *= m.inertia.kept[spins]
        state.omega[spins] += 0.5 * dt * (work.torque / m.inertia.moment)[spins]
        state.v[:] += 0.5 * dt * self.inverse @ work.force
        state.x[:] += dt * state.v
        inverse = np.linalg.inv(self.between * (tangent @ tangent.T))
        for _ in range(30):
            over = 0.5 * (((self.ends @ state.x) ** 2).sum(1) / l - l)
            if np.abs(over / l).max() < m.rod.tolerance:
                break
            moved = self._pulled(tangent, inverse @ over)
            state.x[:] += moved
            state.v[:] += moved / dt
        state.theta[:] += dt * state.omega
        edge_geometry(a, state.x, work.length, work.new_tangent)
        reference_twist_change(a, before, work.new_tangent, work.change)
        state.reference_twist[:] += work.change
        carry_directors(a.edge_start, state.director, before, work.new_tangent)
        self._forces()
        tangent = work.tangent[self.moves]
        state.v[:] += 0.5 * dt * self.inverse @ work.force
        lost = (tangent * (self.ends @ state.v)).sum(1)
        state.v[:] += self._pulled(tangent, np.linalg.solve(self.between * (tangent @ tangent.T), lost))
        state.omega[spins] += 0.5 * dt * (work.torque / m.inertia.moment)[spins]
        state.omega[spins] *= m.inertia.kept[spins]
        m.clock.steps[0] += 1


def third(degrees: float, edges: int = 48, beta: float = 0.0, step: str = "1 us", **fields: Any) -> Third:
    """Stress over strength at the place of the third break; the second is made as the package makes it."""
    spec = SnapTwist(twist=f"{degrees} deg", edges=edges, step=step, **fields)
    rod, largest = Rod(spec, beta), Third(0.0, 0.0)
    cascade = rod.cascade
    while cascade.time < FOLLOWED:
        rod.step()
        a = cascade.motion.assembly
        along = a.edge_arclength[a.hinges[:, 0]] + 0.5 * a.rest_length[a.hinges[:, 0]]
        nearest = np.minimum(along, a.fiber_length[a.edge_fiber[a.hinges[:, 0]]] - along)
        ratio = np.where(nearest > spec.min_fragment * (1 + 1e-9), cascade.measure() / spec.sigma_c, 0.0)
        if len(cascade.breaks) >= 3:
            largest = max(largest, Third(float(ratio.max()), cascade.time))
        elif ratio.max() >= 1.0:
            first = a.hinge_start
            pieces = [slice(first[f], first[f + 1]) for f in range(len(first) - 1)]
            worst = [p.start + int(np.argmax(ratio[p])) for p in pieces]
            rod.snap([k for k in worst if ratio[k] >= 1.0])
    return largest


def inertias(edges: int, h: float = 7e-4) -> dict[str, float]:
    """beta [m^2] to be added, by what it stands for."""
    spread, rotary = -((0.24 / edges) ** 2) / 6, h**2 / 4
    return {
        "masses at nodes, as in the package": 0.0,
        "and rotary inertia": rotary,
        "and shear after Timoshenko": TIMOSHENKO * rotary,
        "mass spread along edges": spread,
        "and rotary inertia, ": spread + rotary,
        "and shear after Timoshenko, ": spread + TIMOSHENKO * rotary,
    }


def tables(found: dict[str, Any]) -> dict[str, str]:
    """Of the page, by the name of their marks."""
    names = list(next(iter(found["inertia"].values())))
    heads = ["at 120°", *(f"{n} edges" for n in found["inertia"])]
    body = [[name.strip(" ,"), *(f"{r[name][0]:.3f}" for r in found["inertia"].values())] for name in names]
    margin = [["largest stress", *(f"{r[0]:.3f}" for r in found["twist"].values())]]
    return {
        "third": common.table(["twist", *(f"{d}°" for d in found["twist"])], margin),
        "inertia": common.table(heads, body),
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/fracture.md as it is")
    given = options.parse_args(arguments)
    quick = given.quick
    meshes = {20: "2 us"} if quick else {50: "1 us", 100: "0.5 us"}
    degrees = (120,) if quick else range(80, 140, 10)
    found: dict[str, Any] = {
        "twist": {d: third(d, 20, step="2 us") if quick else third(d) for d in degrees},
        "inertia": {
            n: {name: third(120, n, beta, step, min_fragment="33 mm") for name, beta in inertias(n).items()}
            for n, step in meshes.items()
        },
    }
    text = tables(found)
    if not (quick or given.no_write):
        for name, table in text.items():
            common.put(table, PAGE, name)
    return common.show(found, list(text.values()), given.json)


if __name__ == "__main__":
    main()
