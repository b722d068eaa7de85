"""Lengths that are asked for, in radii."""

from __future__ import annotations

import math

from torsade.errors import TorsadeError
from torsade.units import metres

__all__ = ["SPACING", "SPACING_RANGE", "in_radii", "known_radius"]

SPACING = 0.5  # [radii]
SPACING_RANGE = (0.05, 1.0)  # [radii]


def known_radius(radius: float | str) -> float:
    """The radius [m] of a fiber, given as a number or as text with a unit."""
    h = metres("radius", radius)
    if not (0 < h < math.inf):
        raise TorsadeError(f"radius is {h:g} m; give a positive length in metres")
    return h


def in_radii(what: str, given: float | str, radii: tuple[float, float], h: float) -> float:
    """A length [m], or text with a unit, in radii h [m], within bounds that are also in radii."""
    low, high = radii
    value = metres(what, given)
    # The bounds give way to rounding, so that low * h itself passes; a comparison with nan is false.
    if low * (1 - 1e-12) <= value / h <= high * (1 + 1e-12):
        return value / h
    raise TorsadeError(
        f"{what} is {value:g} m; give {low * h:g} to {high * h:g} m, which is {low:g} to {high:g} radii"
    )
