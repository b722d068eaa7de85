"""How long things take in a rod that has just broken at its middle: twist is faster than bending.

Twist waves run at c_theta = sqrt(mu/rho); bending waves spread as sqrt(t). To go as far as the smallest
fragment is long, bending takes about four times as long as twist.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from torsade.fracture.rod import Rod

__all__ = [
    "TimeScales",
    "bending_energy",
    "bending_time",
    "kinetic_energy",
    "time_scales",
    "twist_front_time",
]


class TimeScales(NamedTuple):
    """Times [s] of a rod, and their ratios.

    Attributes
    ----------
    twist : T_twist = L/c_theta, also T_diss (3.16): by then damped twist has mostly gone
    bend : T_bend = L^2 sqrt(rho A/EI), of the whole rod
    twist_fragment : T_theta^0 = lambda/c_theta (3.14)
    bend_fragment : T_b^0 = lambda^2/(2 pi h c_s) (3.21)
    bend_clamp : until the largest curvature would reach the clamp at L/2
    bend_over_twist : T_bend/T_twist = (L/h) sqrt(2/(1 + nu)) (3.10)
    fragment_ratio : T_b^0/T_theta^0 (3.22a)
    far_ratio : T_b^l/T_theta^l (3.22b) with the damping given, at any distance l where damping rules
    """

    twist: float
    bend: float
    twist_fragment: float
    bend_fragment: float
    bend_clamp: float
    bend_over_twist: float
    fragment_ratio: float
    far_ratio: float


def time_scales(rod: Rod, fragment: float, b: float | None = None) -> TimeScales:
    """All of them.

    Parameters
    ----------
    rod : before it breaks
    fragment : length lambda of the smallest fragment [m]
    b : damping of twist [1/s], pi c_theta/L by default as (3.15) has it; the thesis measures 1.3 times that
    """
    b = math.pi * rod.c_theta / rod.L if b is None else b
    twist, bend = rod.L / rod.c_theta, rod.L**2 * math.sqrt(rod.rho * rod.section.A / rod.B)
    near, far = fragment / rod.c_theta, bending_time(rod, fragment)
    return TimeScales(
        twist=twist,
        bend=bend,
        twist_fragment=near,
        bend_fragment=far,
        bend_clamp=bending_time(rod, rod.L / 2),
        bend_over_twist=bend / twist,
        fragment_ratio=far / near,
        far_ratio=bending_time(rod, rod.L) / twist_front_time(rod, rod.L, b),
    )


def bending_time(rod: Rod, distance: float) -> float:
    """Time [s] after which the largest curvature is so far [m] from the new end (3.21).

    Linear theory, until waves are back from the clamp; wave packets of length l take the same time.
    """
    return distance**2 / (2 * math.pi * rod.h * rod.c_s)


def twist_front_time(rod: Rod, distance: float, b: float) -> float:
    """Time [s] that strongly damped twist takes over a distance l [m]: b l^2/c_theta^2.

    A scaling, without a factor, where b l >> c_theta; nearer than that the front runs at c_theta.
    """
    return b * distance**2 / rod.c_theta**2


def bending_energy(rod: Rod, kappa: float) -> float:
    """E I kappa^2 [J/m], the thesis's E_P: twice the energy stored by bending, per length."""
    return rod.B * kappa**2


def kinetic_energy(rod: Rod, v: float) -> float:
    """rho A v^2/2 [J/m] of what moves at v [m/s]; far below `bending_energy` at speeds of a quench."""
    return rod.rho * rod.section.A * v**2 / 2
