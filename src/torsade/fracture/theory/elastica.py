"""The planar shape of a rod whose ends pivot freely and are pushed towards each other: Euler's elastica.

Valid without twist. With the modulus k = sin(alpha/2), alpha the angle of the ends against the line between
them:

    d/L = 2 E(k)/K(k) - 1,   kappa_max L = 4 k K(k),   kappa(s) = kappa_max cn(2 K(k) (s/L - 1/2))
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipe, ellipj, ellipk

from torsade.errors import TorsadeError, quoted

__all__ = ["Elastica", "curvature_at", "elastica", "elastica_of_curvature", "largest_curvature"]

Floats = NDArray[np.float64]

NARROWEST = -0.7
"""Smallest end-to-end distance over length that is followed: far beyond the ends' meeting at 0."""

MOST = 1.0 - 1e-5
"""Largest parameter k^2 of a shape."""


class Elastica(NamedTuple):
    """A rod with pivoting ends.

    Attributes
    ----------
    length, distance : L and d, from end to end [m]
    modulus : k of the elliptic functions
    kappa_max : curvature at the middle [1/m]
    thrust_over_euler : push over Euler's load pi^2 B/L^2
    """

    length: float
    distance: float
    modulus: float
    kappa_max: float
    thrust_over_euler: float

    def curvature(self, s: Floats) -> Floats:
        """kappa(s) [1/m] at arclengths s [m] from an end."""
        u = 2.0 * float(ellipk(self.modulus**2)) * (np.asarray(s) / self.length - 0.5)
        return np.asarray(self.kappa_max * ellipj(u, self.modulus**2)[1])


def elastica(length: float, distance: float) -> Elastica:
    """The shape whose ends are so far apart [m].

    Raises
    ------
    TorsadeError
        When the rod cannot have that distance.
    """
    ratio = distance / length
    if not NARROWEST <= ratio <= 1.0:
        raise TorsadeError(
            f"an end-to-end distance of {quoted(distance)} m does not go with a rod of {length:g} m; give "
            f"one from {NARROWEST * length:.3g} to {length:g} m"
        )
    parameter = 0.0 if ratio == 1.0 else brentq(lambda m: _ratio(m) - ratio, 0.0, MOST, xtol=1e-15)
    return _of(length, parameter)


def elastica_of_curvature(length: float, kappa: float) -> Elastica:
    """The shape with that curvature [1/m] at its middle, at most `largest_curvature`.

    Raises
    ------
    TorsadeError
        When the curvature is larger.
    """
    if not 0.0 <= kappa <= largest_curvature(length):
        raise TorsadeError(
            f"a curvature of {quoted(kappa)} 1/m is not one of a rod of {length:g} m with pivoting ends; "
            f"give one from 0 to {largest_curvature(length):.3g} 1/m"
        )
    target = kappa * length / 4.0
    return _of(length, brentq(lambda k: k * float(ellipk(k * k)) - target, 0.0, 1.0 - 1e-7) ** 2)


def largest_curvature(length: float) -> float:
    """Of the most bent shape that is followed [1/m]."""
    return 4.0 * math.sqrt(MOST) * float(ellipk(MOST)) / length


def _of(length: float, parameter: float) -> Elastica:
    k, K = math.sqrt(parameter), float(ellipk(parameter))
    return Elastica(length, length * _ratio(parameter), k, 4.0 * k * K / length, (2.0 * K / math.pi) ** 2)


def curvature_at(length: float, distance: float, error: float = 0.0) -> tuple[float, float, float]:
    """Largest curvature [1/m] of an end-to-end distance [m], and its range when that has an error.

    Curvature is steep where the rod is nearly straight, so the range is not symmetric.
    """
    near, far = max(NARROWEST * length, distance - error), min(length, distance + error)
    low, high = (elastica(length, d).kappa_max for d in (far, near))
    return elastica(length, distance).kappa_max, low, high


def _ratio(m: float) -> float:
    """d/L of the parameter m = k^2."""
    return 2.0 * float(ellipe(m)) / float(ellipk(m)) - 1.0
