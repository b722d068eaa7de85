"""Material of a rod from measurements (3.11): numbers with errors that are carried on.

Errors are standard errors. What is measured on each sample scatters and averages out; what all share, the
radius above all, does not, and is carried on as it is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.errors import TorsadeError

__all__ = [
    "GRAVITY",
    "Measured",
    "cylinder_inertia",
    "density",
    "exactly",
    "half_life_rate",
    "poisson_ratio",
    "shear_modulus",
    "twist_damping",
    "young_modulus",
]

Floats = NDArray[np.float64]

GRAVITY = 9.80665
"""Standard gravity [m/s^2]."""


class Measured(NamedTuple):
    """A number with its standard error.

    Attributes
    ----------
    value, error : in SI units
    scatter : the part of the error that comes from the scatter of samples; NaN with one sample
    n : number of samples
    """

    value: float
    error: float
    scatter: float
    n: int

    def over(self, power: float, other: Measured) -> Measured:
        """This times another one to a power, independent of it."""
        value = self.value * other.value**power
        relative = math.hypot(self.error / self.value, power * other.error / other.value)
        return Measured(value, abs(value) * relative, math.nan, min(self.n, other.n))


def exactly(value: float, error: float = 0.0) -> Measured:
    """A number that is not a mean of samples."""
    return Measured(value, error, math.nan, 1)


def young_modulus(masses: ArrayLike, lengths: ArrayLike, radius: Measured, g: float = GRAVITY) -> Measured:
    """E [Pa] from the masses that buckle upright samples: m g = pi^2 E I/l^2, ends that pivot (3.11).

    Parameters
    ----------
    masses : shown on the scales at the point of buckling [kg], shape (n,)
    lengths : of the samples [m], shape (n,)
    radius : of all; E goes as its inverse fourth power, so 2 % of it are 8 % of E
    g : gravity [m/s^2]
    """
    m, l = _samples(masses, "masses"), _samples(lengths, "lengths")
    per_sample = m * g * l**2 * 4 / math.pi**3
    return _averaged(per_sample).over(-4, radius)


def density(masses: ArrayLike, lengths: ArrayLike, radius: Measured) -> Measured:
    """rho [kg/m^3] of cylinders that were weighed."""
    m, l = _samples(masses, "masses"), _samples(lengths, "lengths")
    return _averaged(m / (math.pi * l)).over(-2, radius)


def cylinder_inertia(mass: float, radius: float) -> float:
    """Moment of inertia about its axis of a cylinder, m r^2/2 [kg m^2]."""
    return mass * radius**2 / 2


def shear_modulus(
    omega: ArrayLike, decay: ArrayLike, lengths: ArrayLike, inertia: Measured, radius: Measured
) -> Measured:
    """mu [Pa] from torsion pendulums: omega^2 = mu J/(I_0 L) (3.11), without damping.

    Parameters
    ----------
    omega, decay : angular frequency and decay rate of the amplitude of each pendulum [1/s], shape (n,); the
        frequency without damping is sqrt(omega^2 + decay^2)
    lengths : of their rods [m], shape (n,)
    inertia : moment of inertia I_0 of the mass about the rod [kg m^2], a third of the rod's own included
    radius : of all rods
    """
    w, d = _samples(omega, "frequencies"), np.asarray(decay, dtype=np.float64)
    l = _samples(lengths, "lengths")
    per_sample = (w**2 + d**2) * l * 2 / math.pi
    return _averaged(per_sample).over(1, inertia).over(-4, radius)


def twist_damping(
    decay: ArrayLike,
    lengths: ArrayLike,
    inertia: Measured,
    radius: Measured,
    rho: Measured,
    mass_height: float | None = None,
) -> Measured:
    """b [1/s] from the decay of torsion pendulums.

    The rod turns as theta = Theta x/L, and along all of it the torque 4 b rho I theta_t resists (3.1b). Its
    power is 4 b rho I (L/3) Theta_t^2, so that amplitudes decay at the rate 2 b rho I (L/3)/I_0. The thesis
    counts the drag of the last piece of its discretised rod alone, whose length it takes to be the height h_0
    of the mass, and so has h_0 in place of L/3: with `mass_height` that is what is given, L/(3 h_0) times as
    much. A rod that goes through the mass turns with it there, and L/3 + h_0 would take the place of L/3.

    Either way b holds only if the rod, and not air or grips, damps the pendulum.

    Parameters
    ----------
    decay : of the amplitude, of each pendulum [1/s], shape (n,)
    lengths : of their rods [m], shape (n,)
    inertia : moment of inertia of the mass [kg m^2]
    radius, rho : of the rods [m], [kg/m^3]
    mass_height : h_0 [m], for the thesis's formula
    """
    d = _samples(decay, "decay rates")
    l = _samples(lengths, "lengths") / 3 if mass_height is None else np.full(len(d), mass_height)
    # 2 rho I = rho pi h^4/2.
    per_sample = d / l * 2 / math.pi
    return _averaged(per_sample).over(1, inertia).over(-1, rho).over(-4, radius)


def half_life_rate(omega: float, oscillations: float) -> float:
    """Decay rate [1/s] of a pendulum whose amplitude halves in so many oscillations: omega ln 2/(2 pi N)."""
    return omega * math.log(2) / (2 * math.pi * oscillations)


def poisson_ratio(E: Measured, mu: Measured) -> Measured:
    """nu = E/(2 mu) - 1, of independent E and mu.

    The thesis's 3.8 +- 0.3 and 1.5 +- 0.2 GPa give 0.27 +- 0.20. Where both come from the same radius its
    error cancels, and E and mu are to be given without it.
    """
    ratio = E.over(-1, mu)
    return Measured(ratio.value / 2 - 1, ratio.error / 2, math.nan, ratio.n)


def _samples(values: ArrayLike, what: str) -> Floats:
    x = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if not len(x) or not (np.isfinite(x).all() and (x > 0).all()):
        raise TorsadeError(
            f"{what} of samples must be finite and above 0, and at least one; leave others out"
        )
    return x


def _averaged(values: Floats) -> Measured:
    """Mean of samples, with its standard error."""
    n = len(values)
    scatter = float(values.std(ddof=1)) / math.sqrt(n) if n > 1 else math.nan
    return Measured(float(values.mean()), 0.0 if n < 2 else scatter, scatter, n)
