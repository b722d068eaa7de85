"""Inertial motion: energy, momentum, reversal, lengths, ends, and what is refused."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import torsade as ts
from torsade.assembly import assemble, initial_state
from torsade.material import Section, named_material
from torsade.motion import ends
from torsade.motion.grips import gripped
from torsade.motion.inertial import Inertial
from torsade.motion.moving import Outcome

SPAGHETTI = named_material("spaghetti")
UNDAMPED = dataclasses.replace(SPAGHETTI, twist_damping=0.0)
SECTION = Section(7e-4)


def bent(edges: int = 30, length: float = 0.24, twist: float = 2.0):
    """A free rod, bent more towards one end, out of its plane, and twisted."""
    s = (np.arange(edges) + 0.5) / edges
    turn, lift = 1.5 * s**2, 0.4 * np.sin(2 * s)
    t = np.stack([np.cos(turn) * np.cos(lift), np.sin(turn) * np.cos(lift), np.sin(lift)], axis=1)
    x = np.concatenate([np.zeros((1, 3)), np.cumsum(length / edges * t, axis=0)])
    a = assemble([x])
    state = initial_state(a, [x])
    state.theta[:] = twist * (s - np.sin(2 * np.pi * s) / (2 * np.pi))  # no twist at the free ends
    return a, state


def test_a_free_undamped_rod_keeps_energy_momentum_and_lengths_for_1e5_steps() -> None:
    """Energy goes up and down with the step as symplectic schemes do, and its trend is below 1e-4."""
    a, state = bent()
    motion = Inertial(a, UNDAMPED, SECTION, ends.free(a), state, 2e-6)
    first = motion.energies().total
    energy = []
    for k in range(100):
        assert motion.advance((k + 1) * 2e-3) is Outcome.REACHED
        energy.append(motion.energies().total / first - 1)
    assert motion.steps == 100_000
    assert abs(np.polyfit(np.linspace(0, 1, 100), energy, 1)[0]) < 1e-4
    assert np.abs(energy).max() < 1e-3
    lengths = np.linalg.norm(np.diff(motion.state.x, axis=0), axis=1)
    assert np.abs(lengths / a.rest_length - 1).max() < 1e-10
    momentum = motion.inertia.mass @ motion.state.v
    assert np.abs(momentum).max() < 1e-9 * motion.inertia.mass.sum() * np.abs(motion.state.v).max()
    assert motion.iterations < 4 * motion.steps


def test_energy_error_is_of_second_order_in_the_step() -> None:
    errors = []
    for dt in (4e-6, 2e-6, 1e-6):
        a, state = bent(edges=20)
        motion = Inertial(a, UNDAMPED, SECTION, ends.free(a), state, dt)
        first = motion.energies().total
        motion.advance(1e-3)
        errors.append(abs(motion.energies().total - first))
    rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(rates > 1.7), rates


def test_motion_runs_backwards() -> None:
    """With velocities reversed, the rod comes back to where it was: the scheme is time-reversible."""
    a, state = bent()
    motion = Inertial(a, UNDAMPED, SECTION, ends.free(a), state, 2e-6)
    motion.advance(4e-3)
    assert np.abs(motion.state.x - state.x).max() > 5e-3
    motion.state.v[:] *= -1
    motion.state.omega[:] *= -1
    motion.advance(8e-3)
    np.testing.assert_allclose(motion.state.x, state.x, atol=1e-9)
    np.testing.assert_allclose(motion.state.theta, state.theta, atol=1e-6)


def test_planar_motion_keeps_its_angular_momentum() -> None:
    """Impulses lie in the edges and elastic forces are central: none turns the rod as a whole."""
    a, state = bent(twist=0.0)
    state.x[:, 2] = 0.0
    x = state.x
    a = assemble([x])
    state = initial_state(a, [x])
    state.v[:, 1] = 3.0 * (x[:, 0] - x[:, 0].mean())
    motion = Inertial(a, UNDAMPED, SECTION, ends.free(a), state)
    motion.advance(0.0)

    def angular() -> float:
        now, mass = motion.state, motion.inertia.mass
        return float(mass @ (now.x[:, 0] * now.v[:, 1] - now.x[:, 1] * now.v[:, 0]))

    before = angular()
    motion.advance(5e-3)
    assert angular() == pytest.approx(before, rel=1e-9)
    assert np.abs(motion.state.x[:, 2]).max() == 0.0


def test_what_damping_takes_is_dissipated() -> None:
    a, state = bent()
    motion = Inertial(a, SPAGHETTI, SECTION, ends.free(a), state, 1e-6)
    first = motion.energies().total
    motion.advance(2e-3)
    assert motion.dissipation > 0.3 * first
    assert motion.energies().total + motion.dissipation == pytest.approx(first, rel=1e-3)


def test_a_rod_hangs_still_under_its_moments() -> None:
    """A circular arc whose ends are clamped is in equilibrium: it stays where it is, to the third order of
    the angles between its edges, in which the half hinges at grips differ from whole ones."""
    n, radius = 40, 0.1
    angle = (np.arange(n) + 0.5) / n * 1.2
    t = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    x = np.concatenate([np.zeros((1, 3)), np.cumsum(1.2 * radius / n * t, axis=0)])
    ends_of = (np.array([1.0, 0.0, 0.0]), np.array([np.cos(1.2), np.sin(1.2), 0.0]))
    a, state, boundary = gripped(x, ends_of)
    motion = Inertial(a, UNDAMPED, SECTION, boundary, state)
    motion.advance(2e-3)
    np.testing.assert_allclose(motion.state.x, state.x, atol=1e-7)


def test_ends_move_at_the_speed_given_and_hinges_turn() -> None:
    a, state = bent(twist=0.0)
    boundary = ends.move(ends.free(a), a, 0, 1, np.array([-0.5, 0.0, 0.0]))
    boundary = ends.clamp(boundary, a, 0, 0)
    motion = Inertial(a, SPAGHETTI, SECTION, boundary, state)
    motion.advance(2e-3)
    np.testing.assert_allclose(motion.state.x[-1], state.x[-1] - [1e-3, 0, 0], atol=1e-12)
    assert np.array_equal(motion.state.x[0], state.x[0])
    turned = motion.state.x[1] - motion.state.x[0]
    assert np.linalg.norm(turned / np.linalg.norm(turned) - [1, 0, 0]) > 1e-2


def test_ends_that_are_driven_too_far_apart_are_told_of() -> None:
    x = np.outer(np.linspace(0, 0.24, 21), [1.0, 0, 0])
    a = assemble([x])
    boundary = ends.clamp(ends.move(ends.free(a), a, 0, 1, np.array([0.1, 0.0, 0.0])), a, 0, 0)
    motion = Inertial(a, SPAGHETTI, SECTION, boundary, initial_state(a, [x]))
    with pytest.raises(ts.TorsadeError, match=r"cannot keep their lengths after t = .* drive held ends"):
        motion.advance(1e-3)


def test_runs_repeat_to_the_bit_from_what_was_saved() -> None:
    a, state = bent()
    whole = Inertial(a, SPAGHETTI, SECTION, ends.free(a), state)
    whole.advance(1e-3)
    saved = whole.saved()
    whole.advance(2e-3)
    resumed = Inertial(a, SPAGHETTI, SECTION, ends.free(a), state)
    resumed.recover(saved)
    resumed.advance(2e-3)
    for name, value in whole.saved().items():
        assert np.array_equal(value, resumed.saved()[name]), name


def test_unstable_steps_and_closed_fibers_are_refused() -> None:
    a, state = bent()
    with pytest.raises(ts.TorsadeError, match=r"a step of 1e-05 s is not stable with edges of 8 mm"):
        Inertial(a, SPAGHETTI, SECTION, ends.free(a), state, 1e-5)
    ring = np.stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6), np.zeros(12)], 1)
    closed = assemble([ring], [True])
    with pytest.raises(ts.TorsadeError, match=r"fiber 0 is closed, .* cut it open"):
        Inertial(closed, SPAGHETTI, SECTION, ends.free(closed), initial_state(closed, [ring]))
