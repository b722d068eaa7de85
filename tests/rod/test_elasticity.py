"""Forces are exact gradients: fourth-order differences of the energies, each alone and all together."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import Probe, circle, gradient, three_cases, toy_model
from torsade.assembly import assemble, initial_state

ALONE = {
    "stretch": {"EA": 3.0, "B": 0.0, "C": 0.0},
    "bend": {"EA": 0.0, "B": 2e-3, "C": 0.0},
    "twist": {"EA": 0.0, "B": 0.0, "C": 1.5e-3},
    "all": {"EA": 3.0, "B": 2e-3, "C": 1.5e-3},
}


@pytest.mark.parametrize("case", range(3))
@pytest.mark.parametrize("present", [False, True])
@pytest.mark.parametrize("part", list(ALONE))
def test_force_is_minus_the_gradient(case, present, part):
    """F = -dE/dx with frames transported from the state (Bergou et al. 2010), to 1e-7 of the largest."""
    a, state = three_cases()[case]
    m = toy_model(h=1e-3, bend_present=present, **ALONE[part])
    probe = Probe(a, m, state)
    force, torque = probe.forces(state.x, state.theta)
    by_x = -gradient(lambda x: probe.energy(x, state.theta), state.x, 1e-4)
    by_theta = -gradient(lambda theta: probe.energy(state.x, theta), state.theta, 1e-2)
    assert np.abs(force - by_x).max() < 1e-7 * np.abs(force).max()
    assert np.abs(torque - by_theta).max() < 1e-7 * np.abs(torque).max() + 1e-15
    assert np.abs(force).max() > 0


@pytest.mark.parametrize("present", [False, True])
def test_short_fibers_side_by_side(present):
    """Fibers of one, two and three edges and a triangle, in one assembly: forces are gradients there too."""
    rng = np.random.default_rng(4)
    strands = [0.3 * np.arange(n)[:, None] + 0.1 * rng.normal(size=(n, 3)) + 5.0 * n for n in (2, 3, 4)]
    strands.append(circle(3, 0.3) + 0.05 * rng.normal(size=(3, 3)))
    a = assemble(strands, [False, False, False, True])
    state = initial_state(a, strands)
    state.theta[:] += rng.normal(size=len(state.theta))
    probe = Probe(a, toy_model(h=1e-3, bend_present=present, **ALONE["all"]), state)
    force, torque = probe.forces(state.x, state.theta)
    by_x = -gradient(lambda x: probe.energy(x, state.theta), state.x, 1e-4)
    by_theta = -gradient(lambda theta: probe.energy(state.x, theta), state.theta, 1e-2)
    assert np.abs(force - by_x).max() < 1e-6 * np.abs(force).max()
    assert np.abs(torque - by_theta).max() < 1e-7 * np.abs(torque).max()


@pytest.mark.parametrize("case", range(3))
@pytest.mark.parametrize("present", [False, True])
def test_forces_and_moments_balance(case, present):
    """A rigid motion costs nothing: forces sum to zero, their moments to minus the torques' (Noether)."""
    a, state = three_cases()[case]
    m = toy_model(h=1e-3, bend_present=present)
    probe = Probe(a, m, state)
    force, torque = probe.forces(state.x, state.theta)
    moment = np.cross(state.x, force).sum(axis=0) + torque @ probe.tangent
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    assert np.abs(moment).max() < 1e-12 * np.abs(np.cross(state.x, force)).sum()


def test_energy_of_a_stretched_twisted_ring():
    """Closed form of a regular n-gon stretched by 10 % and twisted evenly."""
    n, R = 40, 1.0
    x = circle(n, R)
    l = 2 * R * np.tan(np.pi / n)
    a = assemble([x], [True], [np.full(n, l / 1.1)])
    state = initial_state(a, [x])
    m = toy_model()
    state.reference_twist[0] += 2 * np.pi
    stretch, bend, twist, contact = Probe(a, m, state).energies(state.x, state.theta)
    rest = l / 1.1
    assert stretch == pytest.approx(0.5 * m.EA * 0.1**2 * n * rest, rel=1e-12)
    assert bend == pytest.approx(0.5 * m.B * n * (2 * np.tan(np.pi / n)) ** 2 / rest, rel=1e-12)
    assert twist == pytest.approx(0.5 * m.C * (2 * np.pi) ** 2 / rest, rel=1e-12)
    assert contact == 0.0
    present = Probe(a, m._replace(bend_present=True), state).energies(state.x, state.theta)
    assert present[1] == pytest.approx(bend / 1.1, rel=1e-12)


def test_even_twist_of_a_ring_is_an_equilibrium():
    """A ring at rest length with even twist feels no force and no torque (2.33: M' + t x F = 0)."""
    n = 30
    x = circle(n, 1.0)
    a = assemble([x], [True])
    state = initial_state(a, [x])
    state.reference_twist[:] += 0.3
    m = toy_model()
    force, torque = Probe(a, m, state).forces(state.x, state.theta)
    assert np.abs(torque).max() < 1e-12 * m.C
    radial = np.einsum("ij,ij->i", force[:, :2], x[:, :2])
    assert np.abs(radial).max() < 1e-10 * m.B
    assert np.abs(force).max() < 1e-10 * m.B
