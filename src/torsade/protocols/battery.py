"""Battery (thesis chapter 5): a closed, twisted knot comes to rest, is cut, and discharges."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from torsade.errors import TorsadeError
from torsade.protocols.base import SILENT, Driven, Positive, Progress, Trial
from torsade.units import Number, Time, Viscosity, Whole

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.motion.overdamped import Laws, Motion, Stepping
    from torsade.protocols.charging import Charge
    from torsade.results import Result
    from torsade.rod.contact import Model

__all__ = ["KINDS", "SHARES", "Battery", "even_twist_energy"]

KINDS = ("bend", "twist", "stretch", "contact")
"""Kinds of energy that a battery stores."""

SHARES = (50, 10, 1)
"""Per cents of the energy just after the cut, down to which discharge times are measured."""

NODES_PER_RADIUS = 2
"""Of rest length, unless a number of nodes is given; see the study in docs/batteries.md."""

FARTHEST_NODES = 1.5
"""Greatest distance of nodes at the start [radii]."""

NEIGHBOURS = 2.5
"""Contacts are left out between edges nearer than this along the fiber [radii].

Twist bends a fiber to h kappa > 1, where nothing in rod theory keeps it from being crushed and neighbours
would pass through each other. With this they touch from h kappa = 0.9 on, and below it nothing changes.
"""

LONGEST = 100.0
"""Longest times of charging and of discharging [T_0]."""

LARGEST_STRETCH = 0.5
"""Beyond which neither linear elasticity nor a rest length means anything."""

FIRST_FRAME, FIRST_SAMPLE = 1e-3, 1e-4
"""Times of the first frame and the first sample after t = 0 [T_0]."""

SAMPLES = 240
"""Evenly spaced in the logarithm of time."""


def even_twist_energy(twist: float, nu: float) -> float:
    """Energy [E_0] of a fiber that is twisted evenly and does nothing else, pi/(8 (1 + nu)) (h theta')^2.

    From (5.1) of the thesis; twist is h theta'.
    """
    return math.pi / (8 * (1 + nu)) * twist**2


class Battery(Driven):
    """Tie a closed knot, twist it, let it come to rest with its link conserved, cut it and let it discharge.

    Time begins with the cut. The fiber starts as the tight knot, scaled to its length or stretched from it,
    evenly twisted. Collisions do not twist it. Units of time and energy are T_0 = 2 L eta/(h E_b) and
    E_0 = E_b h^2 L.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Driven.hints,
        "rho": "overdamped motion has no inertia, so there is no field 'rho'; leave it out",
        "length": "there is no field 'length'; give 'slenderness', L/h",
        "force": "nothing pulls a battery, so there is no field 'force'; leave it out",
        "spacing": "there is no field 'spacing'; give 'nodes'",
        "uncut": "there is no field 'uncut'; give 'stop', with the value charged",
        "centerline": "there is no field 'centerline'; give a knot by name or by a code",
        "time": "there is no field 'time'; did you mean 'duration'?",
    }

    protocol: Literal["battery"] = "battery"
    knot: str = Field(
        description="Closed knot by name or code: 4_1, m3_1, 3_1#4_1, or unknot for a ring.",
    )
    twist: Annotated[Number, Field(ge=-10, le=10)] = Field(
        0.0, description="Twist density at the start times the radius, h theta'.", examples=["1.0"]
    )
    stop: Literal["discharged", "charged"] = Field(
        "discharged",
        description="How far to go: discharged, the fiber is cut and followed until it is empty; or charged, "
        "it comes to rest and is not cut.",
    )
    cut_at: Annotated[Number, Field(ge=0, lt=1)] | None = Field(
        None,
        description="Where to cut, as a share of the fiber from its first node on; by default where the "
        "stress is largest.",
        examples=["0.25"],
    )
    slenderness: Annotated[Number, Field(ge=10, le=2000)] = Field(
        50.0, description="Rest length over radius, L/h.", examples=["50"]
    )
    material: str = Field(
        "silicone", description="Preset of the fiber: nylon, optomechanical, spaghetti or silicone."
    )
    eta: Annotated[Viscosity, Positive] | None = Field(
        None, description="Internal viscosity; by default the material's."
    )
    eta_f_ratio: Annotated[Number, Positive] = Field(
        0.1, description="Collision viscosity over internal viscosity, eta_f/eta.", examples=["0.1"]
    )
    nodes: Annotated[Whole, Field(ge=16, le=10_000)] | None = Field(
        None, description="Nodes of the closed fiber; by default two for every radius of length."
    )
    tolerance: Annotated[Number, Positive] | None = Field(
        None,
        description="Error allowed per step, in radii and radians; by default 1e-2.",
        examples=["1e-3"],
    )
    noise: Annotated[Number, Field(ge=0, le=0.2)] = Field(
        0.01,
        description="Smooth random displacement of the shape at the start, in radii; by it a fiber leaves "
        "shapes that are at rest but not stable.",
        examples=["0.01"],
    )
    seed: Whole = Field(0, ge=0, le=2**63 - 1, description="Of that displacement.")
    charging: Annotated[Time, Positive] | None = Field(
        None,
        description="Longest time to come to rest before the cut; by default 100 T_0.",
        examples=["10 s"],
    )
    duration: Annotated[Time, Positive] | None = Field(
        None, description="Longest time to follow it after the cut; by default 100 T_0.", examples=["10 s"]
    )
    frames: Whole = Field(
        60,
        ge=1,
        le=1_000_000,
        description="Frames to record after the one at t = 0, evenly spaced in the logarithm of time; fewer "
        "if it is empty before the longest time.",
    )

    @field_validator("knot")
    @classmethod
    def _known_knot(cls, name: str) -> str:
        from torsade.knots.finding import known_closed

        return known_closed(name)

    @model_validator(mode="after")
    def _movable(self) -> Battery:
        if not self.fiber_material.eta > 0:
            raise TorsadeError(
                f"material {self.material!r} has no viscosity, and overdamped motion needs one; give eta, "
                'for example "1e4 Pa s"'
            )
        if self.stop == "charged" and (self.cut_at is not None or self.duration is not None):
            what = "cut_at" if self.cut_at is not None else "duration"
            raise TorsadeError(
                f"with 'charged' for stop nothing is cut, so {what} means nothing; leave it out"
            )
        return self

    @property
    def fiber_length(self) -> float:
        """Rest length L [m]."""
        return self.slenderness * self.h

    @property
    def unit_time(self) -> float:
        """T_0 = 2 L eta/(h E_b) [s]."""
        return 2 * self.slenderness * self.fiber_material.eta / self.fiber_material.E_b

    @property
    def unit_energy(self) -> float:
        """E_0 = E_b h² L [J]."""
        return self.fiber_material.E_b * self.h**2 * self.fiber_length

    @property
    def lasting(self) -> float:
        return LONGEST * self.unit_time if self.duration is None else self.duration

    @property
    def laws(self) -> Laws:
        """Contact and drag: chapter 4's, without collision torques."""
        from torsade.motion.overdamped import Laws

        return Laws(eta_f_ratio=self.eta_f_ratio, torque=False, exclusion_radii=NEIGHBOURS)

    @property
    def stepping(self) -> Stepping:
        """How time advances."""
        from torsade.motion.overdamped import Stepping

        return Stepping() if self.tolerance is None else Stepping(tolerance=self.tolerance)

    @property
    def node_count(self) -> int:
        """Nodes of the closed fiber."""
        return round(NODES_PER_RADIUS * self.slenderness) if self.nodes is None else self.nodes

    def meaning(self) -> dict[str, Any]:
        laws, stepping, material = (
            dataclasses.asdict(part) for part in (self.laws, self.stepping, self.fiber_material)
        )
        del material["source"]
        own = {"fiber_length": self.fiber_length, "nodes": self.node_count}
        return {"material": material, "radius": self.h, "laws": laws, "stepping": stepping, **own}

    def tied(self) -> tuple[Assembly, State]:
        """The closed fiber at the start: tied, twisted, and not yet at rest.

        Raises
        ------
        TorsadeError
            When the fiber is too short for the knot, or its nodes are too far apart.
        """
        import numpy as np

        from torsade.assembly import assemble, initial_state, twisted
        from torsade.centerline import Centerline, check
        from torsade.knots.loops import MIRROR, tight_loop
        from torsade.protocols.charging import trembled

        loop, n, L = tight_loop(self.knot), self.node_count, self.fiber_length
        stretch = loop.ropelength / self.slenderness - 1
        if stretch > LARGEST_STRETCH:
            least = loop.ropelength / (1 + LARGEST_STRETCH)
            raise TorsadeError(
                f"{self.knot} is tight at L/h = {loop.ropelength:.1f}, and a fiber with slenderness "
                f"{self.slenderness:g} would be stretched by {100 * stretch:.0f} %; give a slenderness of at "
                f"least {least:.1f}"
            )
        apart = max(1.0, 1 + stretch) * self.slenderness / n
        if apart > FARTHEST_NODES:
            raise TorsadeError(
                f"{n} nodes are {apart:.2g} radii apart, and strands could slip through; give at least "
                f"{math.ceil(n * apart / FARTHEST_NODES)} nodes"
            )
        # What is done to a knot is done to its mirror image mirrored: the tremor too.
        sides = MIRROR if loop.mirrored else np.ones(3)
        x = loop.fiber(L * max(1.0, 1 + stretch), n)
        x = trembled(x * sides, self.noise * self.h, self.seed) * sides
        check(Centerline((x,), (True,)), self.h)
        assembly = assemble([x], [True], [np.full(n, L / n)])
        return assembly, twisted(assembly, initial_state(assembly, [x]), self.twist / self.h)

    def model(self) -> Model:
        """Coefficients of all forces."""
        from torsade.motion.overdamped import model

        return model(self.fiber_material, self.section, self.laws)

    def charged(self, tell: Progress = SILENT) -> tuple[Motion, Charge]:
        """The closed fiber at rest, and how it came there."""
        from torsade.motion import ends
        from torsade.motion.overdamped import Motion
        from torsade.protocols.charging import charge

        assembly, state = self.tied()
        motion = Motion(assembly, self.model(), ends.free(assembly), state, self.stepping)
        unit = self.unit_time
        longest = LONGEST * unit if self.charging is None else self.charging
        try:
            return motion, charge(motion, self.fiber_material, self.section, unit, longest, tell)
        except KeyboardInterrupt:
            raise KeyboardInterrupt("while the battery was charged, which is always done anew") from None

    def trial(self) -> Trial:
        return self.prepared(SILENT)

    def prepared(self, tell: Progress) -> Trial:
        import numpy as np

        from torsade.protocols.battery_numbers import Units, concluded
        from torsade.protocols.discharge import NAMES, SAMPLED, Discharge, hinge_at, hinge_to_cut
        from torsade.protocols.driving import READY
        from torsade.protocols.shapes import check_count, check_frames

        check_count(self.node_count)
        check_frames(self.frames + 1, self.node_count + 1)
        tell(0.0, READY)
        closed, charge = self.charged(tell)
        a = closed.assembly
        if self.cut_at is None:
            hinge = hinge_to_cut(a, closed.state, self.fiber_material, self.h)
        else:
            hinge = hinge_at(a, self.cut_at)
        material, section = self.fiber_material, self.section
        cut = Discharge(a, closed.state, hinge, self.model(), material, section, self.stepping)
        fixed = {f"charge_{name}": (_dims(name), values) for name, values in charge.history.items()}
        place = float(a.rest_length[: a.hinges[hinge, 2]].sum() / a.fiber_length[0])
        at_cut = {"steps": closed.steps, "place": place, **closed.energies()._asdict()}
        units = Units(self.unit_time, self.unit_energy)
        return Trial(
            cut,
            NAMES,
            cut.frame,
            lambda samples, loose_at: concluded(units, self.knot, samples, charge, at_cut, cut),
            sizes={"fiber": 1, "node": self.node_count + 1, "edge": self.node_count},
            fixed=fixed
            | {
                "node_start": ("fiber_bound", np.array([0, self.node_count + 1])),
                "closed": ("fiber", np.array([False])),
            },
            start=hashlib.sha256(cut.motion.state.x.tobytes()).hexdigest(),
            sampled=SAMPLED,
            sample=cut.sample,
            about={"knot": self.knot},
            frame_times=self._times(FIRST_FRAME, self.frames),
            sample_times=self._times(FIRST_SAMPLE, SAMPLES),
        )

    def _times(self, first: float, count: int) -> Floats:
        """0, and from first [T_0] on evenly spaced in the logarithm; 0 alone where nothing is cut [s]."""
        import numpy as np

        if self.stop == "charged":
            return np.zeros(1)
        begin = min(first * self.unit_time, 0.1 * self.lasting)
        return (
            np.concatenate([[0.0], np.geomspace(begin, self.lasting, count)])
            if count > 1
            else np.array([0.0, self.lasting])
        )

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`."""
        from torsade.protocols.battery_numbers import reported

        return reported(result)


def _dims(name: str) -> tuple[str, ...]:
    """Dimensions of an array that is recorded while a battery is charged."""
    from torsade.variables import VARIABLES

    return VARIABLES[f"charge_{name}"][0]
