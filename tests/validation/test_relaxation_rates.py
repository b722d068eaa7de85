"""Exact relaxation rates of the overdamped rod (thesis 2.33; ERRATA chapter 2), to 1 %.

    strain  exp(-E t/eta)    at every wavelength
    twist   exp(-mu t/eta)   at every wavelength
    bending exp(-E_b h^2 k^2 t/(4 eta))   for the mode of wave number k

Internal damping is a Laplacian, so strain and twist have one rate each: energy and damping carry the same
two derivatives. Bending energy carries two more.
"""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import circle, straight, toy_model
from torsade.assembly import assemble, initial_state
from torsade.material import Material, Section
from torsade.motion import ends
from torsade.motion.overdamped import Motion, Stepping, model

FINE = Stepping(tolerance=1e-7, solver_tolerance=1e-9)
FIBER = Material("fiber", E=2e3, E_b=5e2, nu=0.25, rho=1.0, eta=10.0)


def decay(motion, amplitude, until, pieces=4):
    """Rate [1/s] of the exponential through amplitudes at evenly spaced times; checks it is one."""
    times, values = [], []
    for k in range(pieces + 1):
        if k:
            motion.advance(k * until / pieces)
        times.append(motion.time)
        values.append(np.log(amplitude(motion.state)))
    slope, offset = np.polyfit(times, values, 1)
    assert np.abs(np.polyval([slope, offset], times) - values).max() < 0.01 * abs(slope) * until
    return -slope


@pytest.mark.parametrize("wave", [1, 3, 10, 24])
@pytest.mark.parametrize("holding", ["free", "clamped"])
def test_strain_decays_at_E_over_eta(wave, holding):
    """Standing strain waves from the longest to the shortest the mesh holds, one rate for all."""
    n, h = 26, 0.01
    x = straight(n, 1.0)
    a = assemble([x])
    strain = 1e-4 * np.cos(np.pi * wave * (np.arange(n - 1) + 0.5) / (n - 1))
    moved = x.copy()
    moved[1:, 0] += np.cumsum(strain * a.rest_length)
    bc = ends.free(a)
    if holding == "clamped":
        bc = ends.clamp(ends.clamp(bc, a, 0, 0), a, 0, 1)
    motion = Motion(a, model(FIBER, Section(h)), bc, initial_state(a, [moved]), FINE)

    def amplitude(state):
        return abs(np.sum(strain * (np.linalg.norm(np.diff(state.x, axis=0), axis=1) / a.rest_length - 1)))

    assert decay(motion, amplitude, 2 * FIBER.eta / FIBER.E) == pytest.approx(FIBER.E / FIBER.eta, rel=0.01)


@pytest.mark.parametrize("wave", [1, 4, 23])
@pytest.mark.parametrize("holding", ["free", "clamped"])
def test_twist_decays_at_mu_over_eta(wave, holding):
    """Twist waves on a straight fiber, ends free to spin or held; one rate for all wavelengths."""
    n, h = 26, 0.01
    x = straight(n, 1.0)
    a = assemble([x])
    m = 1e-2 * np.sin(np.pi * wave * np.arange(1, n - 1) / (n - 1))
    if holding == "clamped":
        m -= m.mean()
    state = initial_state(a, [x])
    state.theta[1:] = np.cumsum(m)
    bc = ends.free(a)
    bc = ends.clamp(bc, a, 0, 0)
    if holding == "clamped":
        bc = ends.clamp(bc, a, 0, 1)
    motion = Motion(a, model(FIBER, Section(h)), bc, state, FINE)
    rate = decay(motion, lambda s: abs(np.sum(m * np.diff(s.theta))), 2 * FIBER.eta / FIBER.mu)
    assert rate == pytest.approx(FIBER.mu / FIBER.eta, rel=0.01)


