"""Damped twist waves: reference values, characteristics, an independent integration, limits."""

import csv
import math
import os
from pathlib import Path

import numpy as np
import pytest

from torsade.fracture.theory.twist_wave import mode, twist_wave

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).parents[4] / "shared"))

L, C = 0.24, 987.0


def leapfrog(b: float, T: float, n: int) -> tuple[np.ndarray, np.ndarray]:
    """theta and theta_x of (3.11) at time T L/c, in units of Tw and Tw/L, at n + 1 points, by differences.

    With steps of dx/c waves without damping travel exactly.
    """
    dx = 0.5 / n
    steps = round(T / dx)
    beta = b * L / C
    x = np.linspace(0, 0.5, n + 1)
    old = x.copy()
    now = x.copy()

    def laplacian(u: np.ndarray) -> np.ndarray:
        out = np.zeros_like(u)
        out[1:-1] = u[2:] - 2 * u[1:-1] + u[:-2]
        out[-1] = 2 * (u[-2] - u[-1])
        return out

    now += 0.5 * laplacian(old)
    for _ in range(steps - 1):
        new = (2 * now - (1 - beta * dx) * old + laplacian(now)) / (1 + beta * dx)
        new[0] = 0.0
        old, now = now, new
    return now, np.gradient(now, dx)


@pytest.mark.skipif(not (SHARED / "data").is_dir(), reason="no reference data")
def test_reference_table() -> None:
    """264 values of angle, to the 3e-7 of its own series, and of twist density away from the front."""
    with (SHARED / "data/curves/wave_twist_damped.csv").open() as file:
        rows = list(csv.reader(file))[1:]
    assert len(rows) > 200
    for beta, T, s, theta, theta_x in rows:
        value = {"pi": math.pi, "1.3pi": 1.3 * math.pi}.get(beta) if "pi" in beta else float(beta)
        assert value is not None
        at = twist_wave(float(s) * L, float(T) * L / C, L, C, value * C / L)
        assert at.theta == pytest.approx(float(theta), abs=3e-7)
        # Cesaro means of the table smear the front.
        ahead, behind = math.cos(math.pi * (float(s) - float(T))), math.cos(math.pi * (float(s) + float(T)))
        if min(abs(ahead), abs(behind)) > 0.1:
            assert L * at.theta_prime == pytest.approx(float(theta_x), abs=2e-3)


@pytest.mark.parametrize("T", [0.3, 0.7, 1.0, 1.6])
def test_independent_integration(T: float) -> None:
    """Differences along characteristics: second order in theta away from the front."""
    b, n = 1.3 * math.pi * C / L, 2000
    theta, theta_x = leapfrog(b, T, n)
    x = np.linspace(0, 0.5, n + 1)
    at = twist_wave(x * L, T * L / C, L, C, b)
    np.testing.assert_allclose(at.theta, theta, atol=2e-4)
    smooth = np.abs(np.cos(np.pi * (x - T)) * np.cos(np.pi * (x + T))) > 0.02
    np.testing.assert_allclose((L * at.theta_prime)[smooth], theta_x[smooth], atol=2e-3)


def test_without_damping_half_the_rod_is_untwisted_at_once() -> None:
    """theta_x is 0 or Tw/L, with the front at L/2 - c t; untwisted at L/2c, reversed at L/c."""
    x = np.array([0.0, 0.05, 0.09, 0.119])
    for t in (0.02 / C, 0.06 / C):
        front = L / 2 - C * t
        np.testing.assert_allclose(twist_wave(x, t, L, C, 0.0).theta_prime * L, x < front, atol=1e-12)
    np.testing.assert_allclose(twist_wave(x, L / (2 * C), L, C, 0.0).theta, 0.0, atol=1e-12)
    np.testing.assert_allclose(twist_wave(x, L / C, L, C, 0.0).theta, -x / L, atol=1e-12)


@pytest.mark.parametrize(("factor", "left"), [(1.0, 0.23), (1.3, 0.37)])
def test_twist_density_left_at_the_clamp(factor: float, left: float) -> None:
    """At t = L/c: 23 % with b = pi c/L, and 37 % with the measured b, of what was there."""
    at = twist_wave(0.0, L / C, L, C, factor * math.pi * C / L)
    assert L * at.theta_prime == pytest.approx(left, abs=0.005)


def test_few_modes_are_enough() -> None:
    x, t = np.linspace(0, L / 2, 50), np.linspace(1e-6, 3 * L / C, 40)[:, None]
    b = 10 * C / L
    few, many = twist_wave(x, t, L, C, b), twist_wave(x, t, L, C, b, modes=3000)
    np.testing.assert_allclose(few.theta, many.theta, atol=1e-7)
    np.testing.assert_allclose(few.theta_prime * L, many.theta_prime * L, rtol=0, atol=3e-7)


@pytest.mark.parametrize("b", [0.0, 0.5, 0.999999999, 1.0, 1.000000001, 2.0, 50.0])
def test_mode_solves_its_equation(b: float) -> None:
    """Against a tenth-order expansion of f'' + 2 b f' + f = 0 stepped in time."""
    t, dt = 0.0, 0.002
    f, g = 1.0, 0.0
    for _ in range(1000):
        k = [(g, -2 * b * g - f)]
        for w in (dt / 2, dt / 2, dt):
            u, v = f + w * k[-1][0], g + w * k[-1][1]
            k.append((v, -2 * b * v - u))
        f += dt / 6 * (k[0][0] + 2 * k[1][0] + 2 * k[2][0] + k[3][0])
        g += dt / 6 * (k[0][1] + 2 * k[1][1] + 2 * k[2][1] + k[3][1])
        t += dt
    assert float(mode(t, 1.0, b)) == pytest.approx(f, abs=2e-7)
    assert float(mode(0.0, 1.0, b)) == 1.0
