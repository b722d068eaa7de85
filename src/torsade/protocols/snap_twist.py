"""Snap-twist (thesis 3.4): a twisted rod is bent slowly until it breaks, and breaks on in its waves."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from torsade.protocols.base import Positive, Trial
from torsade.protocols.rods import Breakable
from torsade.units import Angle, Time

if TYPE_CHECKING:
    from torsade.fracture.cascade import Cascade

__all__ = ["SnapTwist"]


class SnapTwist(Breakable):
    """Twist a straight rod, bend it slowly by its ends until it breaks, and follow the fracture cascade.

    The ends turn freely about one axis while the rod is bent and hold still after the first break. Time
    begins with that break. Without disorder it is in the middle.
    """

    protocol: Literal["snap-twist"] = "snap-twist"
    twist: Annotated[Angle, Field(gt=-1000, lt=1000)] = Field(
        0.0, description="Total twist of the rod, kept while it is bent."
    )
    duration: Annotated[Time, Positive] | None = Field(
        None,
        description="How long to follow the pieces; by default until the wave from a break in the middle "
        "reaches the ends, 2.06 ms.",
        examples=["2 ms"],
    )

    @property
    def lasting(self) -> float:
        return self.wave_time if self.duration is None else self.duration

    def trial(self) -> Trial:
        from torsade.fracture.cascade import most_breaks
        from torsade.protocols.pieces import NAMES, PieceFrames
        from torsade.protocols.shapes import check_frames

        check_frames(self.frames + 1, self.edges + 1)
        cascade, at_limit = self.broken()
        most = most_breaks(cascade.motion.assembly, self.least_fragment)
        frames = PieceFrames(cascade, most, grips=1)
        return Trial(
            cascade,
            NAMES,
            frames.frame,
            lambda samples, loose_at: self.conclusion(cascade, at_limit),
            sizes=frames.sizes,
            fixed={},
            start=hashlib.sha256(cascade.motion.state.x.tobytes()).hexdigest(),
        )

    def broken(self) -> tuple[Cascade, dict[str, float]]:
        """The rod just after its first break, and what is said of the moment before."""
        from torsade.motion.grips import gripped

        shape, weakest = self.limit(self.twist)
        cascade = self.cascade(*gripped(shape.x, shape.grips, self.twist))
        cascade.snap([weakest + 1])  # the first hinge is that of the grip
        kappa = float(shape.kappa[1:-1][weakest])
        return cascade, self.at_limit(kappa, self.twist / self.length, shape.end_distance)