def test_twist_of_a_closed_ring_spreads_at_mu_over_eta():
    """Uneven twist of a planar ring evens out at mu/eta but for the ring's curvature, (l/R)^2 small."""
    n, R, h = 200, 1.0, 0.01
    x = circle(n, R)
    a = assemble([x], [True])
    state = initial_state(a, [x])
    wave = 1e-3 * np.sin(2 * np.pi * 8 * np.arange(n) / n)
    state.theta[:] = wave
    motion = Motion(a, model(FIBER, Section(h)), ends.free(a), state, FINE)
    rate = decay(motion, lambda s: abs(wave @ s.theta), 2 * FIBER.eta / FIBER.mu)
    # the mode n_w of a ring: damping (n_w^2 + 1)/R^2, stiffness n_w^2/R^2 (omega d_3 turns with d_3)
    assert rate == pytest.approx(FIBER.mu / FIBER.eta * 64 / 65, rel=0.01)


def bending_rate(k, h):
    return FIBER.E_b * h**2 * k**2 / (4 * FIBER.eta)


@pytest.mark.parametrize("wave", [1, 2, 3])
def test_bending_of_a_hinged_fiber(wave):
    """Sine waves on a straight fiber with hinged ends, k = wave pi/L: exp(-E_b h^2 k^2 t/(4 eta))."""
    n, L, h = 61, 1.0, 0.02
    x = straight(n, L)
    a = assemble([x])
    mode = np.sin(np.pi * wave * x[:, 0] / L)
    moved = x.copy()
    moved[:, 1] += 1e-3 * h * mode
    moved[:, 2] -= 0.7e-3 * h * mode
    bc = ends.clamp(ends.clamp(ends.free(a), a, 0, 0), a, 0, 1)
    assembly = assemble([x])
    motion = Motion(assembly, model(FIBER, Section(h)), bc, initial_state(a, [moved]), FINE)
    expected = bending_rate(np.pi * wave / L, h)
    rate = decay(motion, lambda s: np.linalg.norm(mode @ s.x[:, 1:]), 1.0 / expected)
    assert rate == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("wave", [2, 3])
def test_bending_of_a_ring_in_its_plane(wave):
    """The angle q(s) of an inextensible ring obeys eta A dq/dt = E_b I q'', so k = wave/R and the same law.

    Exact: a naturally straight ring carries moment but no force, so that its energy is 1/2 B q'^2 about
    the circle for every wave >= 2, and the dissipation is 1/2 eta A (dq/dt)^2.
    """
    n, R, h = 120, 1.0, 0.02
    x = circle(n, R)
    a = assemble([x], [True])
    phi = np.arctan2(x[:, 1], x[:, 0])
    out, along = x / np.linalg.norm(x, axis=1, keepdims=True), np.stack([-x[:, 1], x[:, 0], 0 * phi], axis=1)
    mode = np.cos(wave * phi)[:, None] * out - (np.sin(wave * phi) / wave)[:, None] * along
    state = initial_state(a, [x + 1e-3 * h * mode])
    motion = Motion(a, model(FIBER, Section(h)), ends.free(a), state, FINE)
    expected = bending_rate(wave / R, h)

    def amplitude(s):
        return abs(np.sum(np.cos(wave * phi) * np.einsum("ij,ij->i", s.x - x, out)))

    assert decay(motion, amplitude, 1.0 / expected) == pytest.approx(expected, rel=0.01)


def test_rates_follow_from_the_model_alone():
    """The model's coefficients are E A, E_b I, mu J, eta A, eta J of a circle (thesis 2.30)."""
    m, h = toy_model(0.1), 0.1
    assert pytest.approx(1e3 * np.pi * h**2) == m.EA
    assert pytest.approx(1e3 * np.pi * h**4 / 4) == m.B
    assert pytest.approx(1e3 / 2.6 * np.pi * h**4 / 2) == m.C
    assert m.eta_A / m.EA == pytest.approx(0.01)
    assert m.eta_J / m.C == pytest.approx(0.01 * 2.6)
    assert m.eta_f_A == pytest.approx(3.3 * m.eta_A)
