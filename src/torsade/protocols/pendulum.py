"""Torsion pendulum (thesis 3.2): a mass hangs on a rod, turns back and forth, and tells mu and b."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from torsade.errors import TorsadeError
from torsade.protocols.base import Positive, Trial
from torsade.protocols.rods import Rod
from torsade.units import Angle, Length, Mass, Time, Whole

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.motion.inertial import Inertial
    from torsade.results import Result

__all__ = ["Pendulum"]

SWINGS = 10
"""Periods that are followed unless a duration is given."""


class Pendulum(Rod):
    """Hang a cylinder on a rod, turn it, let it go, and find frequency, decay, mu and b from its swings.

    The upper end is clamped. Damping acts along the rod, and along the height of the cylinder if one is
    given, as if the rod went through it.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Rod.hints,
        "angle": "there is no field 'angle'; did you mean 'turn'?",
        "inertia": "there is no field 'inertia'; give 'mass' and 'mass_radius' of the cylinder",
    }

    pictured: ClassVar[bool] = False

    protocol: Literal["pendulum"] = "pendulum"
    mass: Annotated[Mass, Positive] = Field(0.02, description="Mass of the cylinder.", examples=["20 g"])
    mass_radius: Annotated[Length, Positive] = Field(
        0.01, description="Radius of the cylinder.", examples=["10 mm"]
    )
    mass_height: Annotated[Length, Field(ge=0)] = Field(
        0.0, description="Height h_0 of the cylinder, along which twist is damped too.", examples=["15 mm"]
    )
    turn: Annotated[Angle, Field(gt=0, lt=100)] = Field(
        math.pi / 4, description="Angle that the cylinder is turned at first.", examples=["45 deg"]
    )
    edges: Whole = Field(20, ge=4, le=2000, description="Number of edges that the rod is made of.")
    frames: Whole = Field(
        400,
        ge=1,
        le=1_000_000,
        description="Frames to record after the one at t = 0, evenly spaced: N of them end N intervals.",
    )
    duration: Annotated[Time, Positive] | None = Field(
        None, description="How long to follow it; by default 10 periods.", examples=["2 s"]
    )

    @model_validator(mode="after")
    def _swings(self) -> Pendulum:
        self.check_slender()
        rod = self.fiber_material.rho * self.section.J * self.length
        if self.moment < 10 * rod:
            raise TorsadeError(
                f"the cylinder's moment of inertia is {self.moment:.3g} kg m^2, less than ten times the "
                f"rod's {rod:.3g}; give more mass or mass_radius"
            )
        return self

    @property
    def moment(self) -> float:
        """Moment of inertia I_0 of the cylinder about its axis [kg m^2]."""
        return 0.5 * self.mass * self.mass_radius**2

    @property
    def stiffness(self) -> float:
        """Torque per angle of the rod, mu J/L [N m]."""
        return self.fiber_material.mu * self.section.J / self.length

    @property
    def lasting(self) -> float:
        period = 2 * math.pi * math.sqrt(self.moment / self.stiffness)
        return SWINGS * period if self.duration is None else self.duration

    def trial(self) -> Trial:
        motion = self.hanging()
        self.check_step(motion.rod.dt)
        edge = len(motion.assembly.edges) - 1

        def angle() -> dict[str, float]:
            return {"angle": float(motion.state.theta[edge] - motion.state.theta[0])}

        def frame() -> dict[str, float | Floats]:
            energies = motion.energies()
            return {
                "time": motion.time,
                **angle(),
                "energy_spin": energies.spin,
                "energy_twist": energies.twist,
                "dissipation": motion.dissipation,
            }

        return Trial(
            motion,
            ("time", "angle", "energy_spin", "energy_twist", "dissipation"),
            frame,
            lambda samples, loose_at: self._concluded(samples),
            sizes={},
            fixed={},
            start=hashlib.sha256(motion.state.theta.tobytes()).hexdigest(),
            sampled=("angle",),
            sample=angle,
        )

    def hanging(self) -> Inertial:
        """The rod, evenly twisted and at rest; its last edge, the grip below, carries the cylinder."""
        import numpy as np

        from torsade.motion.grips import gripped
        from torsade.motion.inertial import SAFETY, Inertial, longest_step

        material, section = self.fiber_material, self.section
        down = np.array([0.0, 0.0, -1.0])
        x = np.outer(np.linspace(0.0, self.length, self.edges + 1), down)
        assembly, state, boundary = gripped(x, (down, down), self.turn)
        boundary.turned[-1] = False
        attached = np.zeros(len(assembly.edges))
        attached[-1] = self.moment
        damped = material.rho * section.J * assembly.rest_length
        damped[-1] += material.rho * section.J * self.mass_height
        step = self.step or SAFETY * longest_step(assembly, material, section, boundary)
        return Inertial(
            assembly, material, section, boundary, state, step, attached_moment=attached, damped_moment=damped
        )

    def _concluded(self, samples: Mapping[str, Floats]) -> dict[str, float]:
        """Frequency and decay by least squares, and what they say of the rod."""
        from torsade.fracture.pendulum import fit_swing

        swing = fit_swing(samples["time"], samples["angle"])
        omega, decay = swing.omega, swing.decay
        material, section = self.fiber_material, self.section
        spring = self.moment * (omega**2 + decay**2)
        drag = 2 * self.moment * decay
        along = self.length / 3 + self.mass_height
        return {
            "frequency_Hz": omega / (2 * math.pi),
            "period_s": 2 * math.pi / omega,
            "decay_per_s": decay,
            "swings_to_half": math.log(2) * omega / (2 * math.pi * decay) if decay > 0 else math.inf,
            "moment_kg_m2": self.moment,
            "mu_Pa": spring * self.length / section.J,
            "twist_damping_per_s": drag / (2 * material.rho * section.J * along),
        }

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`."""
        data, attrs = result.dataset, result.dataset.attrs
        names = ("frequency_Hz", "period_s", "decay_per_s", "swings_to_half", "moment_kg_m2", "mu_Pa")
        numbers = {name: attrs.get(name) for name in (*names, "twist_damping_per_s")}
        return {
            "protocol": "pendulum",
            **{k: v if v is not None and math.isfinite(v) else None for k, v in numbers.items()},
            "times_s": data["time"].values.tolist(),
            "angle_rad": data["angle"].values.tolist(),
            "steps": attrs["steps"],
            "wall_s": attrs["wall_s"],
        }
