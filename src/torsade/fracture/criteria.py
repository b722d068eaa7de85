"""When a rod breaks: stress criteria for a circular section that is bent and twisted.

All follow from two stresses at the surface of the section, a = E h |kappa| of bending and b = mu h |theta'|
of twist [Pa], with E the modulus in bending:

    sigma^2 = p a^2 + q b^2 + m p a sqrt(a^2 + 2 (q/p) b^2)

| name | p, q, m | what it is |
| --- | --- | --- |
| effective | 1/4, 1/2, 0 | right side of (3.2), and (3.4): what the thesis breaks rods with; the default |
| von_mises | 1/4, 3/2, 0 | mean square of the von Mises stress over the section |
| von_mises_printed | 1/4, 3/4, 0 | (3.5) |
| max_principal | 1/2, 1, 1 | square of the largest principal stress on the surface |
| max_principal_printed | 1, 1, 1 | (3.6), which is 8 sigma_c^2 without twist |

The printed forms, (3.4) among them, are what one gets when the shear stress is divided by sqrt 2; (3.6) is
also twice as large. With all of the shear, the mean of sigma_ij sigma_ij would give 1/4, 1, 0 in place of
`effective`. A rod breaks where sigma reaches the strength sigma_c of the criterion. Strengths that belong
together give the same limit curvature without twist: see `matching_strength`.

Every function takes numbers or arrays that broadcast. Compiled kernels call
`torsade.fracture.stress_kernels.squared_stress`, made from the same source.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.errors import TorsadeError, quoted

__all__ = [
    "CRITERIA",
    "Criterion",
    "CriterionName",
    "criterion",
    "limit_curvature",
    "limit_twist_density",
    "matching_strength",
    "squared_stress",
    "stress",
    "torsion_limit",
]

Floats = NDArray[np.float64]

CriterionName = Literal[
    "effective", "von_mises", "von_mises_printed", "max_principal", "max_principal_printed"
]


class Criterion(NamedTuple):
    """Coefficients p, q and m of a stress criterion; see the module."""

    bending: float
    twist: float
    mixed: float


CRITERIA: Mapping[str, Criterion] = MappingProxyType(
    {
        "effective": Criterion(0.25, 0.5, 0.0),
        "von_mises": Criterion(0.25, 1.5, 0.0),
        "von_mises_printed": Criterion(0.25, 0.75, 0.0),
        "max_principal": Criterion(0.5, 1.0, 1.0),
        "max_principal_printed": Criterion(1.0, 1.0, 1.0),
    }
)


def criterion(name: str) -> Criterion:
    """The criterion of a name.

    Raises
    ------
    TorsadeError
        When there is none of that name.
    """
    if name not in CRITERIA:
        raise TorsadeError(
            f"there is no stress criterion {quoted(name)}; choose one of {', '.join(CRITERIA)}"
        )
    return CRITERIA[name]


def squared_stress(c: Criterion, a: Any, b: Any) -> Any:
    """sigma^2 [Pa^2] of the surface stresses a of bending and b of twist [Pa], neither negative."""
    p, q, m = c
    return p * a * a + q * b * b + m * p * a * np.sqrt(a * a + 2.0 * (q / p) * b * b)


def stress(
    kappa: ArrayLike, theta_prime: ArrayLike, E: float, mu: float, h: float, name: str = "effective"
) -> Floats:
    """Stress sigma [Pa] that a criterion compares with the strength.

    Parameters
    ----------
    kappa, theta_prime : curvature [1/m] and twist density [rad/m], of any sign
    E, mu : Young's modulus in bending and shear modulus [Pa]
    h : radius [m]
    name : of the criterion
    """
    a = E * h * np.abs(np.asarray(kappa, dtype=np.float64))
    b = mu * h * np.abs(np.asarray(theta_prime, dtype=np.float64))
    return np.asarray(np.sqrt(squared_stress(criterion(name), a, b)))


def limit_curvature(
    theta_prime: ArrayLike, sigma_c: float, E: float, mu: float, h: float, name: str = "effective"
) -> Floats:
    """Curvature kappa_c [1/m] at which a rod of that twist density breaks; NaN where twist alone breaks it.

    With q b^2 <= sigma_c^2, a is sqrt((sigma_c^2 - q b^2)/p) without the mixed term and
    (sigma_c^2 - q b^2)/(sigma_c sqrt(2 p)) with it.
    """
    p, q, m = criterion(name)
    b = mu * h * np.abs(np.asarray(theta_prime, dtype=np.float64))
    left = sigma_c**2 - q * b * b
    # Twist up to the limit itself: round-off must not make NaN of it.
    left = np.where(np.abs(left) < 1e-12 * sigma_c**2, 0.0, left)
    left = np.where(left < 0, np.nan, left)
    a = left / (sigma_c * math.sqrt(2 * p)) if m else np.sqrt(left / p)
    return np.asarray(a / (E * h))


def limit_twist_density(
    kappa: ArrayLike, sigma_c: float, E: float, mu: float, h: float, name: str = "effective"
) -> Floats:
    """Twist density [rad/m] at which a rod of that curvature breaks; NaN where bending alone breaks it."""
    p, q, m = criterion(name)
    a = E * h * np.abs(np.asarray(kappa, dtype=np.float64))
    left = sigma_c**2 - (math.sqrt(2 * p) * sigma_c * a if m else p * a * a)
    left = np.where(np.abs(left) < 1e-12 * sigma_c**2, 0.0, left)
    return np.asarray(np.sqrt(np.where(left < 0, np.nan, left) / q) / (mu * h))


def torsion_limit(L: float, sigma_c: float, mu: float, h: float, name: str = "effective") -> float:
    """Total twist [rad] that breaks a straight rod of length L [m]: 361 degrees for the thesis's rods."""
    return L * float(limit_twist_density(0.0, sigma_c, 1.0, mu, h, name))


def matching_strength(sigma_c: float, name: str) -> float:
    """Strength [Pa] at which a criterion has the limit curvature of `effective` with sigma_c [Pa], untwisted.

    The thesis's sigma_c = sigma_c^VM = sigma_c^P/sqrt 8; for `max_principal` as it should be, sigma_c^P/2.
    """
    p, _, m = criterion(name)
    return 2.0 * sigma_c * math.sqrt(p * (1.0 + m))
