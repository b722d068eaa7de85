"""Cylinders among fibers: exact gradients, momentum, the solve, and what may not be passed through."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import Probe, gradient, midpoints, random_strand, toy_model
from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError
from torsade.motion import ends
from torsade.motion.overdamped import Motion, Stepping
from torsade.motion.piercing import pierced
from torsade.motion.wound import Tissue, tied_around
from torsade.rod.contact import contact_pressure
from torsade.rod.skin import (
    add_skin_drag,
    add_skin_forces,
    add_skin_torques,
    power_of_skin,
    skin_energy,
    weigh_skin,
)

H, H_S = 0.1, 0.4


def wrapped(seed=0, friction=0.0, drag=1.0):
    """Random fibers that dip into two cylinders, which overlap a little, away from rest."""
    rng = np.random.default_rng(seed)
    turn = np.linspace(0.3, 4.0, 40)
    arc = (H_S + 0.8 * H) * np.column_stack([np.cos(turn), np.sin(turn), 0.3 * turn])
    aside = np.array([0.9, 0.3, 0.0])
    strands = [arc + 0.2 * H * rng.normal(size=arc.shape), random_strand(seed, 12) + aside]
    a = assemble(strands)
    axes = np.array([[0.0, 0.0, 0.0], [2 * H_S - 0.3 * H, 0.1, 0.0]])
    tissue = Tissue(H_S, 3.0, 0.7, drag, friction, 1e-3)
    state = initial_state(a, strands)
    a, state, bc = tied_around(a, state, ends.free(a), axes, tissue)
    state.x[-2:] += 0.05 * H * rng.normal(size=(2, 3))
    return a, state, bc, toy_model(H)


def found(a, m, skin, x):
    """Forces of the skin alone, and its energies, at positions x."""
    force, mid = np.zeros_like(x), midpoints(a, x)
    add_skin_forces(a, m, skin, x, mid, force)
    return force, skin_energy(a, m, skin, x, mid)


@pytest.mark.parametrize("seed", [0, 1])
def test_forces_are_the_gradient_of_the_energy(seed):
    """Those of contacts, of cylinders on each other, and of springs."""
    a, state, bc, m = wrapped(seed)
    force, (contact, spring) = found(a, m, bc.skin, state.x)
    assert contact > 0
    assert spring > 0
    assert bc.skin.count[0] > 15
    slope = gradient(lambda x: sum(found(a, m, bc.skin, x)[1]), state.x, 1e-4 * H)
    assert np.abs(force + slope).max() < 1e-7 * np.abs(force).max()


def test_action_equals_reaction():
    """What fibers and cylinders do to each other adds up to nothing, by contact and by drag."""
    a, state, bc, m = wrapped()
    force, _ = found(a, m, bc.skin, state.x)
    spring = -bc.skin.stiffness * (state.x[-2:] - bc.skin.rest)
    assert np.abs(force.sum(axis=0) - spring.sum(axis=0)).max() < 1e-13 * np.abs(force).max()
    v = np.random.default_rng(3).normal(size=state.x.shape)
    weigh_skin(a, m, bc.skin, v)
    drag = np.zeros_like(v)
    add_skin_drag(a, bc.skin, v, drag)
    ground = bc.skin.ground * v[-2:].sum(axis=0)
    assert np.abs(drag.sum(axis=0) - ground).max() < 1e-12 * np.abs(drag).max()


def test_power_of_some_nodes_is_their_part_of_what_drag_takes():
    """Sum of v_i . (M v)_i over the nodes chosen, cylinders among them."""
    a, state, bc, m = wrapped()
    found(a, m, bc.skin, state.x)
    rng = np.random.default_rng(7)
    v, drag = rng.normal(size=state.x.shape), np.zeros_like(state.x)
    weigh_skin(a, m, bc.skin, v)
    add_skin_drag(a, bc.skin, v, drag)
    for chosen in (rng.uniform(size=len(v)) < 0.4, np.ones(len(v), bool)):
        expected = (v * drag).sum(axis=1)[chosen].sum()
        assert power_of_skin(a, bc.skin, v, chosen) == pytest.approx(expected, rel=1e-11)


def test_skin_presses_as_a_strand_does():
    """An edge on skin is pushed as an edge 2h long pushes it at the same overlap."""
    a, state, bc, m = wrapped()
    found(a, m, bc.skin, state.x)
    n = bc.skin.count[0]
    edge, cylinder = bc.skin.edge[:n], bc.skin.cylinder[:n]
    apart = np.linalg.norm((midpoints(a, state.x)[edge] - state.x[-2:][cylinder])[:, :2], axis=1)
    expected = [
        2 * H * a.rest_length[e] * contact_pressure(m, d - H_S + H) for e, d in zip(edge, apart, strict=True)
    ]
    assert bc.skin.push[:n] == pytest.approx(np.array(expected), rel=1e-12)


@pytest.mark.parametrize("direct", [True, False])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_velocities_balance_all_forces(direct, friction):
    """M v = F for fibers and cylinders, directly and by conjugate gradients, dry friction included."""
    a, state, bc, m = wrapped(friction=friction)
    probe = Probe(a, m, state, bc, direct)
    v, _, _ = probe.rates(state.x, state.theta)
    drag = -probe.drag_forces(v, m.eta_A)
    add_skin_drag(a, bc.skin, v, drag)
    free = ~probe.work.held
    assert free[-2:].all()
    left = np.abs(drag - probe.work.force)[free].max()
    assert left < (1e-8 if friction == 0 else 1e-2) * np.abs(probe.work.force).max()
    assert probe.powers(state.x, state.theta)[1] > 0


def test_dry_friction_is_at_most_its_share_of_the_normal_force():
    """And nearly so where the fiber slides much faster than v_0."""
    a, state, bc, m = wrapped(friction=0.4, drag=0.0)
    found(a, m, bc.skin, state.x)
    n = bc.skin.count[0]
    for speed in (1e-6, 1.0):
        v = np.zeros_like(state.x)
        v[:-2, 2] = speed
        weigh_skin(a, m, bc.skin, v)
        share = 0.4 * speed / np.hypot(speed, bc.skin.slip_speed)
        assert bc.skin.weight[:n] * speed == pytest.approx(share * bc.skin.push[:n], rel=1e-12)


def test_torques_take_less_than_the_drag_gives():
    """Collision torque may feed spin, never more than the drag of the same contact dissipates."""
    a, state, bc, m = wrapped()
    found(a, m, bc.skin, state.x)
    rng = np.random.default_rng(5)
    tangent = np.diff(state.x[:-2], axis=0)[np.arange(len(a.edges)) + (np.arange(len(a.edges)) >= 39)]
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    for _ in range(20):
        v = rng.normal(size=state.x.shape)
        v[-2:] = 0
        weigh_skin(a, m, bc.skin, v)
        drag, torque, weight = np.zeros_like(v), np.zeros(len(a.edges)), np.zeros(len(a.edges))
        add_skin_drag(a, bc.skin, v, drag)
        add_skin_torques(a, m, bc.skin, v, tangent, torque, weight)
        touched = weight > 0
        fed = (torque[touched] ** 2 / weight[touched]).sum() / 4  # at worst, with spins of half the rate
        assert 0 < fed < 0.1 * (v * drag).sum()


def test_sliding_along_the_cylinder_rolls_the_fiber():
    """A ring around a cylinder, moved along z, is turned inside out as a sleeve is rolled down."""
    turn = 2 * np.pi * np.arange(60) / 60
    ring = (H_S + 0.9 * H) * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    a = assemble([ring], [True])
    a, state, bc = tied_around(
        a, initial_state(a, [ring]), ends.free(a), np.zeros((1, 3)), Tissue(H_S, 1.0, 1.0)
    )
    m = toy_model(H)
    found(a, m, bc.skin, state.x)
    v = np.zeros_like(state.x)
    v[:-1, 2] = 1.0
    tangent = np.roll(ring, -1, axis=0) - ring
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    torque, weight = np.zeros(60), np.zeros(60)
    add_skin_torques(a, m, bc.skin, v, tangent, torque, weight)
    # Its contact point stays behind: seen along the tangent it spins by v/2h, about -theta.
    assert torque / weight == pytest.approx(np.full(60, torque[0] / weight[0]), rel=1e-9)
    assert abs(torque[0] / weight[0]) == pytest.approx(1.0 / (2 * H), rel=1e-9)


@pytest.mark.parametrize(
    ("way", "through"),
    [((0.0, 0.0), False), ((-0.5 * H, 0.0), False), ((-1.5 * H, 0.0), True), ((-3.0, 0.0), True)],
)
def test_no_fiber_goes_into_a_cylinder(way, through):
    """Into it, or in one leap through to its other side; along its surface is free."""
    x = np.array([[H_S + H, -0.2, 0.0], [H_S + H, 0.2, 0.0]])
    a = assemble([x])
    a, state, bc = tied_around(
        a, initial_state(a, [x]), ends.free(a), np.zeros((1, 3)), Tissue(H_S, 1.0, 1.0)
    )
    after = state.x.copy()
    after[:2, :2] += way
    assert pierced(a, bc.skin, state.x, after) == ((0, 1) if through else (-1, -1))
    after = state.x.copy()
    after[2, :2] -= way  # as well when it is the cylinder that moves
    assert pierced(a, bc.skin, state.x, after) == ((0, 1) if through else (-1, -1))


def test_no_cylinder_goes_into_the_other():
    x = np.array([[5.0, 0, 0], [5.0, 1.0, 0]])
    a = assemble([x])
    axes = np.array([[-H_S, 0.0, 0.0], [H_S, 0.0, 0.0]])
    a, state, bc = tied_around(a, initial_state(a, [x]), ends.free(a), axes, Tissue(H_S, 1.0, 1.0))
    for step, hit in ((0.1 * H_S, False), (1.5 * H_S, True), (6 * H_S, True)):
        after = state.x.copy()
        after[2, 0] += step
        assert (pierced(a, bc.skin, state.x, after)[0] >= 0) == hit


@pytest.mark.parametrize(
    ("count", "ground", "asked"), [(0, 1.0, "1 to 3"), (4, 1.0, "1 to 3"), (2, 0.0, "above 0")]
)
def test_no_more_cylinders_than_are_solved_for(count, ground, asked):
    """A fourth would be written beyond the rows that hold its response; without drag nothing balances one."""
    x = np.array([[5.0, 0, 0], [5.0, 1.0, 0]])
    a = assemble([x])
    axes = np.arange(count)[:, None] * [3 * H_S, 0.0, 0.0]
    with pytest.raises(TorsadeError, match=asked):
        tied_around(a, initial_state(a, [x]), ends.free(a), axes, Tissue(H_S, 1.0, ground))


def test_skin_alone_goes_back_to_rest():
    """Displaced by d and touched by nothing, w - w_0 = d exp(-k_s t/zeta), along z as across it."""
    x = np.array([[5.0, 0, 0], [5.0, 0.1, 0], [5.0, 0.2, 0]])
    a = assemble([x])
    a, state, bc = tied_around(
        a, initial_state(a, [x]), ends.free(a), np.zeros((1, 3)), Tissue(H_S, 3.0, 0.7)
    )
    away = 0.1 * H * np.array([1.0, -2.0, 3.0])
    state.x[3] += away
    motion = Motion(a, toy_model(H), bc, state, Stepping(tolerance=1e-6))
    motion.advance(0.5)
    assert motion.state.x[3] == pytest.approx(away * np.exp(-0.5 * 3.0 / 0.7), rel=1e-3)
    assert motion.dissipation == pytest.approx(1.5 * away @ away * (1 - np.exp(-3.0 / 0.7)), rel=1e-3)
