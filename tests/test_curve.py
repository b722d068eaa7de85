"""Polylines against circles, helices, spherical curves and torus knots."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from torsade import curve
from torsade.errors import TorsadeError

FloatArray = NDArray[np.float64]


def circle(n: int, radius: float = 1.0) -> FloatArray:
    a = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def helix(n: int, turns: float = 2.0, pitch: float = 0.5) -> FloatArray:
    """Radius 1, height `pitch` per radian."""
    a = np.linspace(0, 2 * np.pi * turns, n)
    return np.stack([np.cos(a), np.sin(a), pitch * a], axis=1)


def torus_knot(p: int, q: int, n: int) -> FloatArray:
    """The curve of the reference writhes: R = 2, r = 1, p times round the axis."""
    a = 2 * np.pi * np.arange(n) / n
    rho = 2 + np.cos(q * a)
    return np.stack([rho * np.cos(p * a), rho * np.sin(p * a), np.sin(q * a)], axis=1)


def random_walk(seed: int, n: int) -> FloatArray:
    return np.cumsum(np.random.default_rng(seed).normal(size=(n, 3)), axis=0)


# --- edges, arclength, curvature


def test_edges_of_a_square() -> None:
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    np.testing.assert_array_equal(curve.edge_vectors(square), [[1, 0, 0], [0, 1, 0], [-1, 0, 0]])
    np.testing.assert_array_equal(curve.edge_vectors(square, closed=True)[-1], [0, -1, 0])
    np.testing.assert_array_equal(curve.arclength(square), [0, 1, 2, 3])
    np.testing.assert_array_equal(curve.arclength(square, closed=True), [0, 1, 2, 3])
    assert (curve.length(square), curve.length(square, closed=True)) == (3, 4)
    np.testing.assert_allclose(curve.turning_angles(square), [np.pi / 2] * 2)
    np.testing.assert_allclose(curve.curvature(square, closed=True), [2.0] * 4)


@pytest.mark.parametrize("n", [3, 4, 7, 100])
def test_curvature_of_a_regular_polygon(n: int) -> None:
    """2 tan(pi/n)/l is the inverse radius of the inscribed circle, R cos(pi/n)."""
    kappa = curve.curvature(circle(n, radius=2.0), closed=True)
    np.testing.assert_allclose(kappa, 1 / (2 * np.cos(np.pi / n)), rtol=1e-12)


def test_curvature_divides_by_the_mean_of_the_two_edges_at_the_node() -> None:
    """The 3-4-5 triangle: half angles of its turns, from the tangent of half a corner."""
    kappa = curve.curvature([[0, 0, 0], [4, 0, 0], [0, 3, 0]], closed=True)
    turn = np.pi - np.array([np.pi / 2, np.arctan2(3, 4), np.arctan2(4, 3)])
    np.testing.assert_allclose(kappa, 2 * np.tan(turn / 2) / [3.5, 4.5, 4.0], rtol=1e-12)


def test_curvature_of_a_helix_converges_at_second_order() -> None:
    """kappa = r/(r^2 + p^2) for radius r and height p per radian."""
    sizes = np.array([50, 100, 200, 400])
    errors = [np.abs(curve.curvature(helix(n)) - 1 / 1.25).max() for n in sizes]
    order = -np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert order == pytest.approx(2, abs=0.05)


def test_turning_angles_are_accurate_when_tiny_and_when_folded() -> None:
    for phi in (1e-9, 1e-3, 3.0, np.pi - 1e-9):
        bent = [[-1, 0, 0], [0, 0, 0], [np.cos(phi), np.sin(phi), 0]]
        assert curve.turning_angles(bent) == pytest.approx(phi, rel=1e-12)
    folded = [[0, 0, 0], [1, 0, 0], [0, 0, 0]]
    assert curve.curvature(folded) == np.inf


@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(3, 30), st.booleans())
def test_closed_polygons_turn_by_a_full_turn_at_least(seed: int, n: int, planar: bool) -> None:
    """Fenchel's theorem, with equality for convex plane curves."""
    total = curve.turning_angles(circle(n) if planar else random_walk(seed, n), closed=True).sum()
    assert total == pytest.approx(2 * np.pi) if planar else total >= 2 * np.pi - 1e-9


