"""Shadows of fibers against the closed form for a long straight one."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.view.shading import Pieces, lit, occlusion

UP = np.array([0.0, 0.0, 1.0])


def rod(n=400, step=0.1):
    x = np.zeros((n, 3))
    x[:, 0] = step * (np.arange(n) - 0.5 * (n - 1))
    return Pieces(x, np.tile([1.0, 0.0, 0.0], (n, 1)), np.full(n, step))


@pytest.mark.parametrize("d", [1.5, 2.0, 3.0])
@pytest.mark.parametrize("theta", [0.0, 0.8])
def test_hidden_sky_is_the_view_factor_of_a_cylinder(d, theta):
    """A long cylinder of radius h at distance d hides h cos(theta) / d of the sky (saturated: 1.6)."""
    normal = np.array([[0.0, np.sin(theta), np.cos(theta)]])
    sky, _ = occlusion(np.array([[0.0, 0.0, -d]]), normal, rod(), 1.0, UP)
    assert -np.log(1.0 - sky[0]) / 1.6 == pytest.approx(np.cos(theta) / d, rel=0.03)


def test_a_straight_fiber_casts_no_shadow_on_itself():
    phi = np.linspace(0, 2 * np.pi, 16)
    normals = np.stack([0 * phi, np.cos(phi), np.sin(phi)], axis=1)
    sky, shade = occlusion(normals, normals, rod(), 1.0, UP)
    assert sky == pytest.approx(0.0, abs=1e-6)
    assert shade == pytest.approx(0.0, abs=1e-6)


def test_the_lamp_is_hidden_under_the_fiber_and_seen_from_beside_it():
    y = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 4.0])
    x = np.stack([0 * y, y, 0 * y - 2.0], axis=1)
    _, shade = occlusion(x, np.tile(UP, (6, 1)), rod(), 1.0, UP)
    assert shade[0] == pytest.approx(1.0)
    assert shade[-1] == pytest.approx(0.0)
    assert np.all(np.diff(shade) <= 1e-6)


def test_the_answer_does_not_depend_on_how_vertices_are_ordered():
    rng = np.random.default_rng(0)
    x, order = rng.normal(size=(3000, 3)) * 3.0, rng.permutation(3000)
    n = x / np.linalg.norm(x, axis=1, keepdims=True)
    first, again = occlusion(x, n, rod(), 1.0, UP), occlusion(x[order], n[order], rod(), 1.0, UP)
    assert again[0] == pytest.approx(first[0][order], abs=1e-5)
    assert again[1] == pytest.approx(first[1][order], abs=1e-5)


def test_light_keeps_the_hue_and_shadow_takes_light():
    rgb = np.tile([0.9, 0.3, 0.1], (3, 1))
    n = np.tile(UP, (3, 1))
    sky, shade = np.array([0.0, 0.5, 0.95]), np.array([0.0, 1.0, 1.0])
    colour = lit(rgb, n, n, np.eye(3), sky, shade)
    assert np.all(np.diff(colour.sum(axis=1)) < -0.1)
    assert np.all((colour[:, 0] > colour[:, 1]) & (colour[:, 1] > colour[:, 2]))
    assert colour.min() >= 0.0
    assert colour.max() <= 1.0
