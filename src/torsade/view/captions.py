"""What is written on the pictures of a movie: the time, a length scale, a colour bar, marks at breaks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.view._extra import require
from torsade.view.camera import View
from torsade.view.overlay import INK, Bar, draw_bar, drawn
from torsade.view.plots import SLIP

__all__ = ["EVER_FASTER", "Captions", "Clock", "Ring", "nice_length", "pace"]

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]

MUTED = "#737a81"
EDGE = 0.045
"""Distance of what is written from the border, in widths of the frame."""

EVER_FASTER = "time runs ever faster"
"""Of movies in the logarithm of time."""

SCALES = ((1e-6, "µm"), (1e-3, "mm"), (1e-2, "cm"), (1.0, "m"))


class Clock(NamedTuple):
    """How times are written: in units of so many seconds, with so many decimals, of such a name.

    `digits` is the room that they take.
    """

    unit: float
    decimals: int
    name: str
    digits: int

    @classmethod
    def over(cls, first: float, last: float) -> Clock:
        """In a unit that suits the time from first to last [s], fine enough that a hundredth of it shows."""
        duration = last - first
        unit, name = (1e-6, "µs") if duration < 0.01 else (1e-3, "ms") if duration < 0.5 else (1.0, "s")
        decimals = max(0, math.ceil(-math.log10(duration / unit / 100.0) - 1e-9))
        clock = cls(unit, decimals, name, 0)
        return clock._replace(digits=max(len(clock.number(time)) for time in (first, last)))

    @classmethod
    def in_units(cls, unit: float, name: str, first: float, last: float) -> Clock:
        """In a unit [s] of that name, to a thousandth of it, from first to last [s]."""
        clock = cls(unit, 3, name, 0)
        return clock._replace(digits=max(len(clock.number(time)) for time in (first, last)))

    def number(self, time: float) -> str:
        """A time [s] without its unit, and 0 without a minus."""
        text = f"{round(time / self.unit, self.decimals) + 0.0:.{self.decimals}f}"
        return text.replace("-", "\N{MINUS SIGN}")


class Ring(NamedTuple):
    """A mark at a break: where in the frame [pixels], and how old, from 0 to 1."""

    place: Floats
    age: float


def pace(slowed: float) -> str:
    """What to say of a movie that takes `slowed` times as long as what it shows."""
    if 0.95 < slowed < 1.05:
        return "real time"
    factor = slowed if slowed > 1 else 1.0 / slowed
    digits = max(0, 1 - math.floor(math.log10(factor)))
    shown = f"{round(factor, 1 - math.floor(math.log10(factor))):,.{digits}f}".replace(",", "\N{THIN SPACE}")
    return f"{shown} times {'slower' if slowed > 1 else 'faster'}"


def nice_length(most: float) -> float:
    """The largest of 1, 2, 5, 10, ... that is no more than this."""
    power = 10.0 ** math.floor(math.log10(most))
    return max(step * power for step in (1, 2, 5) if step * power <= most * (1 + 1e-9))


class Captions:
    """What is written on every picture; what stays the same is drawn once.

    Parameters
    ----------
    view : the camera
    unit : what the unit of the view is [m]
    clock : how times are written
    how : what to say of how time runs
    bar : the colour bar, if there is one
    """

    def __init__(self, view: View, unit: float, clock: Clock, how: str, bar: Bar | None) -> None:
        self._view, self._clock = view, clock
        self._still = _Layer(
            drawn(view.size, lambda figure, axes: self._lasting(figure, axes, unit, how, bar))
        )

    def on(self, picture: Pixels, time: float, note: str = "", rings: Sequence[Ring] = ()) -> Pixels:
        """The picture (height, width, 3), 0 to 255, with the time [s], a note below it, and rings."""
        layer = _Layer(drawn(self._view.size, lambda _, axes: self._passing(axes, time, note, rings)))
        return layer.over(self._still.over(picture))

    def _lasting(self, figure: Any, axes: Any, unit: float, how: str, bar: Bar | None) -> None:
        """A length scale below on the right, a colour bar on the left, and how time runs."""
        (width, height), u = self._view.size, self._view.size[1] / 100.0
        edge, foot = EDGE * width, (EDGE + 0.04) * height
        per_metre = float(self._view.scale(self._view.focus[None])[0]) / unit
        length = nice_length(0.18 * width / per_metre)
        right, left = width - edge, width - edge - length * per_metre
        axes.plot([left, right], [foot, foot], color=INK, linewidth=0.32 * u, solid_capstyle="butt")
        scale, name = max((s for s in SCALES if s[0] <= length * (1 + 1e-9)), default=SCALES[0])
        axes.text(
            0.5 * (left + right), foot + 1.2 * u, f"{length / scale:g} {name}", color=INK, fontsize=1.9 * u,
            ha="center", va="bottom",
        )  # fmt: skip
        axes.text(right, height - edge, how, color=MUTED, fontsize=1.75 * u, ha="right", va="top")
        if bar is not None:
            draw_bar(figure, (EDGE, EDGE + 0.04), u, bar)

    def _passing(self, axes: Any, time: float, note: str, rings: Sequence[Ring]) -> None:
        """The time above on the left, its last digit always at one place, and what changes with it."""
        (width, height), u = self._view.size, self._view.size[1] / 100.0
        edge = EDGE * width
        foot = height - edge - 3.0 * u
        large, small = {"fontsize": 3.2 * u, "color": INK}, {"fontsize": 2.1 * u, "color": INK}
        end = edge + (8.6 + 2.85 * self._clock.digits) * u
        axes.text(edge, foot, r"$t\,=$", **large)
        axes.text(end, foot, self._clock.number(time), ha="right", **large)
        axes.text(end + 1.3 * u, foot, self._clock.name, **large)
        axes.text(edge, foot - 4.6 * u, note, **small)
        patches = require("matplotlib.patches")
        for ring in rings:
            eased = 1.0 - (1.0 - ring.age) ** 2
            axes.add_patch(
                patches.Circle(
                    ring.place,
                    (1.5 + 5.0 * eased) * u,
                    fill=False,
                    ec=SLIP,
                    lw=0.45 * u,
                    alpha=1.0 - ring.age,
                )
            )


class _Layer:
    """A transparent sheet (height, width, 4), kept as the pixels that are on it."""

    def __init__(self, sheet: Pixels) -> None:
        self._at = np.flatnonzero(sheet[:, :, 3])
        inked = sheet.reshape(-1, 4)[self._at].astype(np.float32)
        opaque = inked[:, 3:] / 255.0
        self._through, self._ink = 1.0 - opaque, inked[:, :3] * opaque + 0.5

    def over(self, picture: Pixels) -> Pixels:
        """The picture (height, width, 3) with this sheet on top."""
        out = picture.copy()
        flat = out.reshape(-1, 3)
        flat[self._at] = flat[self._at] * self._through + self._ink
        return out
