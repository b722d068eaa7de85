"""Self-torque and velocity as recorded: at the state itself, by the law of the run, odd under mirrors."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import pairs_within, tangle, toy_model
from torsade.assembly import State, assemble, initial_state
from torsade.motion import ends
from torsade.motion.overdamped import PUBLISHED, STANDARD, Motion, Outcome, Stepping, model
from torsade.protocols import PrisonEscape


def moving(laws, seed=0, how=None):
    a, state, h = tangle(seed)
    bc = ends.clamp(ends.pull(ends.free(a), a, 1, 1, np.array([1.0, -0.5, 0.7])), a, 1, 0)
    motion = Motion(a, toy_model(h, laws), bc, state, how)
    motion.advance(1.0, max_steps=5)
    return motion


@pytest.mark.parametrize("laws", [STANDARD, PUBLISHED], ids=["continuum", "node-pair"])
def test_self_torque_is_the_sum_over_contacts(laws):
    """(4.10), brute force: eta_f J sum l' (r^ x dv).d3/R^4, or eta J sum (r^ x dv).d3/R^3."""
    motion = moving(laws)
    a, m, x, v = motion.assembly, motion.model, motion.state.x, motion.state.v
    expected = np.zeros(len(a.edges))
    mid, u = x[a.edges].mean(axis=1), v[a.edges].mean(axis=1)
    e = x[a.edges[:, 1]] - x[a.edges[:, 0]]
    d3 = e / np.linalg.norm(e, axis=1, keepdims=True)
    pairs = pairs_within(a, x, m.diameter, m.exclusion_edges, m.exclusion_length)
    assert len(pairs) > 10
    for i, j in [*pairs, *[(j, i) for i, j in pairs]]:
        r = mid[j] - mid[i]
        R = np.linalg.norm(r)
        turn = np.cross(r, u[j] - u[i]) @ d3[i] / R
        expected[i] += m.eta_f_J * turn * (1 / R**3 if m.node_pair else a.rest_length[j] / R**4)
    found = motion.measure().self_torque
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * abs(expected).max())


@pytest.mark.parametrize("how", [Stepping(), Stepping(fixed_step=1e-5)], ids=["chebyshev", "euler"])
def test_recorded_velocities_are_those_of_the_state(how):
    """Solved for anew from another guess, they agree to the tolerance of the solve, after either scheme."""
    motion = moving(STANDARD, how=how)
    again = Motion(motion.assembly, motion.model, motion.boundary, motion.state, how)
    again.state.v[:] = 0.0
    again.advance(1.0, max_steps=0)
    np.testing.assert_allclose(
        again.state.v, motion.state.v, rtol=1e-6, atol=1e-6 * abs(motion.state.v).max()
    )
    assert np.array_equal(again.state.x, motion.state.x)


def granny(until):
    """The granny under load."""
    spec = PrisonEscape(knot="granny")
    shape = spec.configuration()
    a = assemble(shape.strands)
    state = initial_state(a, shape.strands)
    experiment = spec.experiment(a, state)
    motion = Motion(a, model(spec.fiber_material, spec.section, spec.laws), experiment.boundary, state)
    while motion.advance(until) is Outcome.SLIPPED:
        experiment.catch(motion.state)
    return motion


def test_a_mirror_image_has_the_opposite_self_torque():
    """The granny, and the same reflected in z: contacts are summed in another order, nothing else differs."""
    motion = granny(0.02)
    mirror = np.array([1.0, 1.0, -1.0])
    s = motion.state
    image = State(s.x * mirror, -s.theta, s.director * mirror, -s.reference_twist, s.v * mirror, -s.omega)
    other = Motion(motion.assembly, motion.model, motion.boundary, image)
    one, two = motion.measure(), other.measure()
    largest = abs(one.self_torque).max()
    assert largest > 0
    np.testing.assert_allclose(two.self_torque, -one.self_torque, atol=1e-13 * largest)
    assert two.compression == pytest.approx(one.compression, rel=1e-13)


def test_rigid_motion_costs_the_torque_of_its_rotation_only():
    """Moved without rotation nothing slides; turned at Omega every edge in contact is dragged to Omega . d3.

    r x (Omega x r) = R^2 Omega - (r . Omega) r, so a torque remains: the drag is not objective
    (docs/architecture.md).
    """
    a, state, h = tangle(1)
    motion = Motion(a, toy_model(h), ends.free(a), state)
    motion.state.v[:] = (1.0, 2.0, 3.0)
    assert abs(motion.measure().self_torque).max() < 1e-12
    motion.state.v[:] = np.cross((0.0, 0.0, 1.0), state.x)
    assert abs(motion.measure().self_torque).max() > 1e-3
