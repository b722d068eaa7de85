"""The tube mesh: closed, outward, of the right volume, without a seam."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.view.tube import minimal_frame, smooth_centerline, tube

H = 0.2e-3


def straight(n=4):
    return np.stack([np.linspace(0.0, 8e-3, n), np.zeros(n), np.zeros(n)], axis=1)


def helix(n=100):
    t = np.linspace(0.0, 6 * np.pi, n)
    return 1e-3 * np.stack([np.cos(t), np.sin(t), 0.25 * t], axis=1)


def ring(n=60):
    t = 2 * np.pi * np.arange(n) / n
    return 1e-3 * np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)


def trefoil(n=100):
    t = 2 * np.pi * np.arange(n) / n
    x = [np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)]
    return 0.7e-3 * np.stack(x, axis=1)


SHAPES = {
    "straight": (straight(), False),
    "two nodes": (straight(2), False),
    "helix": (helix(), False),
    "uneven": (helix(400)[np.sort(np.random.default_rng(4).choice(400, 90, replace=False))], False),
    "ring": (ring(), True),
    "trefoil": (trefoil(), True),
    "open trefoil": (trefoil(), False),
}


@pytest.fixture(params=SHAPES, name="shape")
def _shape(request):
    return SHAPES[request.param]


def length(x, closed):
    fine = smooth_centerline(x, closed, 0.02 * H).x
    steps = np.diff(fine, axis=0, append=fine[:1] if closed else fine[-1:])
    return np.linalg.norm(steps, axis=1).sum()


def test_every_edge_belongs_to_two_faces_that_run_along_it_in_opposite_ways(shape):
    faces = tube(shape[0], H, shape[1]).faces
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    directed = {tuple(e) for e in edges.tolist()}
    assert len(directed) == len(edges)
    assert all((b, a) in directed for a, b in directed)


def test_it_is_a_sphere_if_open_and_a_torus_if_closed(shape):
    mesh = tube(shape[0], H, shape[1])
    edges = len(mesh.faces) * 3 // 2
    assert len(mesh.vertices) - edges + len(mesh.faces) == (0 if shape[1] else 2)


@pytest.mark.parametrize("rounding", [1.0, 0.3])
def test_volume_is_that_of_a_tube_with_its_caps(shape, rounding):
    x, closed = shape
    r, e = H * (1 - rounding), H * rounding
    cap = np.pi * (r * r * e + 0.5 * np.pi * r * e * e + 2 / 3 * e**3)
    expected = np.pi * H * H * length(x, closed) + (0 if closed else 2 * cap)
    assert tube(x, H, closed, rounding=rounding).volume() == pytest.approx(expected, rel=0.01)


def test_a_rounding_of_one_adds_one_ball():
    assert tube(straight(), H, sides=96).volume() == pytest.approx(
        np.pi * H * H * 8e-3 + 4 / 3 * np.pi * H**3, rel=2e-3
    )


def test_normals_are_unit_and_agree_with_the_faces(shape):
    mesh = tube(shape[0], H, shape[1])
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-12)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    outward = np.cross(b - a, c - a)
    area = np.linalg.norm(outward, axis=1)
    assert area.min() > 0
    mean = mesh.normals[mesh.faces].mean(axis=1)
    assert np.sum(outward * mean, axis=1).min() > 0.9 * area.min()


def test_vertices_lie_at_the_radius_from_the_centerline():
    x, closed = SHAPES["trefoil"]
    mesh = tube(x, H, closed)
    centre = smooth_centerline(x, closed, 0.25 * H).x
    rings = mesh.vertices.reshape(len(centre), 32, 3)
    assert np.linalg.norm(rings - centre[:, None], axis=2) == pytest.approx(H, rel=1e-12)


@pytest.mark.parametrize("name", ["ring", "trefoil"])
def test_a_closed_tube_turns_no_more_at_its_seam_than_anywhere_else(name):
    curve = smooth_centerline(SHAPES[name][0], True, 0.25 * H)
    u, v = minimal_frame(curve, closed=True)
    assert np.sum(u * curve.t, axis=1) == pytest.approx(0.0, abs=1e-12)
    step = u - np.sum(u * np.roll(curve.t, -1, axis=0), axis=1, keepdims=True) * np.roll(curve.t, -1, axis=0)
    after_u, after_v = np.roll(u, -1, axis=0), np.roll(v, -1, axis=0)
    turn = np.arctan2(np.sum(step * after_v, axis=1), np.sum(step * after_u, axis=1))
    assert abs(turn[-1]) < 1.5 * np.abs(turn[:-1]).max() + 1e-4
    assert np.abs(turn).max() < 0.05


def test_an_open_frame_does_not_turn_about_its_tangent():
    curve = smooth_centerline(helix(), False, 0.1 * H)
    u, _ = minimal_frame(curve, closed=False)
    spin = np.sum(np.diff(u, axis=0) * np.cross(curve.t, u)[:-1], axis=1)
    assert np.abs(spin.sum()) < 1e-3 * length(helix(), False) / H


def test_the_curve_goes_through_its_nodes_and_has_no_corners(shape):
    x, closed = shape
    curve = smooth_centerline(x, closed, 0.25 * H)
    at_nodes = curve.x[curve.node == np.floor(curve.node)]
    assert at_nodes == pytest.approx(x, abs=1e-15)
    cosine = np.sum(curve.t * np.roll(curve.t, -1, axis=0), axis=1)
    assert (cosine if closed else cosine[:-1]).min() > np.cos(0.2)


def test_a_ring_of_few_nodes_is_round():
    curve = smooth_centerline(ring(16), True, 0.05 * H)
    assert np.linalg.norm(curve.x, axis=1) == pytest.approx(1e-3, rel=2e-3)


def test_node_values_are_met_at_nodes_and_linear_between_also_across_the_seam():
    x = ring(12)
    mesh = tube(x, H, True, sides=8)
    values = np.arange(12.0)
    got = mesh.at_vertices(values)
    inside = mesh.node <= 11
    assert got[inside] == pytest.approx(mesh.node[inside])
    assert got[~inside] == pytest.approx(11.0 * (12.0 - mesh.node[~inside]))
    assert mesh.at_vertices(np.stack([values, -values], axis=1))[:, 1] == pytest.approx(-got)


def test_an_open_tube_keeps_its_end_values_on_its_caps():
    mesh = tube(straight(5), H)
    got = mesh.at_vertices([3.0, 1.0, 1.0, 1.0, 7.0])
    x = mesh.vertices[:, 0]
    assert got[x <= 0] == pytest.approx(3.0)
    assert got[x >= 8e-3] == pytest.approx(7.0)


def test_the_same_nodes_make_the_same_mesh_bit_for_bit():
    first, second = tube(trefoil(), H, True), tube(trefoil(), H, True)
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


@pytest.mark.parametrize(
    ("x", "closed", "words"),
    [
        (np.zeros((1, 3)), False, "at least 2"),
        (straight(2), True, "at least 3"),
        (np.full((5, 3), np.nan), False, "finite"),
        (np.zeros((4, 3)), False, "at one place"),
        (np.concatenate([ring(), ring()[:1]]), True, "at one place"),
    ],
)
def test_bad_nodes_are_refused_with_a_reason(x, closed, words):
    with pytest.raises(TorsadeError, match=words):
        tube(x, H, closed)


@pytest.mark.parametrize("options", [{"radius": 0.0}, {"sides": 2}, {"rounding": 0.0}, {"spacing": 0.0}])
def test_bad_options_are_refused(options):
    with pytest.raises(TorsadeError, match="tube was asked"):
        tube(straight(), **{"radius": H, **options})
