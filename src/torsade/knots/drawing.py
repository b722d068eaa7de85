"""What all built-in knots are drawn with: lengths in radii, and cubic splines."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.units import metres

__all__ = ["SAMPLES", "SPACING", "SPACING_RANGE", "in_radii", "known_radius", "spline"]

FloatArray = NDArray[np.float64]

SPACING = 0.5  # [radii]
SPACING_RANGE = (0.05, 1.0)  # [radii]
SAMPLES = 256  # per control point, before resampling: within 1e-5 radii of the spline


def known_radius(radius: float | str) -> float:
    """The radius [m] of a fiber, given as a number or as text with a unit."""
    h = metres("radius", radius)
    if not (0 < h < math.inf):
        raise TorsadeError(f"radius is {h:g} m; give a positive length in metres")
    return h


def spline(controls: FloatArray) -> FloatArray:
    """Points of the uniform cubic B-spline of `controls`, shape (n, 3): `SAMPLES` edges to each span."""
    u = (np.arange(SAMPLES) / SAMPLES)[:, None]
    weights = ((1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3)
    spans = len(controls) - 3
    points = np.sum([w * controls[k : k + spans, None] / 6 for k, w in enumerate(weights)], axis=0)
    last = (controls[-3] + 4 * controls[-2] + controls[-1]) / 6
    return np.concatenate([points.reshape(-1, 3), last[None]])


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
