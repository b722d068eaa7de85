"""What the protocols of straight rods in inertial motion have in common: the rod, and how it breaks."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from torsade.errors import TorsadeError
from torsade.material import Material
from torsade.protocols.base import Driven, Positive
from torsade.units import Density, Length, Number, Pressure, Rate, Time, Whole, rounded

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.fracture.cascade import Cascade
    from torsade.motion.ends import Boundary
    from torsade.motion.equilibrium import Bent
    from torsade.results import Result

__all__ = ["Breakable", "Rod"]


class Rod(Driven):
    """A specification of one straight, inextensible rod in inertial motion."""

    hints: ClassVar[Mapping[str, str]] = {
        **Driven.hints,
        "knot": "this protocol takes a straight rod, so there is no field 'knot'; leave it out",
        "centerline": "this protocol takes a straight rod, so there is no field 'centerline'; give 'length'",
        "eta": "inertial motion damps twist alone, so there is no field 'eta'; give 'twist_damping'",
        "nodes": "there is no field 'nodes'; give 'edges', one less",
        "spacing": "there is no field 'spacing'; give 'edges', length over spacing",
        "dt": "there is no field 'dt'; did you mean 'step'?",
        "fixed_step": "there is no field 'fixed_step'; did you mean 'step'?",
        "L": "there is no field 'L'; did you mean 'length'?",
    }

    material: str = Field(
        "spaghetti", description="Preset of the rod: nylon, optomechanical, spaghetti or silicone."
    )
    length: Annotated[Length, Positive] = Field(0.24, description="Length L of the rod.", examples=["24 cm"])
    rho: Annotated[Density, Positive] | None = Field(None, description="Density; by default the material's.")
    twist_damping: Annotated[Rate, Field(ge=0)] | None = Field(
        None, description="Damping b of twist; by default the material's.", examples=["1.68e4 1/s"]
    )
    edges: Whole = Field(48, ge=4, le=2000, description="Number of edges that the rod is made of.")
    step: Annotated[Time, Positive] | None = Field(
        None,
        description="Time step; by default 1 us, or half the longest stable one where that is less.",
        examples=["1 us"],
    )

    @property
    def fiber_material(self) -> Material:
        """The named material with constants given in place of its own; E is E_b too if that is not given."""
        material = super().fiber_material
        return (
            material if self.E is None or self.E_b is not None else dataclasses.replace(material, E_b=self.E)
        )

    def check_slender(self) -> None:
        """Refuse a rod that is thicker than rod theory allows."""
        if self.length < 20 * self.h:
            raise TorsadeError(
                f"a rod of length {1e3 * self.length:.4g} mm and radius {1e3 * self.h:.4g} mm is too thick "
                "to be a rod; give a length of at least 20 radii"
            )

    def check_step(self, steps_of: float) -> None:
        """Refuse a step that frames, so far apart [s], would fall within."""
        apart = self.lasting / self.frames
        if apart < steps_of:
            raise TorsadeError(
                f"{self.frames} frames in {self.lasting:.4g} s are {apart:.3g} s apart, less than a step of "
                f"{steps_of:.3g} s; give fewer frames, or a shorter step"
            )

    def meaning(self) -> dict[str, Any]:
        material = dataclasses.asdict(self.fiber_material)
        del material["source"]
        return {"material": material, "radius": self.h}


class Breakable(Rod):
    """A specification of a rod that breaks."""

    hints: ClassVar[Mapping[str, str]] = {
        **Rod.hints,
        "lambda": "there is no field 'lambda'; did you mean 'min_fragment'?",
        "strength": "there is no field 'strength'; did you mean 'sigma_c'?",
        "bending": "the rod is bent until it breaks; give 'sigma_c', the stress at which it does",
    }

    sigma_c: Annotated[Pressure, Positive] = Field(
        1.9e7,
        description="Stress sigma_c at which the rod breaks by the criterion effective; other criteria get "
        "the strength that gives the same limit curvature without twist.",
        examples=["19 MPa"],
    )
    criterion: Literal[
        "effective", "von_mises", "von_mises_printed", "max_principal", "max_principal_printed"
    ] = Field(
        "effective",
        description="What the stress is made of: effective, von_mises, max_principal, or one of the last two "
        "as printed in the thesis, von_mises_printed, max_principal_printed.",
    )
    min_fragment: Annotated[Length, Field(ge=0)] = Field(
        0.03, description="Length lambda that pieces exceed.", examples=["30 mm"]
    )
    disorder: Annotated[Number, Field(ge=0, le=0.5)] = Field(
        0.0, description="Standard deviation of the strength along the rod, in sigma_c.", examples=["0.05"]
    )
    seed: Whole = Field(0, ge=0, le=2**63 - 1, description="Which rod, where there is disorder.")
    pieces: Literal["moving", "frozen"] = Field(
        "moving",
        description="What pieces do that no end holds: moving, they go on and may break again; or frozen.",
    )

    @model_validator(mode="after")
    def _breakable(self) -> Breakable:
        self.check_slender()
        if self.edges % 2:
            raise TorsadeError(
                f"edges is {self.edges}; give an even number, so that a node lies in the middle of the rod"
            )
        if self.min_fragment > self.length:
            raise TorsadeError(
                f"min_fragment is {1e3 * self.min_fragment:.4g} mm, more than the whole rod of "
                f"{1e3 * self.length:.4g} mm; give a shorter one"
            )
        return self

    @property
    def least_fragment(self) -> float:
        """The length that pieces exceed [m]."""
        return self.min_fragment

    @property
    def wave_time(self) -> float:
        """When the peak of the bending wave from a break in the middle reaches the ends (thesis 3.21) [s]."""
        from torsade.fracture.rod import Rod as BrokenRod
        from torsade.fracture.theory.scales import bending_time

        return bending_time(BrokenRod.of(self.fiber_material, self.h, self.length), self.length / 2)

    def strengths(self, rest_length: Floats) -> Floats:
        """Strength of every hinge by the criterion chosen [Pa], shape (n_hinges,)."""
        from torsade.fracture.cascade import strengths
        from torsade.fracture.criteria import matching_strength

        bears = matching_strength(self.sigma_c, self.criterion)
        return strengths(rest_length, bears, self.disorder, self.seed, 2 * self.h)

    def limit(self, total_twist: float) -> tuple[Bent, int]:
        """The rod of that total twist [rad] bent until a hinge comes to its strength, and which one does."""
        import numpy as np

        from torsade.fracture.limit import breaking_shape, rod_fiber

        material, section = self.fiber_material, self.section
        fiber = rod_fiber(material, section, self.length, self.edges)
        strength = self.strengths(np.full(self.edges, self.length / self.edges))
        return breaking_shape(fiber, material, section, total_twist, strength, self.criterion)

    def cascade(
        self, assembly: Assembly, state: State, boundary: Boundary, followed: float = math.inf
    ) -> Cascade:
        """The rod in this state, held so, and what makes it break; followed [s] after its first break."""
        from torsade.fracture.cascade import Cascade, Fracture
        from torsade.motion.inertial import Inertial

        material, section = self.fiber_material, self.section
        motion = Inertial(assembly, material, section, boundary, state, self.step)
        self.check_step(motion.rod.dt)
        frozen = self.pieces == "frozen"
        fracture = Fracture(self.strengths(assembly.rest_length), self.criterion, self.least_fragment, frozen)
        return Cascade(motion, fracture, material, section, followed)

    def conclusion(self, cascade: Cascade, at_limit: Mapping[str, float]) -> dict[str, Any]:
        """Numbers and lists of a cascade that is over, for the attributes of its result."""
        breaks = cascade.breaks
        return {
            **at_limit,
            "fragments": len(cascade.lengths),
            "lengths_m": cascade.lengths.tolist(),
            "break_times_s": [b.time for b in breaks],
            "break_places_m": [b.place for b in breaks],
            "break_stress_ratios": [b.ratio for b in breaks],
            "break_curvatures_per_m": [b.kappa for b in breaks],
            "break_twist_densities_rad_per_m": [b.twist_density for b in breaks],
        }

    def at_limit(self, kappa: float, twist_density: float, end_distance: float) -> dict[str, float]:
        """What is said of the moment before the first break; Li = mu theta'/(E kappa) (thesis 3.3)."""
        material = self.fiber_material
        return {
            "critical_curvature_per_m": kappa,
            "end_distance_m": end_distance,
            "li": material.mu * twist_density / (material.E_b * kappa),
        }

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`; what never came is None."""
        spec, attrs = result.spec, result.dataset.attrs
        named = zip(
            *(attrs[f"break_{what}"] for what in ("times_s", "places_m", "stress_ratios")), strict=True
        )
        return {
            "protocol": result.protocol,
            "criterion": spec["criterion"],
            **{key: attrs.get(key) for key in ("critical_curvature_per_m", "end_distance_m", "li")},
            "fragments": attrs["fragments"],
            "lengths_m": [rounded(length) for length in attrs["lengths_m"]],
            "breaks": [
                {"time_s": rounded(t), "place_m": rounded(x), "stress_ratio": ratio} for t, x, ratio in named
            ],
            "duration_s": float(result.dataset["time"].values[-1]),
            "steps": attrs["steps"],
            "wall_s": attrs["wall_s"],
        }
