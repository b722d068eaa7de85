"""Suture (thesis chapter 6): two throws around a wound are pulled tight, and draw its sides together."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from torsade.errors import QuantityError, TorsadeError, quoted
from torsade.protocols.base import Positive, Trial
from torsade.protocols.pulled import COMMON, Experiment, Pulled, fixed_of, sizes_of
from torsade.units import Angle, Force, Length, Number, Stiffness, Time, Velocity, Whole, evenly

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.centerline import Centerline
    from torsade.knots.stitch import Stitch
    from torsade.results import Result

__all__ = ["SIX", "Suture", "tau_of"]

SIX: Mapping[str, str] = MappingProxyType(
    {
        "3,-3": "reef",
        "5,-3": "surgeon's",
        "3,-5": "reversed surgeon's",
        "5,-5": "double",
        "3,3": "granny",
        "5,3": "surgeon's granny",
    }
)
"""Names of the sutures that are compared, by their throws."""

USUAL_SKIN, USUAL_GAP = 10.0, 5.0  # radii
THINNEST = 5.0  # radii
MOST_TURNS = 15


def turns_of(throws: str) -> tuple[int, int]:
    """Half turns of the throw tied first and of that on it, from numbers or one of the names in `SIX`.

    Raises
    ------
    QuantityError
        When the text is neither two odd numbers up to 15, negative where left-handed, nor a name.
    """
    by_name = {_plain(name): numbers for numbers, name in SIX.items()}
    throws = by_name.get(_plain(throws), throws)
    found = re.fullmatch(r"\s*([+-]?\d{1,9})\s*,\s*([+-]?\d{1,9})\s*", throws.replace("−", "-"))
    if found is None:
        raise QuantityError(
            f"{quoted(throws)} is not two numbers; give half turns such as 5,-3, with a comma, or a "
            f"name: {', '.join(SIX.values())}"
        )
    turns = int(found[1]), int(found[2])
    for n in turns:
        if n % 2 == 0:
            raise QuantityError(f"{quoted(throws)} has {n} half turns; a throw has an odd number, such as 3")
        if abs(n) > MOST_TURNS:
            raise QuantityError(
                f"{quoted(throws)} has a throw of {abs(n)} half turns; give {MOST_TURNS} at most"
            )
    return turns


def _plain(name: str) -> str:
    """A name of a suture without case, genitive and the word knot."""
    return re.sub(r"'?s\b|\bknot$", "", name.strip().lower().replace("’", "'")).strip()


def tau_of(bottom: int, top: int) -> float:
    """Twist fluctuation 1 - (Wr/N)^2 of two throws (thesis 4.12 and chapter 6)."""
    return 1 - ((bottom + top) / (abs(bottom) + abs(top))) ** 2


class Suture(Pulled):
    """Tie a suture of two throws around two sides of a wound, and pull its two ends.

    The sides of the wound are cylinders along z that springs hold; the loop of the suture lies around both.
    Both ends are pulled with the same force, to the left and to the right.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Pulled.hints,
        "knot": "there is no field 'knot'; give 'throws', such as 5,-3",
        "centerline": "a suture is made for its wound, so there is no field 'centerline'; give 'throws'",
        "lead": "there is no field 'lead'; ends are drawn out of the loop",
        "stiffness": "there is no field 'stiffness'; did you mean 'skin_stiffness'?",
        "direction": "there is no field 'direction'; give 'angle', of the pull above the skin",
    }

    protocol: Literal["suture"] = "suture"
    throws: str = Field(
        description="Pair of odd numbers, half turns of the throw tied first and of that on it, negative "
        "where left-handed: 3,-3 is the reef knot, 3,3 the granny, 5,-3 the surgeon's knot; or such a name.",
        examples=["5,-3"],
    )
    material: str = Field(
        "optomechanical", description="Preset of the fiber: nylon, optomechanical, spaghetti or silicone."
    )
    force: Annotated[Force, Positive] = Field(0.01, description="Force F_P on each end.")
    angle: Annotated[Angle, Field(ge=0, le=1.571)] = Field(
        math.pi / 6,
        description="Of the pull above the skin: 0 is apart along it, 90 deg away from the wound.",
        examples=["30 deg"],
    )  # fmt: skip
    skin_radius: Annotated[Length, Positive] | None = Field(
        None, description="Radius h_s of the cylinders of skin; by default 10 radii of the fiber.",
        examples=["2 mm"],
    )  # fmt: skip
    gap: Annotated[Length, Positive] | None = Field(
        None, description="Gap of the wound at rest; by default 5 radii of the fiber.", examples=["1 mm"]
    )
    skin_stiffness: Annotated[Stiffness, Positive] = Field(
        20.0, description="Stiffness k_s of the spring that holds each side of the skin."
    )
    skin_relaxation: Annotated[Time, Positive] = Field(
        0.1, description="Time in which skin alone goes back to rest, zeta/k_s."
    )
    skin_drag: Annotated[Number, Field(ge=0)] = Field(
        1.0, description="Collision drag of fiber on skin over that of fiber on fiber."
    )
    friction: Annotated[Number, Field(ge=0, le=10)] = Field(
        0.0, description="Coefficient of dry friction of fiber on skin."
    )
    friction_speed: Annotated[Velocity, Positive] = Field(
        1e-6, description="Speed far below which dry friction holds."
    )
    duration: Annotated[Time, Positive] = Field(10.0, description="How long to pull.")
    release: Annotated[Time, Field(ge=0)] = Field(
        0.0, description="How long to go on with both ends let go, to see whether the knot holds."
    )
    frames: Whole = Field(
        100,
        ge=2,
        le=1_000_000,
        description="Frames to record after the one at t = 0, the end of the pull among them.",
    )

    @field_validator("throws")
    @classmethod
    def _known_throws(cls, throws: str) -> str:
        return "{},{}".format(*turns_of(throws))

    @model_validator(mode="after")
    def _bearable(self) -> Suture:
        self.check_strain(self.force)
        if self.h_s < THINNEST * self.h:
            raise TorsadeError(
                f"skin of radius {1e3 * self.h_s:.4g} mm is {self.h_s / self.h:.3g} radii of the fiber; give "
                f"a skin_radius of at least {THINNEST:g} radii, {1e3 * THINNEST * self.h:.4g} mm"
            )
        return self

    @property
    def turns(self) -> tuple[int, int]:
        """Half turns of the throw tied first and of that on it."""
        return turns_of(self.throws)

    @property
    def h_s(self) -> float:
        """Radius of the skin [m]."""
        return USUAL_SKIN * self.h if self.skin_radius is None else self.skin_radius

    @property
    def rest_gap(self) -> float:
        """Gap of the wound at rest [m]."""
        return USUAL_GAP * self.h if self.gap is None else self.gap

    @property
    def lasting(self) -> float:
        return self.duration + self.release

    def frame_times(self) -> Floats:
        """Times of frames [s], evenly spaced over the pull and over what follows."""
        import numpy as np

        if self.release == 0:
            return np.array(evenly(0.0, self.duration, self.frames))
        before = min(max(1, round(self.frames * self.duration / self.lasting)), self.frames - 1)
        let_go = evenly(self.duration, self.lasting, self.frames - before)
        return np.array([*evenly(0.0, self.duration, before), *let_go[1:]])

    @property
    def shape_name(self) -> str:
        """The throws."""
        return self.throws

    def meaning(self) -> dict[str, Any]:
        return super().meaning() | {"skin_radius": self.h_s, "gap": self.rest_gap}

    def stitch(self) -> Stitch:
        """The strand around the two cylinders, at the resolution of the run."""
        from torsade.knots.stitch import stitch
        from torsade.protocols.shapes import check_count

        spacing = self.node_spacing
        assert spacing is not None
        check_count((4 * math.pi * self.h_s + 2 * self.rest_gap) / spacing)
        return stitch(*self.turns, self.h, self.h_s, self.rest_gap, spacing)

    def configuration(self) -> Centerline:
        """The one strand, checked."""
        from torsade.centerline import Centerline

        return Centerline((self._checked().strand,))

    def _checked(self) -> Stitch:
        """The strand and the cylinders, once it is certain that a fiber can lie so."""
        from torsade.centerline import Centerline
        from torsade.protocols.shapes import check_built

        stitch = self.stitch()
        check_built(Centerline((stitch.strand,)), self.h)
        return stitch

    def experiment(self, assembly: Assembly, state: State) -> Experiment:
        """Both ends pulled, to the left and to the right."""
        import numpy as np

        from torsade.motion import ends

        pull = self.force * np.array([math.cos(self.angle), math.sin(self.angle), 0.0])
        boundary = ends.pull(ends.free(assembly), assembly, 0, 0, pull * (-1, 1, 1))
        boundary = ends.pull(boundary, assembly, 0, 1, pull)
        return Experiment(boundary)

    def trial(self) -> Trial:
        from torsade.assembly import assemble, initial_state
        from torsade.motion.overdamped import Motion, model
        from torsade.motion.wound import Tissue, tied_around
        from torsade.protocols.shapes import check_frames
        from torsade.protocols.wound import RECORDED, SAMPLED, Wound

        stitch = self._checked()
        check_frames(self.frames + 1, len(stitch.strand))
        fiber = assemble([stitch.strand])
        start = initial_state(fiber, [stitch.strand])
        tissue = Tissue(
            self.h_s, self.skin_stiffness, self.skin_relaxation * self.skin_stiffness, self.skin_drag,
            self.friction, self.friction_speed,
        )  # fmt: skip
        boundary = self.experiment(fiber, start).boundary
        assembly, state, boundary = tied_around(fiber, start, boundary, stitch.cylinders, tissue)
        laws = model(self.fiber_material, self.section, self.laws)
        motion = Motion(assembly, laws, boundary, state, self.stepping)
        wound = Wound(self, fiber, motion)
        return Trial(
            motion,
            (*COMMON, *RECORDED),
            wound.frame,
            wound.conclude,
            sizes=sizes_of(fiber) | {"side": 2},
            fixed=fixed_of(fiber),
            start=hashlib.sha256(state.x.tobytes()).hexdigest(),
            sampled=SAMPLED,
            sample=wound.sample,
            catch=wound.catch,
            about={"knot": self.shape_name},
            later=(self.duration,) if self.release > 0 else (),
            begin=wound.begin,
            frame_times=self.frame_times(),
        )

    def last_pulled(self, time: ArrayLike) -> int:
        """The frame at the end of the pull, or the last before, of those at given times [s]."""
        import numpy as np

        return max(0, int(np.searchsorted(time, self.duration * (1 + 1e-9), side="right")) - 1)

    @classmethod
    def report(cls, result: Result) -> dict[str, Any]:
        """The numbers of a result under the keys of `--json`: those of the end of the pull, and histories.

        z_displacement_m are e_z . (w - w_0) of both sides, and the size of their difference; z_peak_m the
        largest they were on the way. skin_force_N are the sums of normal and of shear forces along the loop,
        of their parts along z, and what the springs hold the sides with, for a and b each. slip_speed_m_per_s
        is that at which each end runs out of the knot, in the mean of the last quarter of the pull.
        """
        data, attrs = result.dataset, result.dataset.attrs
        spec = cls(**result.spec)
        bottom, top = spec.turns
        last = spec.last_pulled(data["time"])
        end, z = data.isel(time=last), (data["skin_position"] - data["skin_position"][0])[:, :, 2].values
        return {
            "protocol": "suture",
            "throws": spec.throws,
            "preset": spec.preset,
            "crossings": abs(bottom) + abs(top),
            "writhe": bottom + top,
            "tau": tau_of(bottom, top),
            "z_displacement_m": _sides(z[last]),
            "z_peak_m": {side: float(attrs["z_peak_m"][side]) for side in ("a", "b", "relative")},
            "gap_m": float(end["gap"]),
            "closed_at_s": _known(attrs, "closed_at_s"),
            "skin_force_N": {
                "normal": end["skin_pressing"].values.tolist(),
                "shear": end["skin_shearing"].values.tolist(),
                "along_z": end["skin_force"][:, 2].values.tolist(),
                "spring": end["spring_force"].values.tolist(),
            },
            "slip_speed_m_per_s": _known(attrs, "slip_speed_m_per_s"),
            "c_f": _known(attrs, "c_f"),
            "gap_after_release_m": float(data["gap"][-1]) if spec.release > 0 else None,
            "times_s": data["time"].values.tolist(),
            "gaps_m": data["gap"].values.tolist(),
            "z_m": {"a": z[:, 0].tolist(), "b": z[:, 1].tolist()},
            "steps": attrs["steps"],
            "wall_s": attrs["wall_s"],
        }


def _known(attrs: Mapping[str, Any], name: str) -> float | None:
    """A number concluded from the run, where there is one."""
    return float(attrs[name]) if name in attrs else None


def _sides(z: Floats) -> dict[str, float]:
    """Displacements of both sides along z [m], and the size of their difference."""
    return {"a": float(z[0]), "b": float(z[1]), "relative": abs(float(z[0] - z[1]))}
