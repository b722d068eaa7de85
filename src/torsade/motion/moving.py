"""What every kind of motion offers to those who drive it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Any, Generic, Protocol, TypeVar

from numpy.typing import NDArray

__all__ = ["Guided", "Motion", "Outcome", "check_saved"]


class Outcome(Enum):
    """Why a motion paused: at the time asked for, after the steps asked for, slipped apart, or all over."""

    REACHED = 0
    SLIPPED = 1
    PAUSED = 5
    OVER = 7


class Motion(Protocol):
    """Fibers that move: a clock, and all that decides how they go on.

    Motions that reach the same times from the same saved arrays give the same result, bit for bit.
    """

    @property
    def time(self) -> float:
        """Present time [s]."""

    @property
    def steps(self) -> int:
        """Completed steps."""

    @property
    def at_once(self) -> int:
        """Steps between looks at the screen and at Ctrl-C, about 0.2 s; a number, so that runs repeat."""

    def advance(self, until: float, max_steps: int = 2**62) -> Outcome:
        """Advance to the time until [s], in at most max_steps steps."""

    def warm_up(self) -> None:
        """Compile or load every kernel, and leave no trace."""

    def saved(self) -> dict[str, NDArray[Any]]:
        """Copies of the arrays that decide how the motion goes on, by name."""

    def recover(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Go on from the arrays that `saved` gave."""


def check_saved(saved: Mapping[str, NDArray[Any]], present: Mapping[str, NDArray[Any]]) -> None:
    """Refuse saved arrays that cannot take the place of the present ones: kernels would read beyond them.

    Raises
    ------
    ValueError
        When one has another shape or type than the present array of its name.
    """
    for name, array in present.items():
        found = saved[name]
        same = (found.shape, found.dtype) == (array.shape, array.dtype)
        if not (same and found.flags.c_contiguous):
            raise ValueError(f"{name} is {found.dtype} of shape {found.shape}")


Moved = TypeVar("Moved", bound=Motion)


class Guided(Generic[Moved]):
    """What does something to fibers on their way, `motion`, and keeps their clock."""

    motion: Moved

    @property
    def time(self) -> float:
        """Present time [s]."""
        return self.motion.time

    @property
    def steps(self) -> int:
        """Completed steps."""
        return self.motion.steps

    @property
    def at_once(self) -> int:
        """Steps that take about 0.2 s."""
        return self.motion.at_once
