"""Stress criteria: integrals over the section, eigenvalues of the stress tensor, published limits."""

import json
import math
from collections.abc import Callable

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.fracture import stress_kernels
from torsade.fracture.criteria import (
    CRITERIA,
    criterion,
    limit_curvature,
    limit_twist_density,
    matching_strength,
    squared_stress,
    stress,
    torsion_limit,
)
from torsade.material import named_material

SPAGHETTI = named_material("spaghetti")
E, MU, H, L, SIGMA_C = SPAGHETTI.E, SPAGHETTI.mu, 7e-4, 0.24, 1.9e7

KAPPA, THETA_PRIME = 9.0, 13.0
"""A curvature and a twist density at which both terms weigh about the same."""


def tensor(x: float, y: float, shear: float) -> np.ndarray:
    """Stress (2.15) of a section bent about the x axis and twisted, in Pa."""
    sigma = np.zeros((3, 3))
    sigma[2, 2] = E * KAPPA * y
    sigma[0, 2] = sigma[2, 0] = -shear * MU * THETA_PRIME * y
    sigma[1, 2] = sigma[2, 1] = shear * MU * THETA_PRIME * x
    return sigma


def mean_over_section(value: Callable[[np.ndarray], float], shear: float) -> float:
    """Mean of a function of the stress over the section, exact for quadratic ones."""
    total, n = 0.0, 8
    # Gauss-Legendre in the square of the radius, equal angles: exact for polynomials of degree 2 and 4.
    nodes, weights = np.polynomial.legendre.leggauss(4)
    for u, w in zip(0.5 * (nodes + 1), 0.5 * weights, strict=True):
        for phi in 2 * math.pi * np.arange(n) / n:
            r = H * math.sqrt(u)
            total += w / n * value(tensor(r * math.cos(phi), r * math.sin(phi), shear))
    return total


def von_mises_squared(sigma: np.ndarray) -> float:
    deviator = sigma - np.trace(sigma) / 3 * np.eye(3)
    return 1.5 * float((deviator * deviator).sum())


def largest_principal(shear: float) -> float:
    """Largest eigenvalue of the stress over the rim of the section."""
    angles = np.linspace(0, 2 * math.pi, 721)
    rim = [tensor(H * math.cos(p), H * math.sin(p), shear) for p in angles]
    return max(float(np.linalg.eigvalsh(sigma)[-1]) for sigma in rim)


@pytest.mark.parametrize(("name", "shear"), [("von_mises", 1.0), ("von_mises_printed", math.sqrt(0.5))])
def test_von_mises_is_the_mean_over_the_section(name: str, shear: float) -> None:
    """(1/pi h^2) integral of the von Mises stress squared; printed, b is divided by sqrt 2."""
    assert stress(KAPPA, THETA_PRIME, E, MU, H, name) ** 2 == pytest.approx(
        mean_over_section(von_mises_squared, shear), rel=1e-12
    )


def test_effective_is_the_mean_of_the_squared_tensor_with_shear_over_root_two() -> None:
    """(1/pi h^2) integral of sigma_ij sigma_ij, with the shear stress that the right side of (3.2) needs."""
    mean = mean_over_section(lambda sigma: float((sigma * sigma).sum()), math.sqrt(0.5))
    assert stress(KAPPA, THETA_PRIME, E, MU, H) ** 2 == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "shear", "factor"),
    [("max_principal", 1.0, 1.0), ("max_principal_printed", math.sqrt(0.5), math.sqrt(2.0))],
)
def test_largest_principal_stress_on_the_rim(name: str, shear: float, factor: float) -> None:
    """Eigenvalues of the tensor; (3.6) has the shear divided by sqrt 2, and is twice as large."""
    assert stress(KAPPA, THETA_PRIME, E, MU, H, name) == pytest.approx(
        factor * largest_principal(shear), rel=1e-12
    )


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 1.0])
def test_limits_are_where_the_stress_is_the_strength(name: str, share: float) -> None:
    sigma_c = matching_strength(SIGMA_C, name)
    twist_density = share * torsion_limit(L, sigma_c, MU, H, name) / L
    kappa = limit_curvature(twist_density, sigma_c, E, MU, H, name)
    assert stress(kappa, twist_density, E, MU, H, name) == pytest.approx(sigma_c, rel=1e-12)
    # Near zero curvature or twist the inverse is a square root, which loses half the digits.
    assert limit_twist_density(kappa, sigma_c, E, MU, H, name) == pytest.approx(twist_density, abs=1e-5)


@pytest.mark.parametrize("name", CRITERIA)
def test_strengths_that_match_give_one_limit_curvature(name: str) -> None:
    """kappa_c = 2 sigma_c/(E h) = 14.29 1/m without twist, R_c = 7 cm."""
    sigma_c = matching_strength(SIGMA_C, name)
    assert limit_curvature(0.0, sigma_c, E, MU, H, name) == pytest.approx(2 * SIGMA_C / (E * H), rel=1e-14)


PUBLISHED = {
    "effective": 361.1554593955935,
    "von_mises_printed": 294.8821977798843,
    "von_mises": 208.51320170134883,
    "max_principal": 510.7509488023339,
    "max_principal_printed": 722.310918791187,
}
"""Twist [degrees] that breaks the thesis's rods without bending, computed elsewhere."""


@pytest.mark.parametrize("name", CRITERIA)
def test_pure_torsion(name: str) -> None:
    """The thesis measured about 360 degrees."""
    twist = torsion_limit(L, matching_strength(SIGMA_C, name), MU, H, name)
    assert math.degrees(twist) == pytest.approx(PUBLISHED[name], rel=1e-12)


def test_beyond_the_limits_is_not_a_number() -> None:
    assert np.isnan(limit_curvature([0.0, 40.0], SIGMA_C, E, MU, H)).tolist() == [False, True]
    assert np.isnan(limit_twist_density([0.0, 15.0], SIGMA_C, E, MU, H)).tolist() == [False, True]


@pytest.mark.parametrize("name", CRITERIA)
def test_signs_do_not_matter_and_arrays_broadcast(name: str) -> None:
    kappa, twist = np.array([[-3.0], [3.0]]), np.array([-5.0, 0.0, 5.0])
    sigma = stress(kappa, twist, E, MU, H, name)
    assert sigma.shape == (2, 3)
    np.testing.assert_array_equal(sigma, sigma[::-1, ::-1])


@pytest.mark.parametrize("name", CRITERIA)
def test_kernel_is_the_same_formula(name: str) -> None:
    c = criterion(name)
    assert stress_kernels.squared_stress(c, 2e7, 3e7) == pytest.approx(squared_stress(c, 2e7, 3e7), rel=1e-15)


def test_a_wrong_name_gets_a_sentence() -> None:
    with pytest.raises(
        TorsadeError, match=r"no stress criterion 'tresca'; choose one of effective, von_mises"
    ):
        criterion("tresca")
    assert json.dumps(criterion("effective")) == "[0.25, 0.5, 0.0]"
