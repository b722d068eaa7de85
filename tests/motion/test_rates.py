"""Rates of motion: the spin of the material frame, the balance of power, bodies that float or slip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rod.helpers import (
    Probe,
    random_strand,
    straight,
    tangle,
    three_cases,
    toy_model,
)
from torsade.assembly import assemble, initial_state
from torsade.motion import ends
from torsade.motion.overdamped import STANDARD
from torsade.rod.kinematics import edge_geometry, transport


def away_from_base(case, size=0.4):
    """A state, and nodes far from it, so that frames are carried over large angles."""
    a, state = three_cases()[case]
    rng = np.random.default_rng(case)
    x = state.x + size * 0.1 * rng.normal(size=state.x.shape)
    return a, state, x, state.theta + 0.1 * rng.normal(size=state.theta.shape)


def material_director(a, probe, x, theta):
    """d_1 of every edge: the base director transported straight to the present tangent, turned by theta."""
    length, tangent = np.empty(len(a.edges)), np.empty((len(a.edges), 3))
    edge_geometry(a, x, length, tangent)
    u = np.empty_like(tangent)
    for e in range(len(u)):
        transport(probe.state.director[e], probe.tangent[e], tangent[e], u[e])
    c, s = np.cos(theta)[:, None], np.sin(theta)[:, None]
    return c * u + s * np.cross(tangent, u), tangent


@pytest.mark.parametrize("case", range(3))
def test_material_frame_spins_with_omega(case):
    """(d d_1/dt x along t) = omega though angles are measured from directors that turn themselves.

    Finite differences of the actual director along the computed rates, far from the base state.
    """
    a, state, x, theta = away_from_base(case)
    probe = Probe(a, toy_model(h=0.02), state)
    v, omega, angular = probe.rates(x, theta)
    dt = 1e-5 * 0.1 / max(np.abs(v).max(), 0.1 * np.abs(omega).max())
    after, _ = material_director(a, probe, x + dt * v, theta + dt * angular)
    before, _ = material_director(a, probe, x - dt * v, theta - dt * angular)
    d1, tangent = material_director(a, probe, x, theta)
    spin = np.einsum("ij,ij->i", (after - before) / (2 * dt), np.cross(tangent, d1))
    assert np.abs(spin - omega).max() < 1e-7 * np.abs(omega).max()
    assert np.abs(angular - omega).max() > 1e-3 * np.abs(omega).max()


@pytest.mark.parametrize("case", range(3))
@pytest.mark.parametrize("present", [False, True])
def test_power_of_internal_forces_far_from_the_base(case, present):
    """dE/dt = -F.v - tau.omega along the rates, though E depends on angles in a frame that turns."""
    a, state, x, theta = away_from_base(case)
    probe = Probe(a, toy_model(h=0.02, bend_present=present), state)
    v, omega, angular = probe.rates(x, theta)
    force, torque = probe.forces(x, theta)
    dt = 1e-3 * 0.1 / max(np.abs(v).max(), 0.1 * np.abs(omega).max())
    e = [probe.energy(x + k * dt * v, theta + k * dt * angular) for k in (-2, -1, 1, 2)]
    rate = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * dt)
    expected = -np.sum(force * v) - torque @ omega
    assert rate == pytest.approx(expected, rel=1e-7)


def driven(a, kind, rng):
    bc = ends.free(a)
    if kind == "pulled":
        bc = ends.clamp(ends.pull(bc, a, 1, 1, rng.normal(size=3)), a, 1, 0, tangent=True)
    elif kind == "moved":
        bc = ends.move(ends.clamp(bc, a, 1, 0), a, 1, 1, rng.normal(size=3), spin=None, tangent=True)
    elif kind == "turned":
        bc = ends.turn(ends.turn(bc, a, 1, 1, 7.0), a, 1, 0, -5.0)
    elif kind == "loaded":
        force = rng.normal(size=bc.force.shape)
        bc = bc._replace(force=force - force.mean(axis=0), torque=0.01 * rng.normal(size=bc.torque.shape))
    return bc


@pytest.mark.parametrize("kind", ["free", "pulled", "moved", "turned", "loaded"])
@pytest.mark.parametrize("ratio", [1e-3, 0.1, 3.3, 100.0])
def test_power_is_balanced(kind, ratio):
    """dE/dt + dissipation = external power, in tangles with contact, for every way to drive them."""
    rng = np.random.default_rng(0)
    a, state, h = tangle(1)
    m = toy_model(h, replace(STANDARD, eta_f_ratio=ratio))
    probe = Probe(a, m, state, driven(a, kind, rng))
    v, _, angular = probe.rates(state.x, state.theta, 1e-13)
    external, dissipated = probe.powers(state.x, state.theta)
    dt = 1e-5 * h / max(np.abs(v).max(), h * np.abs(angular).max())
    e = [probe.energy(state.x + k * dt * v, state.theta + k * dt * angular) for k in (-2, -1, 1, 2)]
    rate = (e[0] - 8 * e[1] + 8 * e[2] - e[3]) / (12 * dt)
    assert dissipated > 0
    assert rate + dissipated == pytest.approx(external, abs=1e-6 * dissipated)
    assert (external == 0) == (kind == "free")


@pytest.mark.parametrize("ratio", [1e-3, 1.0, 1e3])
def test_dissipation_is_never_negative(ratio):
    """v.Mv + spin damping - collision torques > 0 for any velocities, though torques act one way only.

    Collisions turn strands and are not turned back (thesis 4.7); their gain W omega s is covered by the
    loss W omega^2 and the drag as long as J/A < 2 R^2, that is R > h/2: strands half crushed.
    """
    rng = np.random.default_rng(1)
    a, state, h = tangle(0)
    probe = Probe(a, toy_model(h, replace(STANDARD, eta_f_ratio=ratio)), state)
    for _ in range(20):
        torque = 10.0 ** rng.uniform(-6, 3) * rng.normal(size=len(a.edges))
        force = rng.normal(size=state.x.shape)
        probe.bc = probe.bc._replace(force=force - force.mean(axis=0), torque=torque)
        assert probe.powers(state.x, state.theta)[1] > 0


def test_a_free_tangle_stays_where_it_is():
    """No net external force: the centre (weighted by node length) does not move."""
    a, state, h = tangle(2)
    v, _, _ = Probe(a, toy_model(h), state).rates(state.x, state.theta)
    assert np.abs(a.node_length @ v).max() < 1e-12 * (a.node_length @ np.abs(v)).max()


def test_two_strands_apart_cannot_be_pulled():
    """A pulled strand that nothing holds has no velocity: the rates say so instead of a number."""
    strands = [straight(5, 1.0), straight(5, 1.0, 0, (0, 1, 0))]
    a = assemble(strands)
    state = initial_state(a, strands)
    bc = ends.pull(ends.clamp(ends.free(a), a, 0, 0), a, 1, 1, np.array([1.0, 0, 0]))
    probe = Probe(a, toy_model(), state, bc)
    with pytest.raises(AssertionError):
        probe.rates(state.x, state.theta)


def test_rigid_velocities_of_a_held_fiber_are_zero():
    """A clamped relaxed straight fiber does not move or spin at all."""
    x = straight(8, 1.0)
    a = assemble([x])
    state = initial_state(a, [x])
    probe = Probe(a, toy_model(), state, ends.clamp(ends.free(a), a, 0, 0))
    v, omega, _ = probe.rates(state.x, state.theta)
    assert np.abs(v).max() < 1e-12
    assert np.abs(omega).max() == 0


def test_pulled_straight_fiber_stretches_uniformly():
    """A clamped fiber pulled by F: every edge strains at F/(eta A), so v grows linearly along it."""
    n, F = 9, 2.0
    x = straight(n, 1.0)
    a = assemble([x])
    bc = ends.pull(ends.clamp(ends.free(a), a, 0, 0), a, 0, 1, np.array([F, 0, 0]))
    m = toy_model()
    v, _, _ = Probe(a, m, initial_state(a, [x]), bc).rates(x, np.zeros(n - 1))
    assert np.allclose(v[:, 0], F / m.eta_A * x[:, 0], rtol=1e-10, atol=1e-12)


def test_ends_say_what_is_wrong():
    """No end 2, no fiber 3, no ends on a closed fiber: one sentence that names what was given."""
    strands = [random_strand(0, 5), straight(4, 1.0) ** 2 + random_strand(1, 4)]
    a = assemble(strands, [False, True])
    with pytest.raises(ValueError, match="no end 2 of fiber 0"):
        ends.clamp(ends.free(a), a, 0, 2)
    with pytest.raises(ValueError, match="no end 0 of fiber 3"):
        ends.pull(ends.free(a), a, 3, 0, np.zeros(3))
    with pytest.raises(ValueError, match="fiber 1 is closed"):
        ends.turn(ends.free(a), a, 1, 0, 1.0)
    assert ends.end_node(a, 0, 1) == 4
    assert ends.end_edge(a, 0, 1) == 3
