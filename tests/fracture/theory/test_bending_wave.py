"""The self-similar bending wave: reference values, its equation, and a rod of finite length."""

import csv
import math
import os
from pathlib import Path

import numpy as np
import pytest

from torsade.fracture.rod import spaghetti
from torsade.fracture.theory.bending_wave import (
    AMPLIFICATION,
    curvature_ratio,
    curvature_slope,
    extremum,
    peak_distance,
    released_rod,
)
from torsade.fracture.theory.scales import bending_time

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).parents[4] / "shared"))

ROD = spaghetti()
H, C_S = ROD.h, ROD.c_s


@pytest.mark.skipif(not (SHARED / "data").is_dir(), reason="no reference data")
def test_reference_table() -> None:
    with (SHARED / "data/curves/wave_bending_selfsimilar.csv").open() as file:
        rows = np.array([[float(cell) for cell in row] for row in list(csv.reader(file))[1:]])
    t = 1e-4
    x = rows[:, 0] * math.sqrt(math.pi * H * C_S * t)
    np.testing.assert_allclose(curvature_ratio(x, t, H, C_S), rows[:, 1], atol=1e-10)
    np.testing.assert_allclose(curvature_slope(rows[:, 0]), rows[:, 2], atol=1e-9)


def test_amplification_and_later_extrema() -> None:
    assert pytest.approx(1.427944428043879, rel=1e-14) == AMPLIFICATION
    assert extremum(1) == AMPLIFICATION
    assert extremum(2) == pytest.approx(0.6868313567273965, rel=1e-14)
    assert extremum(8) == pytest.approx(0.8410315084938569, rel=1e-14)


def test_it_solves_the_beam_equation() -> None:
    """kappa_tt + (h c_s/2)^2 kappa_xxxx = 0, by central differences; value and slope vanish at the end."""
    t, x, dx, dt = 1e-4, 0.02, 2e-4, 1e-7
    fourth = np.array([1, -4, 6, -4, 1]) @ curvature_ratio(x + dx * np.arange(-2, 3), t, H, C_S) / dx**4
    later = np.array([1, -2, 1]) @ curvature_ratio(x, t + dt * np.arange(-1, 2), H, C_S) / dt**2
    assert later == pytest.approx(-((H * C_S / 2) ** 2) * fourth, rel=2e-3)
    assert curvature_ratio(0.0, t, H, C_S) == 0
    assert curvature_slope(0.0) == 0


def test_peak_comes_when_3_21_says() -> None:
    x = np.linspace(1e-3, 0.12, 100001)
    for t in (1e-5, 1e-4, 1e-3):
        at = x[np.argmax(curvature_ratio(x, t, H, C_S))]
        assert at == pytest.approx(float(peak_distance(t, H, C_S)), abs=2e-6)
        assert bending_time(ROD, at) == pytest.approx(t, rel=1e-3)


def test_start_is_uniform() -> None:
    np.testing.assert_allclose(curvature_ratio([0.001, 0.1], 0.0, H, C_S), 1.0)


@pytest.mark.parametrize(("steps", "error"), [(40, 0.03), (80, 0.0065)])
def test_finite_rod_follows_the_wave_before_the_clamp_matters(steps: int, error: float) -> None:
    """2 S(w), the better the farther the largest curvature is from the new end in steps of the grid."""
    length, n = 0.12, 600
    x = np.linspace(length, 0.0, n + 1)
    peak = steps * length / n
    t = bending_time(ROD, peak)
    kappa = released_rod(np.ones(n + 1), t, length, H, C_S)[0]
    near = x < 2 * peak
    np.testing.assert_allclose(kappa[near], curvature_ratio(x[near], t, H, C_S), rtol=0, atol=error)


def test_finite_rod_swings_at_the_frequencies_of_a_cantilever() -> None:
    """A mode of the curvature, that of the moments of a clamped-free beam, comes back after its period.

    beta l = 1.875104 of the first mode; the curvature of its shape, cosh + cos - 0.7341 (sinh + sin).
    """
    length, n, beta, sigma = 0.12, 400, 1.875104068712 / 0.12, 0.73409551375891
    x = np.linspace(0.0, length, n + 1)
    shape = np.cosh(beta * x) + np.cos(beta * x) - sigma * (np.sinh(beta * x) + np.sin(beta * x))
    period = 2 * math.pi / (0.5 * H * C_S * beta**2)
    kappa = released_rod(shape, np.array([0.0, period / 4, period / 2]), length, H, C_S)
    np.testing.assert_allclose(kappa[0], shape, atol=1e-4)
    np.testing.assert_allclose(kappa[1], 0.0, atol=2e-3)
    np.testing.assert_allclose(kappa[2], -shape, atol=2e-3)