# --- frames


def test_perpendicular_is_unit_and_across() -> None:
    t = np.concatenate([np.random.default_rng(0).normal(size=(50, 3)), np.eye(3), -np.eye(3)])
    u = curve.perpendicular(t)
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), 1, rtol=1e-14)
    np.testing.assert_allclose((u * t).sum(axis=1), 0, atol=1e-14)
    np.testing.assert_array_equal(curve.perpendicular(t[7]), u[7])
    with pytest.raises(TorsadeError, match="zero vector"):
        curve.perpendicular([0.0, 0.0, 0.0])


@settings(deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_frames_are_orthonormal_and_do_not_turn_about_the_tangent(seed: int, closed: bool) -> None:
    """Parallel transport: u moves only in the plane of the two tangents, so t0 × t1 sees no change."""
    x = random_walk(seed, 12)
    t, u, v, holonomy = curve.rotation_minimising_frames(x, closed)
    frames = np.stack([u, v, t], axis=1)
    np.testing.assert_allclose(
        frames @ frames.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frames.shape), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(frames), 1, rtol=1e-12)
    axis = np.cross(t[:-1], t[1:])
    np.testing.assert_allclose((axis * u[:-1]).sum(axis=1), (axis * u[1:]).sum(axis=1), atol=1e-12)
    forward = np.cross(axis, t[:-1]), np.cross(axis, t[1:])
    np.testing.assert_allclose(
        (forward[0] * u[:-1]).sum(axis=1), (forward[1] * u[1:]).sum(axis=1), atol=1e-12
    )
    assert -np.pi < holonomy <= np.pi
    assert closed or holonomy == 0


def test_frame_starts_along_the_given_direction() -> None:
    x = helix(40)
    t0 = curve.tangents(x)[0]
    frames = curve.rotation_minimising_frames(x, u0=[0.3, 2.0, 0.1] + 5 * t0)
    wanted = np.array([0.3, 2.0, 0.1])
    wanted -= (wanted @ t0) * t0
    np.testing.assert_allclose(frames.u[0], wanted / np.linalg.norm(wanted), atol=1e-14)
    with pytest.raises(TorsadeError, match="along the first edge"):
        curve.rotation_minimising_frames(x, u0=-3 * t0)


def test_straight_fiber_keeps_its_frame() -> None:
    x = np.outer(np.arange(5.0), [1.0, 2.0, 3.0])
    frames = curve.rotation_minimising_frames(x)
    np.testing.assert_allclose(frames.u, np.broadcast_to(frames.u[0], (4, 3)), atol=1e-15)


def test_helix_normal_turns_at_the_torsion() -> None:
    """The principal normal of a helix turns about the tangent, against a frame at rest, by tau s."""
    a = np.linspace(0, 4 * np.pi, 2001)
    t, u, v, _ = curve.rotation_minimising_frames(helix(2001))
    middle = (a[:-1] + a[1:]) / 2
    normal = -np.stack([np.cos(middle), np.sin(middle), 0 * middle], axis=1)
    angle = np.unwrap(np.arctan2((normal * v).sum(axis=1), (normal * u).sum(axis=1)))
    s = middle * np.sqrt(1.25)
    tau = np.polyfit(s, angle, 1)[0]
    assert tau == pytest.approx(0.5 / 1.25, rel=1e-5)
    assert (t[:, 2] > 0).all()


def test_radius_vector_of_a_spherical_curve_does_not_turn() -> None:
    """On a sphere the outward normal is itself a rotation-minimising field; error of second order."""
    worst = []
    sizes = np.array([200, 400, 800])
    for n in sizes:
        a = np.linspace(0, 2 * np.pi, n)
        polar = 1 + 0.4 * np.sin(3 * a)
        x = np.stack([np.sin(polar) * np.cos(a), np.sin(polar) * np.sin(a), np.cos(polar)], axis=1)
        outward = (x[:-1] + x[1:]) / np.linalg.norm(x[:-1] + x[1:], axis=1)[:, None]
        u = curve.rotation_minimising_frames(x, u0=outward[0]).u
        worst.append(np.linalg.norm(u - outward, axis=1).max())
    assert worst[-1] < 1e-4
    assert -np.polyfit(np.log(sizes), np.log(worst), 1)[0] == pytest.approx(2, abs=0.1)


