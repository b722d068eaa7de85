"""The overhand knot, a trefoil in one open strand, loose and ready to be tightened.

The curve is its own image under half a turn about y, so one half of it says everything: control points of a
uniform cubic B-spline, from the middle of the strand outwards. Seen along z it has three crossings, which
alternate, all of them positive. Both ends leave along the x axis.
"""

from __future__ import annotations

import difflib
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from torsade.centerline import Centerline
from torsade.curve import resample
from torsade.errors import TorsadeError, quoted
from torsade.knots.drawing import SPACING, SPACING_RANGE, in_radii, known_radius, spline

__all__ = ["STRAND_KNOTS", "known_strand_knot", "overhand"]

FloatArray = NDArray[np.float64]

STRAND_KNOTS = ("overhand",)
"""Built-in knots in one strand."""

_OTHER_NAMES = MappingProxyType({"trefoil": "overhand", "thumb": "overhand", "half": "overhand"})

_MIDDLE = (0.0, 1.6, 0.0)
# Chosen, to the digit given, to use the least fiber with strands 2.1 radii apart and h kappa below 0.44.
_HALF = (
    (-1.2, 1.8, 1.6),
    (-2.4, 0.9, 2.5),
    (-3.2, -0.6, 2.5),
    (-3.4, -2.1, 1.6),
    (-2.6, -3.0, -0.1),
    (-0.5, -2.2, -1.7),
)  # [radii]
_OTHER_HALF = (-1.0, 1.0, -1.0)
_STEP = 3.0  # distance between control points on the way out [radii]
_WAY_OUT = 5  # control points on the way out

_LEAD = 26.0  # [radii]
_LEAD_RANGE = (5.0, 1e4)  # [radii]


def overhand(
    radius: float | str = 0.2e-3, lead: float | str | None = None, spacing: float | str | None = None
) -> Centerline:
    """A loose, smooth overhand knot in one open strand; nothing of it touches.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        radius: fiber radius h [m].
        lead: length of each straight end [m], 5 radii or more; 26 radii by default.
        spacing: greatest distance between nodes along the strand [m], one radius or less; half a radius by
            default.

    Raises:
        TorsadeError: a length out of range.
    """
    h = known_radius(radius)
    straight = _LEAD if lead is None else in_radii("lead", lead, _LEAD_RANGE, h)
    apart = SPACING if spacing is None else in_radii("spacing", spacing, SPACING_RANGE, h)
    out = [(_HALF[-1][0] + _STEP * k, 0.0, 0.0) for k in range(1, _WAY_OUT + 1)]
    half = np.array([*_HALF, *out])
    x = spline(np.concatenate([(half * _OTHER_HALF)[::-1], [_MIDDLE], half]))
    end = x[-1] + [straight, 0.0, 0.0]
    x = np.concatenate([[end * _OTHER_HALF], x, [end]])
    return Centerline((h * resample(x, spacing=apart, method="linear"),))


def known_strand_knot(name: str) -> str:
    """The name as `STRAND_KNOTS` has it, or an error that says what is meant or what there is."""
    plain = name.strip().lower().removesuffix(" knot").removesuffix("-knot")
    if plain in STRAND_KNOTS:
        return plain
    near = [_OTHER_NAMES[plain]] if plain in _OTHER_NAMES else difflib.get_close_matches(plain, STRAND_KNOTS)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise TorsadeError(
        f"no knot in one strand is called {quoted(name)}; {hint}choose {', '.join(STRAND_KNOTS)}, or tighten "
        "a centerline of your own (--centerline FILE.csv)"
    )
