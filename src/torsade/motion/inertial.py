"""Inertial motion of inextensible fibers with damped twist: the Kirchhoff equations of thesis 3.1.

    rho A x_tt = F_s,     rho J (omega_t + 2 b omega) = (C theta')_s + ...,     |x_s| = 1

Bending and twist are stored as everywhere in this package. Nodes carry mass, edges the rotary inertia rho J l
of their spin. That of bending, rho I, is left out, as in thesis 3.5, and with it the couple rho J omega t_t
of the spin's turning axis. At wavelength lambda rotary inertia slows bending waves by (pi^2/2) (h/lambda)^2,
edges of length l by (pi^2/3) (l/lambda)^2.

Ends are those of `torsade.motion.ends`: free, hinged (`clamp`), clamped (with tangent=True), or moved.
A clamp holds the edge at the end, so that the fiber bends from the middle of that edge on; with
`torsade.motion.grips` it bends from its very end.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.arrays import Floats
from torsade.assembly import Assembly, State, doubled, split
from torsade.errors import TorsadeError
from torsade.material import Material, Section
from torsade.motion import verlet
from torsade.motion.ends import Boundary
from torsade.motion.moving import Outcome, check_saved

__all__ = ["Energies", "Inertial", "longest_step"]

STEP = 1e-6
"""Longest time step that is taken unless one is given [s], as in the thesis (3.10)."""

SAFETY = 0.5
"""The same as a share of the longest stable one."""

TOLERANCE = 1e-12
"""How far edges may be off their lengths, as a share of them."""


NODE_STEPS_AT_ONCE = 2_000_000
"""Steps times nodes that take about 0.2 s."""


class Energies(NamedTuple):
    """Energies [J]: of moving nodes, of spins, of bending and of twist."""

    kinetic: float
    spin: float
    bend: float
    twist: float

    @property
    def total(self) -> float:
        """Sum of all [J]."""
        return self.kinetic + self.spin + self.bend + self.twist


def longest_step(assembly: Assembly, material: Material, section: Section, boundary: Boundary) -> float:
    """Longest stable step [s], 2 over the highest frequency that the shortest edge l that moves holds.

    Of twist waves that is 2 c_theta/l, c_theta = sqrt(mu/rho); of bending waves 4 sqrt(B/rho A)/l^2, and up
    to twice that at free ends, whose nodes carry half a mass.
    """
    l = _shortest(assembly, boundary)
    twist = 2 * math.sqrt(material.mu / material.rho) / l
    bend = 8 * math.sqrt(material.E_b * section.I / (material.rho * section.A)) / l**2
    return 2 / max(twist, bend, 1e-300)


def _shortest(assembly: Assembly, boundary: Boundary) -> float:
    """Length of the shortest edge that moves [m], infinite if there is none."""
    moves = ~boundary.held[assembly.edges].all(axis=1)
    return float(assembly.rest_length[moves].min(initial=math.inf))


class Inertial:
    """Inextensible fibers in inertial motion: a state, what is done to it, and a clock that counts steps.

    The boundary may be replaced between calls of `advance`. Steps all have one length, so that what is
    looked at on the way changes nothing; times asked for are rounded up to whole steps.

    Parameters
    ----------
    step : [s]; by default `STEP`, or `SAFETY` times the longest stable one where that is less
    attached_moment : (n_edges,) moments of inertia of what turns along with edges [kg m^2], by default none
    damped_moment : (n_edges,) moments of what is damped [kg m^2], by default those of the fiber

    Raises
    ------
    TorsadeError
        For closed fibers, and for a step that is not stable.
    """

    def __init__(
        self,
        assembly: Assembly,
        material: Material,
        section: Section,
        boundary: Boundary,
        state: State,
        step: float | None = None,
        *,
        tolerance: float = TOLERANCE,
        attached_moment: Floats | None = None,
        damped_moment: Floats | None = None,
    ) -> None:
        if assembly.closed.any():
            raise TorsadeError(
                f"fiber {int(np.argmax(assembly.closed))} is closed, and only open fibers move with inertia; "
                "cut it open"
            )
        longest = longest_step(assembly, material, section, boundary)
        dt = min(STEP, SAFETY * longest) if step is None else step
        if not 0 < dt < longest:
            raise TorsadeError(
                f"a step of {dt:.3g} s is not stable with edges of "
                f"{1e3 * _shortest(assembly, boundary):.3g} mm; give one above 0 and below {longest:.3g} s, "
                "or fewer nodes"
            )
        moment = material.rho * section.J * assembly.rest_length
        self.assembly = assembly
        total = moment if attached_moment is None else moment + attached_moment
        self.rod = verlet.Rod(material.E_b * section.I, material.mu * section.J, dt, tolerance)
        self.inertia = verlet.Inertia(
            material.rho * section.A * assembly.node_length,
            total,
            np.exp(
                -material.twist_damping * dt * (moment if damped_moment is None else damped_moment) / total
            ),
        )
        self.boundary = boundary
        self.state = state.copy()
        self.clock = verlet.Clock(np.zeros(2, np.int64), np.zeros(1))
        self.work = verlet.verlet_work(assembly)

    @property
    def time(self) -> float:
        """Present time [s]."""
        return self.steps * self.rod.dt

    @property
    def steps(self) -> int:
        """Completed steps."""
        return int(self.clock.steps[0])

    @property
    def iterations(self) -> int:
        """Iterations of the projection onto edge lengths so far."""
        return int(self.clock.steps[1])

    @property
    def at_once(self) -> int:
        """Steps that take about 0.2 s."""
        return max(1, NODE_STEPS_AT_ONCE // len(self.state.x))

    @property
    def dissipation(self) -> float:
        """Energy lost to twist damping so far [J]."""
        return float(self.clock.dissipation[0])

    def steps_until(self, time: float) -> int:
        """The number of steps after which it is that time [s] or just later."""
        return math.ceil(time / self.rod.dt * (1 - 1e-12) - 1e-9)

    def advance(self, until: float, max_steps: int = 2**62) -> Outcome:
        """Advance to the first step at the time until [s] or after, in at most max_steps steps.

        Raises
        ------
        TorsadeError
            When edges cannot keep their lengths: held ends are driven too far apart, or nodes too fast.
        """
        status = verlet.advance(
            self.assembly, self.rod, self.inertia, self.boundary, self.state, self.clock,
            self.steps_until(until), max_steps, self.work,
        )  # fmt: skip
        self.check(status)
        return Outcome(status)

    def check(self, status: int) -> None:
        """Raise for a status that ends a run."""
        if status == verlet.STRETCHED:
            raise TorsadeError(
                f"the fibers cannot keep their lengths after t = {self.time:.6g} s; drive held ends less far "
                "apart or more slowly, or use a shorter step"
            )

    def warm_up(self) -> None:
        """Compile or load every kernel, and leave no trace."""
        kept = self.saved()
        self.advance(self.time)
        self.energies()
        self.recover(kept)

    def energies(self) -> Energies:
        """Energies at the present state."""
        out = np.empty(4)
        verlet.energies(self.assembly, self.rod, self.inertia, self.state, self.work, out)
        return Energies(*(float(e) for e in out))

    def split(self, hinge: int) -> None:
        """Cut a fiber at a hinge: both sides keep their velocities; each node has its half edge's mass."""
        node = int(self.assembly.hinges[hinge, 2])
        density = self.inertia.mass[node] / self.assembly.node_length[node]
        state, bc, mass = self.state, self.boundary, doubled(self.inertia.mass, node)
        self.assembly = split(self.assembly, hinge)
        mass[node : node + 2] = density * self.assembly.node_length[node : node + 2]
        twist = np.delete(state.reference_twist, hinge)
        self.state = state._replace(x=doubled(state.x, node), v=doubled(state.v, node), reference_twist=twist)
        self.boundary = bc._replace(
            held=doubled(bc.held, node), velocity=doubled(bc.velocity, node), force=doubled(bc.force, node)
        )
        self.inertia = self.inertia._replace(mass=mass)
        self.work = verlet.verlet_work(self.assembly)

    def saved(self) -> dict[str, NDArray[Any]]:
        """Copies of the arrays that decide how the motion goes on, by name."""
        clock = {"clock_steps": self.clock.steps.copy(), "clock_dissipation": self.clock.dissipation.copy()}
        return self.state.copy()._asdict() | clock

    def recover(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Go on from the arrays that `saved` gave, of the same fibers."""
        check_saved(saved, self.saved())
        self.state = State(*(saved[name].copy() for name in State._fields))
        self.clock.steps[:] = saved["clock_steps"]
        self.clock.dissipation[:] = saved["clock_dissipation"]