def test_plane_curves_have_no_holonomy() -> None:
    assert curve.rotation_minimising_frames(circle(17), closed=True).holonomy == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("p", "q", "writhe"), [(2, 3, -3.517860454451856), (3, 2, -3.900751301123718), (2, 5, -6.866184314931565)]
)
def test_holonomy_of_torus_knots_is_their_writhe(p: int, q: int, writhe: float) -> None:
    """Fuller: frames come back turned by 2 pi Wr; writhes of 400-gons from the reference tables."""
    turned = curve.rotation_minimising_frames(torus_knot(p, q, 400), closed=True).holonomy
    assert np.exp(1j * turned) == pytest.approx(np.exp(2j * np.pi * writhe), abs=1e-9)


def writhe_of(x: FloatArray) -> float:
    """Sum of the signed spherical quadrangles seen from one edge along another (Banchoff)."""
    y, total = np.roll(x, -1, axis=0), 0.0
    for i, j in combinations(range(len(x)), 2):
        if j - i in (1, len(x) - 1):
            continue
        r = [x[j] - x[i], y[j] - x[i], y[j] - y[i], x[j] - y[i]]
        n = [np.cross(r[k], r[(k + 1) % 4]) for k in range(4)]
        n = [k / np.linalg.norm(k) for k in n]
        area = sum(np.arcsin(np.clip(n[k] @ n[(k + 1) % 4], -1, 1)) for k in range(4))
        total += area * np.sign(np.cross(y[j] - x[j], y[i] - x[i]) @ r[0])
    return float(total / (2 * np.pi))


@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(4, 9))
def test_holonomy_of_any_polygon_is_its_writhe(seed: int, n: int) -> None:
    """Lk = Tw + Wr is exact for polygons, so that the angle is 2 pi Wr to round-off."""
    x = random_walk(seed, n)
    turned = curve.rotation_minimising_frames(x, closed=True).holonomy
    assert np.exp(1j * turned) == pytest.approx(np.exp(2j * np.pi * writhe_of(x)), abs=1e-6)


def test_frames_refuse_a_fold() -> None:
    with pytest.raises(TorsadeError, match="folds straight back after edge 1"):
        curve.rotation_minimising_frames([[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, 0]])


# --- resampling and smoothing


@pytest.mark.parametrize("method", ["linear", "cubic"])
@settings(deadline=None)
@given(seed=st.integers(0, 10**6), m=st.integers(3, 20), n=st.integers(3, 60), closed=st.booleans())
def test_resampling_keeps_ends_and_count(
    method: curve.Method, seed: int, m: int, n: int, closed: bool
) -> None:
    x = random_walk(seed, m) * 1e-4
    y = curve.resample(x, n=n, closed=closed, method=method)
    assert y.shape == (n, 3)
    np.testing.assert_array_equal(y[0], x[0])
    if not closed:
        np.testing.assert_array_equal(y[-1], x[-1])


def test_linear_resampling_stays_on_the_polyline_evenly() -> None:
    corner = np.array([[0.0, 0, 0], [3, 0, 0], [3, 4, 0]])
    y = curve.resample(corner, spacing=1.0, method="linear")
    np.testing.assert_allclose(y[:4], [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], atol=1e-15)
    np.testing.assert_allclose(y[4:], [[3, 1, 0], [3, 2, 0], [3, 3, 0], [3, 4, 0]], atol=1e-15)
    ring = curve.resample(corner, spacing=1.0, method="linear", closed=True)
    np.testing.assert_allclose(curve.edge_lengths(ring, closed=True), 1, rtol=1e-14)


