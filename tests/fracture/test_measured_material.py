"""Material from measurements: made-up samples, the thesis's numbers, and the pendulum's equation solved."""

import math

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.fracture.measured import (
    GRAVITY,
    cylinder_inertia,
    density,
    exactly,
    half_life_rate,
    poisson_ratio,
    shear_modulus,
    twist_damping,
    young_modulus,
)
from torsade.fracture.pendulum import fit_swing
from torsade.fracture.rod import spaghetti

ROD = spaghetti()
H = exactly(ROD.h, 0.025e-3)


def test_young_modulus_of_samples_that_buckle() -> None:
    """m g = pi^2 E I/l^2: 3.8 GPa back, and four times the relative error of the radius."""
    lengths = np.array([0.12, 0.16, 0.2, 0.24])
    masses = math.pi**2 * ROD.B / (GRAVITY * lengths**2)
    found = young_modulus(masses, lengths, H)
    assert found.value == pytest.approx(ROD.E, rel=1e-12)
    assert found.error == pytest.approx(4 * 0.025 / 0.7 * ROD.E, rel=1e-9)


def test_scatter_and_radius_add_in_squares() -> None:
    """Against many made-up laboratories, each with its own radius and samples."""
    generator = np.random.default_rng(4)
    lengths = np.full(20, 0.2)
    mass = math.pi**2 * ROD.B / (GRAVITY * 0.2**2)
    results, errors = [], []
    for _ in range(1500):
        masses = mass * (1 + generator.normal(0, 0.1, 20))
        found = young_modulus(masses, lengths, exactly(ROD.h * (1 + generator.normal(0, 0.01)), 0.01 * ROD.h))
        results.append(found.value)
        errors.append(found.error)
    assert np.std(results) == pytest.approx(np.mean(errors), rel=0.06)


def test_density_of_weighed_samples() -> None:
    mass = 1500 * math.pi * ROD.h**2 * 0.24
    found = density([mass, 1.1 * mass, 0.9 * mass], [0.24] * 3, H)
    assert found.value == pytest.approx(1500, rel=1e-12)
    assert found.error == pytest.approx(1500 * math.hypot(0.1 / math.sqrt(3), 2 * 0.025 / 0.7), rel=1e-9)


def test_poisson_ratio_of_the_thesis() -> None:
    """3.8 +- 0.3 and 1.5 +- 0.2 GPa: 0.27 +- 0.20; the thesis gives 0.3 +- 0.1."""
    found = poisson_ratio(exactly(3.8e9, 0.3e9), exactly(1.5e9, 0.2e9))
    assert found.value == pytest.approx(3.8 / 3.0 - 1)
    assert found.error == pytest.approx(0.196, abs=1e-3)


def pendulum(b: float, inertia: float, n: int = 120) -> complex:
    """The slowest eigenvalue of a damped rod with a mass at its end, by finite elements.

    2 rho I (theta_tt + 2 b theta_t) = 2 mu I theta_xx along it, I_0 theta_tt = -2 mu I theta_x at the end.
    """
    l, I = ROD.L / n, ROD.section.I
    stiff = np.zeros((n + 1, n + 1))
    mass = np.zeros((n + 1, n + 1))
    for e in range(n):
        pair = np.ix_((e, e + 1), (e, e + 1))
        stiff[pair] += 2 * ROD.mu * I / l * np.array([[1, -1], [-1, 1]])
        mass[pair] += 2 * ROD.rho * I * l / 6 * np.array([[2, 1], [1, 2]])
    drag = 2 * b * mass
    mass[n, n] += inertia
    stiff, mass, drag = (m[1:, 1:] for m in (stiff, mass, drag))
    # The mass dominates: from the undamped pendulum iteration converges in few steps.
    s = 1j * math.sqrt(ROD.C / (inertia * ROD.L))
    u = np.linspace(1 / n, 1.0, n).astype(complex)
    for _ in range(20):
        u = np.linalg.solve(stiff + s * drag + s * s * mass, mass @ u)
        u /= u[-1]
        a, c, k = u @ mass @ u, u @ drag @ u, u @ stiff @ u
        s = (-c + np.sqrt(c * c - 4 * a * k)) / (2 * a)
    return complex(s)


def test_pendulum_gives_back_mu_and_b() -> None:
    """Frequency and decay of the whole damped rod with a heavy mass, solved as an eigenvalue problem.

    With the thesis's formula, h_0 in place of L/3, b comes out 8 times as large for a mass 1 cm high.
    """
    inertia = 2e-6
    b = 1.3 * math.pi * ROD.c_theta / ROD.L
    s = pendulum(b, inertia)
    own = ROD.rho * ROD.section.J * ROD.L / 3
    total, radius, rho = exactly(inertia + own), exactly(ROD.h), exactly(ROD.rho)
    mu = shear_modulus([s.imag], [-s.real], [ROD.L], total, radius)
    assert mu.value == pytest.approx(ROD.mu, rel=5e-4)
    found = twist_damping([-s.real], [ROD.L], total, radius, rho)
    assert found.value == pytest.approx(b, rel=2e-3)
    printed = twist_damping([-s.real], [ROD.L], total, radius, rho, mass_height=0.01)
    assert printed.value / found.value == pytest.approx(8.0, rel=1e-12)


def test_printed_damping_is_the_thesis_s_formula() -> None:
    """b = I_0 omega ln 2/(2 rho I 2 pi h_0 N_1/2)."""
    inertia, omega, h_0, count = 2e-6, 5.0, 0.01, 7.0
    printed = inertia * omega * math.log(2) / (2 * ROD.rho * ROD.section.I * 2 * math.pi * h_0 * count)
    found = twist_damping(
        [half_life_rate(omega, count)], [ROD.L], exactly(inertia), exactly(ROD.h), exactly(ROD.rho), h_0
    )
    assert found.value == pytest.approx(printed, rel=1e-12)


def test_inertia_of_a_cylinder() -> None:
    assert cylinder_inertia(0.05, 0.02) == pytest.approx(1e-5)


@pytest.mark.parametrize("decay", [0.0, 0.3, 3.0])
def test_swing_is_found_in_a_noisy_track(decay: float) -> None:
    """Within four standard errors, and these are as small as the noise allows."""
    generator = np.random.default_rng(8)
    t = np.sort(generator.uniform(0, 6, 400)) + 17.0
    clean = 0.2 + 1.4 * np.exp(-decay * (t - t[0])) * np.cos(9.3 * (t - t[0]) + 0.4)
    found = fit_swing(t, clean + generator.normal(0, 0.01, len(t)))
    assert abs(found.omega - 9.3) < 4 * found.omega_error
    assert abs(found.decay - decay) < 4 * found.decay_error
    assert found.omega_error < 0.03
    assert found.residual == pytest.approx(0.01, rel=0.15)
    assert found.rest == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize(
    ("t", "angle", "sentence"),
    [
        (np.arange(5), np.arange(5), "has 5 points; give at least 12"),
        (np.zeros(20), np.arange(20), "do not increase"),
        (np.arange(20), np.ones(20), "does not move"),
        (np.arange(40), np.cos(0.1 * np.arange(40)), "less than one oscillation"),
    ],
)
def test_what_is_no_swing_gets_a_sentence(t: np.ndarray, angle: np.ndarray, sentence: str) -> None:
    with pytest.raises(TorsadeError, match=sentence):
        fit_swing(t, angle)


def test_samples_must_be_positive() -> None:
    with pytest.raises(TorsadeError, match="masses of samples must be finite and above 0"):
        young_modulus([0.1, -0.1], [0.2, 0.2], H)
