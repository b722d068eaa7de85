"""When a rod that is twisted and bent breaks into exactly two pieces.

After the first break twist is gone before bending waves come (`scales`), and they raise the curvature from
kappa_c to C kappa_c at most. Nothing breaks any more when that alone does not reach the strength:

    sigma(C kappa_c, 0) < sigma_c = sigma(kappa_c, Tw/L)

Both sides together leave a condition on the ratio of twist and bending alone, Li = mu Tw/(E kappa_c L) (3.3),
whatever the strength: above a line through the origin of the plane of Tw and kappa_c rods break into more
than two pieces. The strength says where along that line the rod is. No fragment is shorter than lambda, so a
rod also breaks in two where lambda >= L/4.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from torsade.fracture.criteria import criterion, limit_curvature, limit_twist_density
from torsade.fracture.rod import Rod
from torsade.fracture.theory.bending_wave import AMPLIFICATION

__all__ = ["Threshold", "binary_slope", "li", "li_threshold", "threshold"]


def li(Tw: float, kappa_c: float, rod: Rod) -> float:
    """Li = mu Tw/(E kappa_c L) (3.3): weight of twist over that of bending; infinite without bending.

    Parameters
    ----------
    Tw : twist of the whole rod [rad]
    kappa_c : largest curvature when it breaks [1/m]
    """
    if kappa_c == 0:
        return math.inf if Tw else math.nan
    return rod.mu * abs(Tw) / (rod.E * abs(kappa_c) * rod.L)


def li_threshold(C: float = AMPLIFICATION, name: str = "effective") -> float:
    """Li above which a rod breaks in two, with the amplification C >= 1 of the curvature.

    sqrt((C^2 - 1) p/q) without the mixed term of the criterion, which is sqrt((C^2 - 1)/2) for `effective`:
    0.72 with C = 1.428 and 0.79 with 1.5. With it, sqrt(2 C (C - 1) p/q).
    """
    p, q, m = criterion(name)
    return math.sqrt((2 * C * (C - 1) if m else C * C - 1) * p / q)


def binary_slope(rod: Rod, C: float = AMPLIFICATION, name: str = "effective") -> float:
    """kappa_c/Tw [1/(m rad)] below which a rod breaks in two.

    For `effective` 1/(sqrt 2 L (1 + nu) sqrt(C^2 - 1)): (3.23), in which the root must not cover L (1 + nu).
    """
    return rod.mu / (rod.E * rod.L * li_threshold(C, name))


class Threshold(NamedTuple):
    """Where rods of one strength begin to break in two.

    Attributes
    ----------
    twist : total twist [rad]
    kappa : curvature when they break [1/m]
    li : Li there
    """

    twist: float
    kappa: float
    li: float


def threshold(rod: Rod, sigma_c: float, C: float = AMPLIFICATION, name: str = "effective") -> Threshold:
    """Twist beyond which rods of strength sigma_c [Pa], that of the criterion, break in two.

    258 degrees for the thesis's rods with C = 1.428, 269 with 1.5, of 361 that twist alone would take.
    """
    kappa = float(limit_curvature(0.0, sigma_c, rod.E, rod.mu, rod.h, name)) / C
    twist = rod.L * float(limit_twist_density(kappa, sigma_c, rod.E, rod.mu, rod.h, name))
    return Threshold(twist, kappa, li(twist, kappa, rod))