def test_cubic_resampling_is_even_in_arclength() -> None:
    """From uneven nodes of a circle, all chords come out equal and the nodes lie on the circle."""
    a = 2 * np.pi * np.arange(400) / 400
    a += 0.7 * np.sin(a)
    y = curve.resample(np.stack([np.cos(a), np.sin(a), 0 * a], axis=1), n=64, closed=True)
    np.testing.assert_allclose(np.linalg.norm(y, axis=1), 1, atol=1e-8)
    np.testing.assert_allclose(curve.edge_lengths(y, closed=True), 2 * np.sin(np.pi / 64), rtol=1e-7)


@pytest.mark.parametrize("closed", [False, True])
def test_cubic_resampling_is_even_between_few_uneven_nodes(closed: bool) -> None:
    """The speed of the spline varies within a piece; chords differ only by (spacing * kappa)^2/24."""
    y = curve.resample(random_walk(4, 8), n=20_000, closed=closed)
    l = curve.edge_lengths(y, closed)
    deficit = (curve.curvature(y, closed).max() * l.mean()) ** 2 / 24
    assert deficit < 1e-4
    np.testing.assert_allclose(l, l.mean(), rtol=1.05 * deficit)


def test_cubic_resampling_knows_no_seam() -> None:
    """From a regular polygon come nodes of the same symmetry, on both sides of node 0 as elsewhere."""
    radii = np.linalg.norm(curve.resample(circle(12), n=120, closed=True), axis=1).reshape(12, 10)
    np.testing.assert_allclose(radii, np.broadcast_to(radii[5], (12, 10)), atol=1e-12)
    assert radii[5].max() - radii[5].min() > 1e-6  # the spline is not the circle itself


def test_cubic_resampling_converges_at_fourth_order() -> None:
    """Open helix: distance of new nodes from the helix of radius 1, away from the given nodes."""
    sizes = np.array([25, 50, 100, 200])
    errors = [np.abs(np.hypot(*curve.resample(helix(n), n=1237)[:, :2].T) - 1).max() for n in sizes]
    order = -np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert 3.7 < order < 4.3


@settings(deadline=None)
@given(seed=st.integers(0, 10**6), spacing=st.floats(0.01, 100), closed=st.booleans())
def test_spacing_is_the_longest_edge_and_nodes_are_fewest(seed: int, spacing: float, closed: bool) -> None:
    x = random_walk(seed, 6)
    y = curve.resample(x, spacing=spacing, closed=closed, method="linear")
    edges = len(y) - (0 if closed else 1)
    assert curve.edge_lengths(y, closed).max() <= spacing * (1 + 1e-8) or closed
    assert edges == (3 if closed else 1) or (edges - 1) * spacing < curve.length(x, closed)


def test_resampling_twice_changes_nothing() -> None:
    once = curve.resample(circle(30), n=80, closed=True)
    spacing = curve.length(once, closed=True) / 80
    np.testing.assert_allclose(curve.resample(once, spacing=spacing * 1.001, closed=True), once, atol=1e-6)
    line = np.outer(np.linspace(0, 1, 11), [1.0, 2.0, 2.0])
    np.testing.assert_allclose(curve.resample(line, spacing=0.3), line, atol=1e-15)
    np.testing.assert_allclose(curve.resample(line[[0, -1]], n=11), line, atol=1e-15)


@pytest.mark.parametrize("scale", [0.1, 0.5, 2.0])
def test_smoothing_shrinks_a_circle_as_stated(scale: float) -> None:
    """A wave of wave number k is divided by 1 + (k scale)^4, k^2 = (2 - 2 cos(2 pi/n))/l^2."""
    n, radius = 60, 1.5
    l = 2 * radius * np.sin(np.pi / n)
    k = np.sqrt(2 - 2 * np.cos(2 * np.pi / n)) / l
    assert k == pytest.approx(1 / radius)
    smoothed = curve.smooth(circle(n, radius), scale, closed=True)
    np.testing.assert_allclose(smoothed, circle(n, radius) / (1 + (k * scale) ** 4), atol=1e-10)


