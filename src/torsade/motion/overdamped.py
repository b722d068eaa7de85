"""Overdamped motion of knotted fibers: M(x) v = F(x), advanced in time (thesis 2.33, 4.1-4.11)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.arrays import Floats, Ints
from torsade.assembly import Assembly, State
from torsade.errors import TorsadeError
from torsade.material import Material, Section
from torsade.motion import scheme, stepping
from torsade.motion.ends import Boundary
from torsade.motion.moving import Outcome, check_saved
from torsade.motion.near import measure
from torsade.rod.contact import Model
from torsade.rod.factor import no_factor


@dataclass(frozen=True)
class Laws:
    """Which contact and drag laws act, and between which parts of a fiber.

    Attributes
    ----------
    area : contact area, `product` of rest lengths or `projected` edge vectors
    drag : collision drag, `continuum` (thesis 4.8) or `node-pair` (4.6, on present lengths)
    eta_f_ratio : collision viscosity over internal viscosity, eta_f / eta
    torque : whether collisions twist (thesis 4.7)
    spin_drag : whether collisions resist a strand's own spin (the omega term of thesis 4.7)
    bend_present : whether curvature counts per present arclength instead of rest arclength
    exclusion_edges : contacts are left out between edges at most so many apart on a fiber
    exclusion_radii : and between edges nearer than so many radii of rest arclength
    """

    area: Literal["product", "projected"] = "product"
    drag: Literal["continuum", "node-pair"] = "continuum"
    eta_f_ratio: float = 3.3
    torque: bool = True
    spin_drag: bool = True
    bend_present: bool = False
    exclusion_edges: int = 1
    exclusion_radii: float = math.pi


PUBLISHED = Laws("projected", "node-pair", 1.0, True, False, True, 10, 0.0)
"""The model of the thesis's own program (projected area, node-pair drag, ten-edge exclusion)."""

STANDARD = Laws()
"""The converging model: continuum drag with eta_f = 3.3 eta, contact wherever geometry allows it."""


def model(material: Material, section: Section, laws: Laws = STANDARD) -> Model:
    """Coefficients of all forces for a material, a circular section and a choice of laws.

    Raises
    ------
    TorsadeError
        When the material has no viscosity: overdamped motion needs eta > 0.
    """
    if not material.eta > 0:
        raise TorsadeError(
            f"material {material.name!r} has viscosity eta = {material.eta:g} Pa s; overdamped motion needs "
            'eta > 0: give one, for example eta = "1e5 Pa s".'
        )
    if not laws.eta_f_ratio > 0:
        raise TorsadeError(
            f"eta_f / eta is {laws.eta_f_ratio:g}; strands in contact need drag: give a ratio above 0."
        )
    eta_f = laws.eta_f_ratio * material.eta
    return Model(
        EA=material.E * section.A,
        B=material.E_b * section.I,
        C=material.mu * section.J,
        K=material.K,
        p0_squared=50.0,
        diameter=2 * section.h,
        eta_A=material.eta * section.A,
        eta_J=material.eta * section.J,
        eta_f_A=eta_f * section.A,
        eta_f_J=eta_f * section.J if laws.torque else 0.0,
        projected=laws.area == "projected",
        node_pair=laws.drag == "node-pair",
        spin_drag=laws.spin_drag,
        bend_present=laws.bend_present,
        exclusion_edges=laws.exclusion_edges,
        exclusion_length=laws.exclusion_radii * section.h,
    )


@dataclass(frozen=True)
class Stepping:
    """How time advances.

    Attributes
    ----------
    fixed_step : explicit Euler with this step [s]; 0 for error-controlled steps
    tolerance : local error allowed per step, in radii (positions) and radians (material angles)
    solver_tolerance : relative error, in dissipated power, of the mobility solve
    skin : how far beyond the diameter pairs are listed as contacts to come, in radii
    roam : how far nodes may go until neighbours are looked for anew, in radii
    move : farthest any node may go in one error-controlled step, in radii
    """

    fixed_step: float = 0.0
    tolerance: float = 1e-2
    solver_tolerance: float = 1e-5
    skin: float = 0.8
    roam: float = 1.6
    move: float = 0.2


NODE_STEPS_AT_ONCE = 60_000
"""Steps times nodes between looks at the screen and at Ctrl-C: about 0.2 s.

A number and not a time, since the stepper makes a new neighbour list whenever it is called, and runs must
repeat to the bit.
"""


class Energies(NamedTuple):
    """Stored energies [J]."""

    stretch: float
    bend: float
    twist: float
    contact: float

    @property
    def total(self) -> float:
        """Sum of all [J]."""
        return self.stretch + self.bend + self.twist + self.contact


class Measured(NamedTuple):
    """What a state tells: stored energies, forces between strands, and where they touch.

    compression is, over every edge, the sum of the contact forces on it [N] (thesis Fig 4-1B); contacts
    (n_contacts, 2) are the edges in contact. self_torque (n_edges,) [N] is what strands that slide past
    each other exert on an edge by collision drag, per rest length (thesis 4.10): by the law of the run,
    without the share of the edge's own spin.
    """

    energies: Energies
    compression: float
    contacts: Ints
    self_torque: Floats


class Checkpoint(NamedTuple):
    """Everything that decides how a run goes on, as float64 and int64 arrays."""

    state: State
    time: Floats
    counts: Ints


