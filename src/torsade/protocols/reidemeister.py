"""Reidemeister moves (thesis 4.3, Fig 4-2F): made on fibers by moving their ends, slowly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from torsade.errors import TorsadeError
from torsade.protocols.base import Positive
from torsade.protocols.pulled import Experiment, Pulled
from torsade.units import Length, Time, Whole

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.centerline import Centerline
    from torsade.motion.ends import Boundary
    from torsade.protocols.moves import Leg, Move
    from torsade.results import Result

__all__ = ["Reidemeister", "elastic_energy"]

USUAL_LENGTH, SHORTEST = 100.0, 40.0  # radii

VIEWS = ((0.0131, 0.0073, 1.0), (-0.0117, 0.0087, 1.0), (0.0091, -0.0139, 1.0))
"""From where crossings are counted: nearly along z, since along z symmetric strands meet node on node."""

_OWN = "reidemeister makes the strands that it moves, so there is no field {!r}; leave it out"


class Reidemeister(Pulled):
    """Make a Reidemeister move on fibers by moving their ends, and record what it costs.

    R1: a fiber with one loop lies at rest; its ends are drawn apart until the loop is gone. R2: an arc is
    slid over a straight strand until they cross twice, and set down. R3: three strands that cross each other
    are set down, and the one on top is slid over the crossing of the others.

    Grips hold the ends and their directions; before and after the move all grips lie in one plane. Moved
    slowly, a fiber is in equilibrium all along: double the duration to see whether it is.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Pulled.hints,
        **{name: _OWN.format(name) for name in ("knot", "centerline", "bend", "lead")},
        "force": "reidemeister moves ends at a given speed, so there is no field 'force'; leave it out",
        "speed": "there is no field 'speed'; give 'duration', the time that the move takes",
        "spin": "there is no field 'spin'; did you mean 'ends'?",
    }

    protocol: Literal["reidemeister"] = "reidemeister"
    move: Literal["R1", "R2", "R3"] = Field(
        description="Reidemeister move to make: R1 (a loop), R2 (two crossings) or R3 (a strand across a "
        "crossing)."
    )
    length: Annotated[Length, Positive] | None = Field(
        None,
        description="Free length of every strand, from grip to grip; by default 100 radii.",
        examples=["20 mm"],
    )
    ends: Literal["gripped", "swivel"] = Field(
        "gripped",
        description="Whether ends are kept from spinning about their tangent (gripped), or one of each "
        "strand spins freely (swivel).",
    )
    side: Literal["over", "under"] = Field(
        "over", description="On which side the moved strand passes; the two are mirror images."
    )
    material: str = Field(
        "optomechanical", description="Preset of the fiber: nylon, optomechanical, spaghetti or silicone."
    )
    duration: Annotated[Time, Positive] = Field(
        600.0, description="How long the whole move takes; four times as long for strands twice as long."
    )
    frames: Whole = Field(
        240,
        ge=1,
        le=1_000_000,
        description="Frames to record after the one at t = 0, evenly spaced: N of them end N intervals.",
    )

    @model_validator(mode="after")
    def _slender(self) -> Reidemeister:
        if self.free_length < SHORTEST * self.h:
            raise TorsadeError(
                f"a strand {1e3 * self.free_length:.4g} mm long is {self.free_length / self.h:.3g} radii; "
                f"give a length of at least {SHORTEST:g} radii, {1e3 * SHORTEST * self.h:.4g} mm"
            )
        return self

    @property
    def free_length(self) -> float:
        """Length L of every strand from grip to grip [m]."""
        return USUAL_LENGTH * self.h if self.length is None else self.length

    @property
    def shape_name(self) -> str:
        """The move."""
        return self.move

    def _plan(self) -> Move:
        """Strands at the start and the way of their ends, in units of the free length."""
        from torsade.protocols.moves import MOVES

        spacing = self.node_spacing
        assert spacing is not None
        return MOVES[self.move](self.h / self.free_length, spacing / self.free_length)

    @property
    def _to_metres(self) -> Floats:
        """Factors (3,) from the plan to space [m]; the mirror image has its heights turned over."""
        import numpy as np

        return self.free_length * np.array([1.0, 1.0, 1.0 if self.side == "over" else -1.0])

    def configuration(self) -> Centerline:
        """The strands of the move, checked, at the resolution of the run."""
        from torsade.centerline import Centerline, check
        from torsade.protocols.shapes import check_count

        spacing = self.node_spacing
        assert spacing is not None
        check_count(self.free_length / spacing)
        shape = Centerline(tuple(x * self._to_metres for x in self._plan().strands))
        check(shape, self.h)
        return shape

    def experiment(self, assembly: Assembly, state: State) -> Experiment:
        """Ends carried along their way, leg by leg; crossings seen along z counted."""
        import numpy as np

        legs = self._plan().legs
        starts = self.duration * np.cumsum([0.0, *(leg.share for leg in legs)])
        gone = self.free_length * np.cumsum([0.0, *(leg.travel for leg in legs)])
        first, *later = (self._carried(assembly, leg) for leg in legs)

        def measure(now: State) -> dict[str, float]:
            return {"crossings": float(_crossings(assembly, now))}

        def derive(history: Mapping[str, Floats]) -> dict[str, Floats]:
            return {"displacement": np.interp(history["time"], starts, gone)}

        return Experiment(
            first,
            measure,
            derive,
            lambda history, loose_at: {"move_from_s": float(starts[1]) if self.move == "R1" else 0.0},
            later=tuple(zip(starts[1:-1].tolist(), later, strict=True)),
        )

    def _carried(self, assembly: Assembly, leg: Leg) -> Boundary:
        """Grips that move at the speed of a leg."""
        from torsade.motion import ends

        boundary = ends.free(assembly)
        velocity = leg.way * self._to_metres / (leg.share * self.duration)
        for fiber, ways in enumerate(velocity):
            for end, v in enumerate(ways):
                spin = None if end == 1 and self.ends == "swivel" else 0.0
                boundary = ends.move(boundary, assembly, fiber, end, v, spin, tangent=True)
        return boundary

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`.

        Energies are all that is stored; energy_apart_J is that of the same strands lying apart: for R2 the
        bending energy of the arc at the start; for R1 and R3 they are straight, and have none.
        """
        data, attrs, spec = result.dataset, result.dataset.attrs, cls(**result.spec)
        B = spec.fiber_material.E_b * spec.section.I
        energy = elastic_energy(result)
        began = int(data["time"].searchsorted(attrs.get("move_from_s", 0.0) * (1 - 1e-9)))
        top = began + int(energy[began:].argmax())
        return {
            "protocol": "reidemeister",
            "move": spec.move,
            "ends": spec.ends,
            "preset": spec.preset,
            "length_m": spec.free_length,
            "B_over_L_J": B / spec.free_length,
            "times_s": data["time"].values.tolist(),
            "displacement_m": data["displacement"].values.tolist(),
            "crossings": [int(n) for n in data["crossings"].values],
            **{
                f"energy_{kind}_J": data[f"energy_{kind}"].values.tolist()
                for kind in ("stretch", "bend", "twist", "contact")
            },
            "energy_apart_J": float(energy[0]) if spec.move == "R2" else 0.0,
            "energy_start_J": float(energy[began]),
            "energy_top_J": float(energy[top]),
            "energy_end_J": float(energy[-1]),
            "top_at_m": float(data["displacement"][top]),
            "steps": attrs["steps"],
            "wall_s": attrs["wall_s"],
        }


def elastic_energy(result: Result) -> Floats:
    """Stored energy at every frame [J], that of contacts included, shape (n_frames,)."""
    data = result.dataset
    parts = [data[f"energy_{kind}"].values for kind in ("stretch", "bend", "twist", "contact")]
    total: Floats = sum(parts[1:], start=parts[0])
    return total


def _crossings(assembly: Assembly, now: State) -> int:
    """How many crossings are seen along z."""
    import numpy as np

    from torsade.topology.views import directional_crossing_number

    strands = np.split(now.x, assembly.node_start[1:-1])
    for view in VIEWS[:-1]:
        try:
            return directional_crossing_number(strands, False, view)
        except TorsadeError:
            continue
    return directional_crossing_number(strands, False, VIEWS[-1])