@pytest.mark.parametrize("waves", [1, 5, 20])
def test_smoothing_an_open_fiber_damps_each_wave_by_its_number(waves: int) -> None:
    n, scale, amplitude = 201, 0.02, 1e-7
    s = np.linspace(0, 1, n)
    ripple = np.sin(waves * np.pi * s)
    x = np.stack([s, amplitude * ripple, 0 * s], axis=1)
    k2 = (2 - 2 * np.cos(waves * np.pi / (n - 1))) * (n - 1) ** 2
    y = curve.smooth(x, scale)
    np.testing.assert_allclose(y[:, 1], amplitude * ripple / (1 + k2**2 * scale**4), atol=1e-6 * amplitude)


@settings(deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 20), st.floats(0, 10))
def test_smoothing_keeps_ends_and_straight_lines(seed: int, n: int, scale: float) -> None:
    x = random_walk(seed, n)
    y = curve.smooth(x, scale)
    np.testing.assert_array_equal(y[[0, -1]], x[[0, -1]])
    line = np.outer(np.sort(np.random.default_rng(seed).uniform(size=n)), [1.0, -2.0, 3.0])
    np.testing.assert_allclose(curve.smooth(line, scale), line, atol=1e-6)


def test_smoothing_along_a_length_that_is_known() -> None:
    """Edge lengths of its own give the same; twice as long edges bend over half the scale."""
    x, l = circle(60), curve.edge_lengths(circle(60), closed=True)
    np.testing.assert_array_equal(curve.smooth(x, 0.3, True, l), curve.smooth(x, 0.3, True))
    np.testing.assert_allclose(curve.smooth(x, 0.3, True, 2 * l), curve.smooth(x, 0.15, True), atol=1e-12)


def test_smoothing_removes_noise_and_leaves_the_shape() -> None:
    noise = 1e-2 * np.random.default_rng(2).normal(size=(400, 3))
    left = np.abs(curve.smooth(circle(400) + noise, 0.1, closed=True) - circle(400)).std()
    assert left < 0.3 * noise.std()


# --- refusals


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: curve.edge_vectors([[0, 0, 0]]), r"shape \(1, 3\); give \(n, 3\) with n of at least 2"),
        (lambda: curve.edge_vectors([[0, 0], [1, 1]]), r"shape \(2, 2\)"),
        (lambda: curve.length([[0, 0, 0], [1, 1, 1]], closed=True), "closed curve .* at least 3"),
        (lambda: curve.tangents([[0, 0, 0], [1, 0, 0], [1, 0, 0]]), "edge 1 has no length"),
        (lambda: curve.smooth(circle(9), 0.1, True, [1.0] * 8), r"9 edges have lengths of shape \(8,\)"),
        (lambda: curve.resample(circle(9)), "n or their spacing"),
        (lambda: curve.resample(circle(9), n=3, spacing=1.0), "n or their spacing"),
        (lambda: curve.resample(circle(9), n=1), "cannot have 0 edges"),
        (lambda: curve.resample(circle(9), n=2, closed=True), "closed curve cannot have 2 edges"),
        (lambda: curve.resample(circle(9), spacing=0.0), "spacing of nodes cannot be 0.0"),
        (lambda: curve.resample(circle(9), spacing=1e-12), "an open curve cannot have"),
        (lambda: curve.resample([[0, 0, 0], [0, 0, 0], [1, 0, 0]], n=5), "edge 0 has no length"),
        (lambda: curve.smooth(circle(9), -1.0), "smoothing length cannot be -1.0"),
        (lambda: curve.smooth(circle(9), np.nan), "smoothing length cannot be nan"),
        (lambda: curve.clearance([circle(9)], [True], -1.0), "exclusion cannot be -1.0"),
        (lambda: curve.clearance([circle(9)], [True], np.nan), "exclusion cannot be nan"),
        (lambda: curve.clearance([], [], 1.0), "no strand"),
    ],
)
def test_refusals_say_what_to_do(call: Any, says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        call()