class Motion:
    """Fibers in overdamped motion: a state, what is done to it, and a clock.

    The boundary may be replaced between calls of `advance`. The state is advanced in place; calls that
    reach the same times from the same checkpoint give the same result, bit for bit.
    """

    def __init__(
        self,
        assembly: Assembly,
        model: Model,
        boundary: Boundary,
        state: State,
        how: Stepping | None = None,
    ) -> None:
        how = how or Stepping()
        radius = model.diameter / 2
        self.assembly = assembly
        self.model = model
        self.boundary = boundary
        self.state = state.copy()
        self.control = scheme.Control(
            how.fixed_step,
            how.tolerance * radius,
            radius,
            how.solver_tolerance,
            how.skin * radius,
            how.roam * radius,
            how.move * radius,
        )
        self._clock = stepping.Clock(np.zeros(5), np.zeros(5, np.int64), np.zeros(2, np.int64))
        self._scratch = scheme.stage_work(assembly)

    @property
    def time(self) -> float:
        """Present time [s]."""
        return float(self._clock.time[0])

    @property
    def external_work(self) -> float:
        """Work done on the fibers so far [J]."""
        return float(self._clock.time[2])

    @property
    def dissipation(self) -> float:
        """Energy lost to drag so far [J]."""
        return float(self._clock.time[3])

    @property
    def steps(self) -> int:
        """Completed steps."""
        return int(self._clock.count[0])

    @property
    def at_once(self) -> int:
        """Steps between looks at the screen and at Ctrl-C, about 0.2 s."""
        return max(1, NODE_STEPS_AT_ONCE // len(self.state.x))

    @property
    def counts(self) -> dict[str, int]:
        """Steps, refused steps, evaluations of the rates and neighbour lists made so far."""
        names = ("steps", "refused", "evaluations", "neighbour_lists")
        return dict(zip(names, (int(c) for c in self._clock.count), strict=False))

    def advance(self, until: float, max_steps: int = 2**62) -> Outcome:
        """Advance to the time until [s], in at most max_steps steps.

        Raises
        ------
        TorsadeError
            When strands would pass through each other (with the place), or no step is short enough.
        """
        status, begun = stepping.CROWDED, self.steps
        for factor in (no_factor(), ()):
            if status == stepping.CROWDED:
                status = stepping.advance(
                    self.assembly, self.model, self.boundary, self.control, self.state, self._clock,
                    float(until), max_steps + begun - self.steps, self._scratch, factor,
                )  # fmt: skip
        if status in (stepping.CROSSING, stepping.STUCK, stepping.UNSOLVABLE):
            raise TorsadeError(self._failure(status))
        return Outcome(status)

    def _failure(self, status: int) -> str:
        when = f"at t = {self.time:.6g} s"
        shorter = "shorter fixed step" if self.control.fixed_step > 0 else "smaller tolerance or finer nodes"
        if status == stepping.CROSSING:
            places = []
            for edge in self._clock.culprit:
                if edge >= len(self.assembly.edges):
                    places.append(f"skin {'ab'[edge - len(self.assembly.edges)]}")
                    continue
                fiber = int(self.assembly.edge_fiber[edge])
                place = 1e3 * self.state.x[self.assembly.edges[edge, 0]]
                at = ", ".join(f"{c:.2f}" for c in place)
                places.append(
                    f"edge {edge - self.assembly.edge_start[fiber]} of strand {fiber} (near {at} mm)"
                )
            return (
                f"{places[0]} would pass through {places[1]} {when}; strands must stay apart: "
                f"use a {shorter}, or a smaller force."
            )
        if status == stepping.STUCK:
            return f"no time step is short enough {when}; the motion is too violent: use a smaller force."
        return (
            f"the velocities cannot be solved for {when}; check forces and constraints, or use a {shorter}."
        )

    def measure(self) -> Measured:
        """Energies, compression, contacts and self-torque at the present state."""
        out, work = np.empty(5), self._scratch.work
        pairs = measure(self.assembly, self.model, self.boundary, self.state, work, out)
        energies = Energies(*(float(e) for e in out[:4]))
        return Measured(energies, float(out[4]), pairs, work.drag_torque / self.assembly.rest_length)

    def energies(self) -> Energies:
        """Stored energies at the present state."""
        return self.measure().energies

    def checkpoint(self) -> Checkpoint:
        """A copy of all that decides how the run goes on."""
        return Checkpoint(self.state.copy(), self._clock.time.copy(), self._clock.count.copy())

    def restore(self, checkpoint: Checkpoint) -> None:
        """Go back to a checkpoint of the same assembly."""
        self.state = checkpoint.state.copy()
        self._clock.time[:] = checkpoint.time
        self._clock.count[:] = checkpoint.counts

    def warm_up(self) -> None:
        """Compile or load every kernel, and leave no trace."""
        start = self.checkpoint()
        self.advance(0.0)
        self.measure()
        self.restore(start)

    def saved(self) -> dict[str, NDArray[Any]]:
        """Copies of the arrays that decide how the motion goes on, by name: a checkpoint."""
        state, time, counts = self.checkpoint()
        return state._asdict() | {"clock_time": time, "clock_counts": counts}

    def recover(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Go on from the arrays that `saved` gave."""
        check_saved(saved, self.saved())
        state = State(*(saved[name] for name in State._fields))
        self.restore(Checkpoint(state, saved["clock_time"], saved["clock_counts"]))
