"""Tighten (thesis 4.3): a knot in one strand is pulled by both of its ends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from torsade.protocols.base import Positive
from torsade.protocols.knotted import Knotted
from torsade.protocols.pulled import Experiment
from torsade.units import Force, Velocity

if TYPE_CHECKING:
    from torsade.assembly import Assembly, State
    from torsade.centerline import Centerline
    from torsade.results import Result

__all__ = ["Tighten"]


class Tighten(Knotted):
    """Pull the two ends of one knotted strand apart, along -x and +x, each with the same force.

    The end with the smaller x is pulled along -x. To see a knot come to rest, give `until_still`, and a
    duration that leaves it time: 10 s are enough for most knots.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Knotted.hints,
        "bend": "tighten pulls a knot in one strand; give a knot such as 'overhand', or run prison-escape",
        "length": "there is no field 'length'; a centerline is as long as given",
        "lead": "there is no field 'lead'; a built-in knot has the ends that it has, and so has a centerline",
        "pulled": "tighten pulls both ends, so there is no field 'pulled'; leave it out",
        "direction": "tighten pulls along -x and +x, so there is no field 'direction'; leave it out",
    }

    protocol: Literal["tighten"] = "tighten"
    knot: str | None = Field(
        None, description="Knot in one strand: overhand, figure-eight, overhand-7, open 8_20 and others."
    )
    centerline: str | None = Field(
        None,
        description="File of one strand (.csv, .xyz, .obj, .vect, .npz or .npy), in place of a knot.",
    )
    material: str = Field(
        "optomechanical", description="Preset of the fiber: nylon, optomechanical, spaghetti or silicone."
    )
    force: Annotated[Force, Positive] = Field(0.02, description="Force on each end.")
    until_still: Annotated[Velocity, Positive] | None = Field(
        None,
        description="End with the first frame in which no node is faster than this; by default go on for the "
        "whole duration.",
        examples=["1 um/s"],
    )

    @field_validator("knot")
    @classmethod
    def _known_knot(cls, name: str | None) -> str | None:
        if name is None:
            return None
        from torsade.knots.finding import known_strand

        return known_strand(name).name

    @model_validator(mode="after")
    def _bearable(self) -> Tighten:
        self.check_shape('give a knot such as "overhand", or a centerline, a file of one strand')
        self.check_strain(self.force)
        return self

    def configuration(self) -> Centerline:
        """One open strand, checked, at the resolution of the run."""
        from torsade.protocols.shapes import check_built, open_strands

        if self.knot is None:
            return open_strands(str(self.centerline), self, 1, "tighten pulls one strand by both its ends")
        from torsade.knots.tied import strand

        return check_built(strand(self.knot, self.h, spacing=self.node_spacing), self.h)

    def experiment(self, assembly: Assembly, state: State) -> Experiment:
        """Both ends pulled; their distance, the length, the greatest curvature and strain measured."""
        import numpy as np

        from torsade import observables
        from torsade.motion import ends

        last = len(state.x) - 1
        outward = np.array([1.0 if state.x[last, 0] >= state.x[0, 0] else -1.0, 0.0, 0.0])
        boundary = ends.pull(ends.free(assembly), assembly, 0, 0, -self.force * outward)
        boundary = ends.pull(boundary, assembly, 0, 1, self.force * outward)

        def measure(now: State) -> dict[str, float]:
            return {
                "end_to_end": float(np.linalg.norm(now.x[last] - now.x[0])),
                "length": float(observables.fiber_lengths(assembly, now)[0]),
                "h_kappa_max": float(observables.h_kappa(assembly, now, self.h).max()),
                "total_twist": float(observables.twist(assembly, now)[0]),
                "max_log_strain": float(observables.log_strain(assembly, now, self.h).max()),
            }

        def still(now: State) -> bool:
            return self.until_still is not None and observables.fastest(now) < self.until_still

        return Experiment(boundary, measure, lambda history: {}, lambda history, loose_at: {}, over=still)

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`."""
        data, attrs = result.dataset, result.dataset.attrs
        return {
            "protocol": "tighten",
            "knot": attrs["knot"],
            "preset": result.spec["preset"],
            "times_s": data["time"].values.tolist(),
            "end_to_end_m": data["end_to_end"].values.tolist(),
            "length_m": data["length"].values.tolist(),
            "h_kappa_max": data["h_kappa_max"].values.tolist(),
            "total_twist_rad": data["total_twist"].values.tolist(),
            "max_log_strain": data["max_log_strain"].values.tolist(),
            "still_at_s": attrs.get("over_at_s"),
            "steps": attrs["steps"],
            "wall_s": attrs["wall_s"],
        }
