"""Rods whose ends are driven together at a given speed: curvature on the way, scalings, saturation.

v is the speed at which the ends **approach each other**, as 3.7 defines it; the shortening is then v t.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erfc

from torsade.fracture.rod import Rod

__all__ = [
    "breakup_probability",
    "dominant_wave_number",
    "fracture_sites",
    "fragment_length",
    "likeliest_breakup",
    "parabola_curvature",
    "quench_curvature",
    "time_to_curvature",
]

Floats = NDArray[np.float64]


def quench_curvature(shortening: ArrayLike, L: float) -> Floats:
    """kappa_0 = sqrt(4 pi^2 v t/L^3) [1/m], at the middle: the buckled shape is a sine.

    To first order in the shortening v t [m]: 0.2 % off at v t = L/100, 1.9 % at L/10 (see `elastica`, which
    is exact). With each end moving at v it is sqrt(8 pi^2 v t/L^3).
    """
    return np.sqrt(4.0 * np.pi**2 * np.asarray(shortening, dtype=np.float64) / L**3)


def parabola_curvature(shortening: ArrayLike, L: float) -> Floats:
    """kappa_0 as 3.7 has it, sqrt(48 v t/L^3) with each end moving at v: a parabola, 22 % below the sine.

    It leaves out the thrust that bends the rod, so its ends do not pivot: they are bent as the middle is.
    """
    return np.sqrt(24.0 * np.asarray(shortening, dtype=np.float64) / L**3)


def time_to_curvature(kappa: float, v: float, L: float) -> float:
    """Time [s] of driving at v [m/s] until the middle has that curvature [1/m], by `quench_curvature`."""
    return kappa**2 * L**3 / (4.0 * math.pi**2 * v)


def dominant_wave_number(v: float, t: float, rod: Rod) -> float:
    """k [1/m] of the waves that even out a rod driven at v [m/s] for a time t [s]: a scaling, k ~ v^(1/4).

    Strain at the surface, h kappa_0, grows at the rate pi h sqrt(v/(t L^3)); waves of that frequency have
    k^2 = 2 rate/(h c_s).
    """
    rate = math.pi * rod.h * math.sqrt(v / (t * rod.L**3))
    return math.sqrt(2.0 * rate / (rod.h * rod.c_s))


def fragment_length(v: ArrayLike, length: float, at: float = 1.0) -> Floats:
    """lambda = length (v/at)^(-1/4) [m]: the smallest fragment at speed v, from that at one speed."""
    return np.asarray(length * (np.asarray(v, dtype=np.float64) / at) ** -0.25)


def fracture_sites(v: ArrayLike, B_squared: float) -> Floats:
    """N_f/N_inf = erfc(sqrt(B^2/v)): breaks, over their number at high speed (3.8).

    As t_* ~ 1/v. B^2 [m/s] is about 1 mm/s in the thesis. No speed, no break.
    """
    v = np.asarray(v, dtype=np.float64)
    with np.errstate(divide="ignore"):
        return np.asarray(erfc(np.sqrt(B_squared / v)))


def breakup_probability(t: ArrayLike, depth: float, D: float) -> Floats:
    """P(T < t) = erfc(depth/sqrt(4 D t)) that a crack has grown to its critical depth by time t (3.8).

    A crack that diffuses, first passage by reflection: twice the chance of being beyond. Its density is
    exp(-depth^2/4Dt), integrated from the critical depth on; the thesis prints a constant integrand.

    Parameters
    ----------
    t : time [s]
    depth : critical less initial depth, x_* - x_0 [m]
    D : diffusivity of the crack [m^2/s]
    """
    with np.errstate(divide="ignore"):
        return np.asarray(erfc(depth / np.sqrt(4.0 * D * np.asarray(t, dtype=np.float64))))


def likeliest_breakup(depth: float, D: float) -> float:
    """t_* = (x_* - x_0)^2/6D [s], where the density of T is largest; its mean is infinite."""
    return depth**2 / (6.0 * D)
