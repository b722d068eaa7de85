"""Snap-quench (thesis 3.7): the ends of a rod are driven towards each other until it breaks on the way."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from torsade.errors import TorsadeError
from torsade.protocols.base import Positive, Trial
from torsade.protocols.rods import Breakable
from torsade.units import Time, Velocity

if TYPE_CHECKING:
    from collections.abc import Mapping

    from torsade.arrays import Floats
    from torsade.fracture.cascade import Cascade

__all__ = ["SnapQuench"]

MEASURED_AT, SHORTEST = 0.003, 0.01
"""Speed [m/s] at which the thesis has its least fragment length, and the shortest at any speed [m] (3.3)."""

LEAST_SHORTENING = 1e-3
"""Least share of the length by which the ends have come nearer at first: a straight rod has no way to go."""


class SnapQuench(Breakable):
    """Drive the ends of a straight rod towards each other at a speed until it breaks, and follow the pieces.

    The ends turn freely. The rod is taken up at the shape that it has when it is bent slowly, moving as that
    shape does at this speed, a time `approach` before it would break if it were bent slowly.
    """

    hints: ClassVar[Mapping[str, str]] = {
        **Breakable.hints,
        "v": "there is no field 'v'; did you mean 'speed'?",
        "velocity": "there is no field 'velocity'; did you mean 'speed'?",
        "twist": "snap-quench bends a rod without twist, so there is no field 'twist'; see snap-twist",
        "duration": "there is no field 'duration'; give 'approach' and 'after', before and after the break",
    }

    protocol: Literal["snap-quench"] = "snap-quench"
    speed: Annotated[Velocity, Field(gt=0, le=20)] = Field(
        0.003, description="Speed at which the ends near each other.", examples=["100 mm/s"]
    )
    approach: Annotated[Time, Positive] = Field(
        0.02,
        description="How long before the expected break the motion is followed, or from the straight rod on.",
        examples=["20 ms"],
    )
    fragment_law: Literal["constant", "quarter-power"] = Field(
        "constant",
        description="Whether the least length of pieces is min_fragment at every speed, or, as the "
        "thesis measured, min_fragment at 3 mm/s, falling as speed^(-1/4) to no less than 10 mm.",
    )
    after: Annotated[Time, Positive] | None = Field(
        None,
        description="How long to follow the pieces; by default until the wave from a break in the middle "
        "reaches the ends, 2.06 ms.",
        examples=["2 ms"],
    )

    @model_validator(mode="after")
    def _goes_on_long_enough(self) -> SnapQuench:
        if self.approach * self.speed > self.length:
            raise TorsadeError(
                f"an approach of {self.approach:.4g} s at {1e3 * self.speed:.4g} mm/s is longer than the "
                "rod; give less"
            )
        return self

    @property
    def least_fragment(self) -> float:
        """The length that pieces exceed at this speed [m]."""
        if self.fragment_law == "constant":
            return self.min_fragment
        scale = float((MEASURED_AT / self.speed) ** 0.25)
        return max(self.min_fragment * scale, min(SHORTEST, self.min_fragment))

    @property
    def following(self) -> float:
        """How long the pieces are followed [s]."""
        return self.wave_time if self.after is None else self.after

    @property
    def lasting(self) -> float:
        """The longest that it may take [s]: inertia and disorder can delay the break."""
        return 1.5 * self.approach + self.following

    def trial(self) -> Trial:
        from torsade.fracture.cascade import most_breaks
        from torsade.protocols.pieces import NAMES, PieceFrames
        from torsade.protocols.shapes import check_frames

        check_frames(self.frames + 1, self.edges + 1)
        cascade = self.driven()
        most = most_breaks(cascade.motion.assembly, self.least_fragment)
        frames = PieceFrames(cascade, most)
        return Trial(
            cascade,
            NAMES,
            frames.frame,
            lambda samples, loose_at: self.conclusion(cascade, self._found(cascade)),
            sizes=frames.sizes,
            fixed={},
            start=hashlib.sha256(cascade.motion.state.x.tobytes()).hexdigest(),
        )

    def _found(self, cascade: Cascade) -> dict[str, Any]:
        if not cascade.breaks:
            return {}
        return self.at_limit(cascade.breaks[0].kappa, 0.0, cascade.first_distance)

    def driven(self) -> Cascade:
        """The rod at the start, its ends moving."""
        import numpy as np

        from torsade.assembly import assemble, initial_state
        from torsade.fracture.limit import rod_fiber
        from torsade.motion import ends
        from torsade.motion.equilibrium import bent

        material, section = self.fiber_material, self.section
        fiber = rod_fiber(material, section, self.length, self.edges)
        limit, _ = self.limit(0.0)
        farthest = self.length * (1 - LEAST_SHORTENING)
        distance = min(limit.end_distance + self.speed * self.approach, farthest)
        shape = bent(fiber, distance, near=limit)
        apart = 1e-4 * (self.length - distance)
        x, wide, near = (
            _centred(s.x) for s in (shape, *(bent(fiber, distance + d, near=shape) for d in (apart, -apart)))
        )
        assembly = assemble([x])
        state = initial_state(assembly, [x])
        state.v[:] = self.speed * (near - wide) / (2 * apart)
        half = np.array([0.5 * self.speed, 0.0, 0.0])
        boundary = ends.move(ends.free(assembly), assembly, 0, 0, half)
        boundary = ends.move(boundary, assembly, 0, 1, -half)
        return self.cascade(assembly, state, boundary, self.following)


def _centred(x: Floats) -> Floats:
    """Nodes (n, 3) [m] about the middle between their ends."""
    middle: Floats = 0.5 * (x[0] + x[-1])
    return x - middle
