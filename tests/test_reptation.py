"""Motions made up of a rotation and slides are found again."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.reptation import body_nodes, fit, node_tangents

V = np.array([0.3, -0.2, 0.5])
OMEGA = np.array([2.0, -1.0, 0.7])


def curves():
    """Two curved strands, unevenly spaced."""
    a, b = np.linspace(0, 3, 80) ** 1.2, np.linspace(-1, 2, 61)
    return [
        np.stack([np.cos(a), np.sin(a), 0.3 * a**2], axis=1),
        np.stack([b, np.sin(2 * b), 0.5 + np.cos(b)], axis=1),
    ]


def moving(strands, centre, speeds, orientation):
    return [
        V + np.cross(OMEGA, x - centre) + s * sign * node_tangents(x)
        for x, s, sign in zip(strands, speeds, orientation, strict=True)
    ]


@pytest.mark.parametrize("orientation", [(1, 1), (1, -1), (-1, -1)])
def test_rigid_motion_and_slides_are_recovered(orientation):
    strands = curves()
    body = [(10, 70), (5, 50)]
    centre = fit(strands, strands, body, orientation).centre
    found = fit(strands, moving(strands, centre, (1.5, 0.4), orientation), body, orientation)
    np.testing.assert_allclose(found.velocity, V, rtol=1e-10)
    np.testing.assert_allclose(found.rotation, OMEGA, rtol=1e-10)
    np.testing.assert_allclose(found.speed, (1.5, 0.4), rtol=1e-10)
    assert found.explained == pytest.approx(1.0, abs=1e-12)
    assert found.alignment == pytest.approx(1.0, abs=1e-12)


def test_what_is_outside_of_the_body_does_not_count():
    strands = curves()
    body = [(10, 70), (5, 50)]
    centre = fit(strands, strands, body, (1, 1)).centre
    velocities = moving(strands, centre, (1.0, 1.0), (1, 1))
    velocities[0][:10] = 1e3
    velocities[1][50:] = -1e3
    np.testing.assert_allclose(fit(strands, velocities, body, (1, 1)).rotation, OMEGA, rtol=1e-10)


def test_the_other_orientation_turns_speeds_and_alignment_round():
    strands = curves()
    rng = np.random.default_rng(3)
    velocities = [u + rng.normal(size=u.shape) for u in moving(strands, 0, (2.0, 3.0), (1, 1))]
    body = [(0, 80), (0, 61)]
    one, other = (fit(strands, velocities, body, sign) for sign in ((1, 1), (-1, -1)))
    np.testing.assert_allclose(one.speed, -other.speed, rtol=1e-9)
    np.testing.assert_allclose(one.rotation, other.rotation, rtol=1e-9)
    assert one.alignment == pytest.approx(-other.alignment)
    assert 0 < one.explained < 1


def test_a_mirror_image_turns_the_other_way():
    """Reflected in z, the rotation about x and y changes sign, and that about z does not."""
    strands = curves()
    rng = np.random.default_rng(4)
    velocities = [rng.normal(size=x.shape) for x in strands]
    body = [(0, 80), (0, 61)]
    mirror = np.array([1, 1, -1])
    one = fit(strands, velocities, body, (1, 1))
    other = fit([x * mirror for x in strands], [u * mirror for u in velocities], body, (1, 1))
    np.testing.assert_allclose(other.rotation, -mirror * one.rotation, rtol=1e-9)
    np.testing.assert_allclose(other.speed, one.speed, rtol=1e-9)


def test_lengths_weigh_not_nodes():
    """Sampled more finely on one half, a motion that is no reptation gives about the same fit."""
    s = np.linspace(0, 4, 401)
    finer = np.concatenate([s[:200], np.linspace(s[200], 4, 801)])

    def of(s):
        x = np.stack([s, np.sin(2 * s), np.cos(s) + 0.1 * s**2], axis=1)
        return x, np.stack([np.sin(3 * s), s, np.cos(s)], axis=1)

    one, other = (fit([x], [u], [(0, len(x))], [1]) for x, u in (of(s), of(finer)))
    np.testing.assert_allclose(one.rotation, other.rotation, rtol=2e-3)


def test_the_body_reaches_from_the_first_to_the_last_edge_in_contact():
    torque = np.zeros(9)
    torque[[1, 3]] = -1.0
    torque[[6]] = 2.0
    assert body_nodes(torque, np.array([0, 5, 9])) == [(1, 5), (1, 3)]
    assert body_nodes(np.zeros(9), np.array([0, 5, 9])) is None


def test_straight_strands_give_finite_numbers():
    """Where a slide is a translation, the smallest of all motions that fit is taken."""
    x = np.linspace(0, 1, 11)[:, None] * (1.0, 0, 0)
    found = fit([x, x + np.array([0, 0.1, 0])], [x * 0 + (1.0, 0, 0)] * 2, [(0, 11)] * 2, (1, 1))
    assert np.isfinite(found.rotation).all()
    assert found.velocity[0] + found.speed[0] == pytest.approx(1.0)
