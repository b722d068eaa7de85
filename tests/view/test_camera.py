"""The camera finds the knot, the side that shows it, and frames it."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.view.camera import best_side, frame, knot_body, level_right
from torsade.view.tube import smooth_centerline


def curves(*strands, closed=False):
    return [smooth_centerline(np.asarray(x, float), closed, 0.5) for x in strands]


def line(*corners, n=60):
    corners = np.array(corners, dtype=float)
    t = np.linspace(0, len(corners) - 1, n)
    return np.stack([np.interp(t, np.arange(len(corners)), corners[:, k]) for k in range(3)], axis=1)


def overhand(scale=4.0, lead=40.0, n=200):
    """An open trefoil with long leads along x, in radii."""
    t = np.linspace(-1.9, 1.9, n)
    x = scale * (t**3 - 3 * t)
    y = scale * 0.35 * (t**4 - 4 * t**2)
    z = scale * 0.06 * (t**5 - 10 * t)
    core = np.stack([-x, y, z], axis=1)
    first, last = core[0], core[-1]
    away = np.array([lead, 0.0, 0.0])
    ends = [first + np.sign(first[0]) * away, last + np.sign(last[0]) * away]
    return np.concatenate([line(ends[0], first)[:-1], core, line(last, ends[1])[1:]])


def test_the_body_is_where_strands_touch():
    a, b = line([-50, 0, 0], [50, 0, 0], n=200), line([0, -50, 2], [0, 50, 2], n=200)
    body = knot_body(curves(a, b), [False, False], 1.0)
    assert all(0 < len(part) < 8 for part in body)
    assert np.abs(np.concatenate(body)).max() < 3.0


def test_a_loose_knot_is_found_with_a_longer_reach():
    a, b = line([-50, 0, 0], [50, 0, 0], n=200), line([0, -50, 7], [0, 50, 7], n=200)
    body = knot_body(curves(a, b), [False, False], 1.0)[0]
    assert 5.0 < np.ptp(body[:, 0]) < 20.0


def test_strands_that_are_far_apart_are_all_body():
    a, b = line([-50, 0, 0], [50, 0, 0]), line([-50, 30, 0], [50, 30, 0])
    sampled = curves(a, b)
    body = knot_body(sampled, [False, False], 1.0)
    assert [len(x) for x in body] == [len(c.x) for c in sampled]


def test_a_tight_hairpin_of_one_strand_is_no_contact():
    t = np.linspace(0, np.pi, 30)
    sampled = curves(1.1 * np.stack([np.sin(t), np.cos(t), 0 * t], axis=1))
    assert np.array_equal(knot_body(sampled, [False], 1.0)[0], sampled[0].x)


def test_the_seam_of_a_ring_is_no_contact():
    t = 2 * np.pi * np.arange(90) / 90
    sampled = curves(12 * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1), closed=True)
    body = knot_body(sampled, [True], 1.0)
    assert np.array_equal(body[0], sampled[0].x)


def test_leads_are_not_part_of_the_body():
    x = overhand()
    sampled = curves(x)
    body = knot_body(sampled, [False], 1.0)[0]
    assert 10 < np.ptp(body[:, 0]) < 0.5 * np.ptp(x[:, 0])


@pytest.mark.parametrize("turn", [0.0, 0.5, 1.0, 2.5, -1.2])
def test_the_side_turns_with_the_knot_about_the_line_of_pulling(turn):
    """A nearly flat knot is looked at from a direction across its plane, wherever that plane is."""
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    sampled = curves(overhand() @ rotation.T)
    body = np.concatenate(knot_body(sampled, [False], 1.0))
    right, toward = best_side([q.x for q in sampled], body, 1.0, level=True)
    assert right == pytest.approx([1, 0, 0])
    assert abs(toward @ rotation[:, 2]) > np.cos(np.radians(31.0))


def test_a_closed_curve_is_seen_flat_with_its_longest_axis_level():
    t = 2 * np.pi * np.arange(80) / 80
    normal = np.array([0.3, 0.8, -0.52]) / np.linalg.norm([0.3, 0.8, -0.52])
    u = np.cross(normal, [0, 0, 1])
    u /= np.linalg.norm(u)
    x = np.outer(20 * np.cos(t), u) + np.outer(9 * np.sin(t), np.cross(normal, u))
    sampled = curves(x, closed=True)
    right, toward = best_side([sampled[0].x], sampled[0].x, 1.0, level=False)
    assert abs(toward @ normal) > 0.95
    assert abs(right @ u) > 0.95
    assert right @ toward == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("size", [(1600, 1200), (640, 1280)])
@pytest.mark.parametrize("toward", [[0, 0, 1], [0, 1, 0], [1, 0, 0], [0.3, -0.5, 0.8]])
def test_the_body_fills_the_frame_to_the_asked_fraction(size, toward):
    toward = np.array(toward) / np.linalg.norm(toward)
    body = np.random.default_rng(1).normal(size=(300, 3)) * [9.0, 5.0, 2.0] + 100.0
    view = frame(body, 1.0, size, level_right(toward), toward, 0.7)
    pixels = view.pixels(body)
    radius = 0.5 * size[1] / view.half_height
    span = np.ptp(pixels, axis=0) + 2 * radius
    assert (span / size).max() == pytest.approx(0.7, rel=0.01)
    assert pixels.min(axis=0) + pixels.max(axis=0) == pytest.approx(size, abs=4)


def test_x_stays_level_unless_looked_along():
    assert level_right(np.array([0.0, 0.6, 0.8])) == pytest.approx([1, 0, 0])
    assert level_right(np.array([1.0, 0.0, 0.0])) == pytest.approx([0, 1, 0])
