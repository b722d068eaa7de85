"""Bend and twist (thesis 3.4, 3.11): a straight fiber, twisted, whose ends are brought together, at rest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from torsade.errors import TorsadeError
from torsade.protocols.base import Positive
from torsade.protocols.still import Found, Still
from torsade.units import Angle, Length, Whole

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.motion.supports import Fiber
    from torsade.results import Result

__all__ = ["BendTwist"]

MOST_NODES = 20_001
"""The equilibrium of so many takes about a second."""


class BendTwist(Still):
    """Find the shape of a twisted fiber whose ends are brought together, as in the twist device.

    The fiber is inextensible. Each grip turns freely about an axis across the line of the ends, and both axes
    are parallel: end tangents stay in one plane. `twist` is the fiber's own, spread evenly along it; the
    angle between the grips is a little larger, and is reported; `rotation` gives that instead.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Still.hints,
        "force": "bend-twist finds the thrust, so there is no field 'force'; give 'end_distance'",
        "distance": "there is no field 'distance'; did you mean 'end_distance'?",
        "curvature": "bend-twist finds the curvature, so there is no field 'curvature'; give 'end_distance'",
        "knot": "bend-twist bends a straight fiber, so there is no field 'knot'; leave it out",
        "centerline": "bend-twist bends a straight fiber, so there is no field 'centerline'; give 'length'",
        "eta": "a fiber at rest does not feel its viscosity, so there is no field 'eta'; leave it out",
        "duration": "a fiber at rest has no time, so there is no field 'duration'; leave it out",
        "frames": "a fiber at rest has one frame, so there is no field 'frames'; leave it out",
    }

    protocol: Literal["bend-twist"] = "bend-twist"
    length: Annotated[Length, Positive] = Field(
        0.24, description="Length L of the fiber.", examples=["24 cm"]
    )
    end_distance: Annotated[Length, Field(ge=0)] = Field(
        description="Distance of the fiber's ends from each other.", examples=["19 cm"]
    )
    twist: Angle = Field(0.0, description="Total twist of the fiber, right-handed when positive.")
    rotation: Angle | None = Field(
        None, description="Angle between the grips, in place of the fiber's own twist."
    )
    material: str = Field(
        "spaghetti", description="Preset of the fiber: nylon, optomechanical, spaghetti or silicone."
    )
    nodes: Whole = Field(201, ge=5, le=MOST_NODES, description="Nodes, evenly spaced.")
    end_distance_error: Annotated[Length, Field(ge=0)] | None = Field(
        None,
        description="How far the distance may be off; the curvature's range follows. By default it is exact.",
        examples=["1 mm"],
    )

    @model_validator(mode="after")
    def _bent(self) -> BendTwist:
        if self.rotation is not None and self.twist != 0.0:
            raise TorsadeError(
                f"twist ({self.twist:g} rad) and rotation ({self.rotation:g} rad) are both given; give the "
                "fiber's own, twist, or the angle between the grips, rotation"
            )
        if self.E is not None:
            raise TorsadeError(
                "this fiber does not stretch, so E has no part in it; give E_b, Young's modulus in bending"
            )
        if self.length < 10 * self.h:
            raise TorsadeError(
                f"length {self.length:g} m is less than five diameters of a fiber of radius {self.h:g} m; "
                "give a longer fiber, or a thinner one"
            )
        if self.end_distance > self.length:
            raise TorsadeError(
                f"end_distance {self.end_distance:g} m is more than the fiber's length, {self.length:g} m, "
                "and it does not stretch; give a smaller distance"
            )
        return self

    @property
    def fiber(self) -> Fiber:
        """The fiber in edges."""
        from torsade.motion.supports import Fiber

        section, material = self.section, self.fiber_material
        B, C = material.E_b * section.I, material.mu * section.J
        return Fiber(self.length, self.nodes - 1, B, C)

    def solve(self) -> Found:
        from torsade.motion.equilibrium import bent, curvature_at_distance

        found = bent(self.fiber, self.end_distance, self.twist, rotation=self.rotation)
        a, state = found.assembled()
        last = self.nodes - 1
        numbers: dict[str, Any] = {
            "kappa_max_per_m": found.kappa_max,
            "kappa_middle_per_m": float(found.kappa[[last // 2, self.nodes // 2]].mean()),
            "kappa_end_per_m": float(found.kappa[0]),
            "thrust_N": found.thrust,
            "force_N": found.force.tolist(),
            "torque_N_m": found.torque,
            "end_rotation_rad": found.rotation,
            "out_of_plane_m": found.out_of_plane,
            "unstable_motions": found.unstable,
            "least_stiffness_N": found.stiffness(),
        }
        if self.end_distance_error is not None:
            within = curvature_at_distance(
                self.fiber, self.end_distance, found.total_twist, self.end_distance_error
            )
            numbers["kappa_max_range_per_m"] = [within.low, within.high]
        frame: dict[str, float | Floats] = {
            "position": state.x,
            "curvature": found.kappa,
            "twist": found.total_twist,
            "energy_bend": found.energy_bend,
            "energy_twist": found.energy_twist,
        }
        return Found(a, frame, numbers)

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`."""
        data, attrs, spec = result.dataset.isel(time=0), result.dataset.attrs, result.spec
        return {
            "protocol": "bend-twist",
            "length_m": spec["length"],
            "end_distance_m": spec["end_distance"],
            "twist_rad": float(data["twist"].values[0]),
            "kappa_max_per_m": attrs["kappa_max_per_m"],
            "kappa_max_range_per_m": attrs.get("kappa_max_range_per_m"),
            "kappa_middle_per_m": attrs["kappa_middle_per_m"],
            "kappa_end_per_m": attrs["kappa_end_per_m"],
            "thrust_N": attrs["thrust_N"],
            "force_N": attrs["force_N"],
            "torque_N_m": attrs["torque_N_m"],
            "end_rotation_rad": attrs["end_rotation_rad"],
            "out_of_plane_m": attrs["out_of_plane_m"],
            "stable": attrs["unstable_motions"] == 0,
            "unstable_motions": attrs["unstable_motions"],
            "least_stiffness_N": attrs["least_stiffness_N"],
            "energy_bend_J": float(data["energy_bend"]),
            "energy_twist_J": float(data["energy_twist"]),
            "nodes": spec["nodes"],
            "wall_s": attrs["wall_s"],
        }
