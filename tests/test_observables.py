"""What is measured: closed forms on straight, bent and twisted fibers, and histories made by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from torsade import observables
from torsade.assembly import Assembly, State, assemble, initial_state

H = 2e-4


def fibers(*strands: NDArray[np.float64], closed: bool = False) -> tuple[Assembly, State]:
    assembly = assemble(strands, [closed] * len(strands))
    return assembly, initial_state(assembly, strands)


def line(n: int, y: float = 0.0) -> NDArray[np.float64]:
    return np.outer(np.arange(n) * H, [1.0, 0.0, 0.0]) + np.array([0.0, y, 0.0])


def ring(n: int, radius: float) -> NDArray[np.float64]:
    a = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def test_a_stretched_line_has_the_strain_of_its_stretch() -> None:
    assembly, state = fibers(line(12))
    stretched = state._replace(x=1.07 * state.x)
    np.testing.assert_allclose(observables.log_strain(assembly, stretched, H), math.log(1.07), rtol=1e-12)
    assert observables.fiber_lengths(assembly, stretched) == pytest.approx([1.07 * 11 * H])


def test_a_compressed_line_counts_as_strained() -> None:
    assembly, state = fibers(line(12))
    short = state._replace(x=0.9 * state.x)
    np.testing.assert_allclose(observables.log_strain(assembly, short, H), math.log(1.1), rtol=1e-12)


def test_curvature_of_a_ring_is_per_present_length() -> None:
    n, radius = 60, 10 * H
    assembly, state = fibers(ring(n, radius), closed=True)
    # The polygon turns by 2 pi/n over an edge 2 R sin(pi/n): kappa = 2 tan(pi/n)/l = 1/(R cos(pi/n)).
    expected = 0.1 / math.cos(math.pi / n)
    np.testing.assert_allclose(observables.h_kappa(assembly, state, H), expected, rtol=1e-12)
    wider = state._replace(x=2 * state.x)
    np.testing.assert_allclose(observables.h_kappa(assembly, wider, H), expected / 2, rtol=1e-12)


def test_twist_is_summed_by_fiber_and_strains() -> None:
    assembly, state = fibers(line(9), line(5, 1e-3))
    theta = np.concatenate([0.1 * np.arange(8), -0.2 * np.arange(4)])
    twisted = state._replace(theta=theta)
    np.testing.assert_allclose(observables.twist(assembly, twisted), [0.7, -0.6], rtol=1e-12)
    strain = observables.log_strain(assembly, twisted, H)
    inner = np.zeros(14)
    inner[1:8], inner[10:13] = 0.1, 0.2  # h theta' with edges of length h; nothing at the ends
    np.testing.assert_allclose(strain, np.log1p(inner / math.sqrt(2)), rtol=1e-12, atol=1e-15)


def test_parts_of_the_strain_of_a_twisted_stretched_helix() -> None:
    """Radius r, pitch 2 pi p: kappa = r/(r² + p²); stretch λ multiplies lengths and divides the curvature."""
    r, p, stretch, turn = 10 * H, 4 * H, 1.05, 0.03
    a = np.linspace(0, 6 * math.pi, 2001)
    helix = np.stack([r * np.cos(a), r * np.sin(a), p * a], axis=1)
    assembly, state = fibers(helix)
    pulled = state._replace(x=stretch * state.x, theta=-turn * np.arange(len(a) - 1))
    found = observables.surface_strain(assembly, pulled, H)
    l = assembly.rest_length[0]
    inner = slice(1, -1)
    np.testing.assert_allclose(found.stretch, stretch - 1, rtol=1e-9)
    np.testing.assert_allclose(found.bend[inner], H * r / (r**2 + p**2) / stretch, rtol=1e-4)
    np.testing.assert_allclose(found.twist[inner], H * turn / l / math.sqrt(2), rtol=1e-9)
    expected = np.sqrt((H * turn / l) ** 2 / 2 + (H * r / (r**2 + p**2) / stretch + stretch - 1) ** 2)
    np.testing.assert_allclose(found.total[inner], expected, rtol=1e-3)
    np.testing.assert_allclose(observables.log_strain(assembly, pulled, H), np.log1p(found.total))


def test_ends_of_an_open_fiber_are_only_stretched() -> None:
    assembly, state = fibers(ring(60, 10 * H)[:30])
    found = observables.surface_strain(assembly, state._replace(theta=0.1 * np.arange(29)), H)
    for part in (found.bend, found.twist):
        assert (part[[0, -1]] == 0).all()
        assert (part[1:-1] > 0).all()


def test_the_fastest_node() -> None:
    _, state = fibers(line(4))
    v = np.zeros((4, 3))
    v[2] = (3e-3, 0.0, 4e-3)
    assert observables.fastest(state._replace(v=v)) == pytest.approx(5e-3)


def test_a_fiber_of_one_edge_has_no_twist() -> None:
    assembly, state = fibers(line(2), line(4, 1e-3))
    assert observables.twist(assembly, state).tolist() == [0.0, 0.0]


# --- friction of a pulled bend

WHAT = {"force": 15.0, "radius": H, "eta": 1e5}


def c_f(speed: float) -> float:
    return 15.0 * 2 * H / (1e5 * math.pi * H**2 * speed)


def test_friction_of_a_steady_pull_ignores_the_start() -> None:
    t = np.linspace(0, 1, 101)
    s = np.where(t < 0.3, 0.05 * t, 0.05 * 0.3 + 0.01 * (t - 0.3))
    found = observables.friction(t, s, **WHAT)
    assert found.slipped_at is None
    assert found.speed == pytest.approx(0.01, rel=1e-9)
    assert found.c_f == pytest.approx(c_f(0.01), rel=1e-9)


def test_slipping_ends_the_mean() -> None:
    t = np.linspace(0, 1, 101)
    s = np.cumsum(np.where(t <= 0.7 + 1e-9, 0.01, 0.05)) * 0.01
    found = observables.friction(t, s, **WHAT)
    ratio = 0.05 / ((0.4 * 0.01 + 0.01 * 0.05) / 0.41)  # at 0.71 s; 1 at 0.7 s
    past = 0.01 * 0.5 / (ratio - 1)
    assert found.slipped_at == pytest.approx(0.7 + past)
    assert found.speed == pytest.approx((0.4 * 0.01 + past * 0.05) / (0.4 + past))


@pytest.mark.parametrize(("fast_until", "slips"), [(0.75, False), (1.0, True)])
def test_a_bend_that_holds_again_has_not_slipped(fast_until: float, slips: bool) -> None:
    t = np.linspace(0, 1, 101)
    fast = (t > 0.7 + 1e-9) & (t <= fast_until + 1e-9)
    found = observables.friction(t, np.cumsum(np.where(fast, 0.05, 0.01)) * 0.01, **WHAT)
    assert (found.slipped_at is not None) is slips


def test_too_little_way_is_no_slip() -> None:
    t = np.linspace(0, 1, 101)
    s = np.cumsum(np.where(t > 0.985, 0.019, 0.01)) * 0.01  # less than a diameter more than before
    assert s[-1] - s[98] < 2 * H
    assert observables.friction(t, s, **WHAT).slipped_at is None


def test_being_loose_earlier_is_slipping() -> None:
    t = np.array([0.0, 0.25, 0.5, 0.55])
    found = observables.friction(t, 0.01 * t, **WHAT, loose_at=0.55)
    assert found.slipped_at == 0.55
    assert found.speed == pytest.approx(0.01)


@pytest.mark.parametrize("loose_at", [None, 0.2])
def test_a_short_history_is_averaged_from_its_start(loose_at: float | None) -> None:
    t = np.linspace(0, 0.2, 21)
    found = observables.friction(t, 1.0 + 0.03 * t, **WHAT, loose_at=loose_at)
    assert found.speed == pytest.approx(0.03)
    assert found.slipped_at == loose_at


def test_ends_that_do_not_part_have_no_friction_coefficient() -> None:
    t = np.linspace(0, 1, 11)
    assert observables.friction(t, 0 * t, **WHAT).c_f is None
    assert observables.friction([0.0], [1.0], **WHAT).c_f is None


def test_pull_speed_is_the_mean_over_the_interval_before() -> None:
    speed = observables.pull_speed([0.0, 0.5, 0.6], [0.0, 1.0, 1.5])
    assert math.isnan(speed[0])
    np.testing.assert_allclose(speed[1:], [2.0, 5.0])


def helix(n: int, radius: float, rise: float, turns: float) -> NDArray[np.float64]:
    a = np.linspace(0.0, 2 * np.pi * turns, n)
    return np.stack([radius * np.cos(a), radius * np.sin(a), rise * a], axis=1)


def test_a_ring_is_planar_and_a_cube_is_not() -> None:
    cube = np.array(list(np.ndindex(2, 2, 2)), float)
    assert observables.non_planarity(ring(40, 3.0)) < 1e-9
    assert observables.non_planarity(cube + 5.0) == pytest.approx(1.0)
    stretched = cube * [1.0, 2.0, 4.0]
    assert observables.non_planarity(stretched) == pytest.approx(0.25)


def test_torsion_is_that_of_a_helix_and_straight_parts_do_not_count() -> None:
    """tau = b/(a^2 + b^2) of a helix of radius a that rises b a radian."""
    x = helix(400, 3.0, 1.0, 4.0)
    assert observables.mean_torsion(x, 2.0) == pytest.approx(2.0 / (9.0 + 1.0), rel=1e-3)
    assert observables.mean_torsion(x * [1.0, 1.0, 0.0], 2.0) < 1e-9
    tangent = (x[-1] - x[-2])[None]
    led_out = np.concatenate([x, x[-1] + tangent * np.arange(1, 200)[:, None]])
    assert observables.mean_torsion(led_out, 2.0) == pytest.approx(observables.mean_torsion(x, 2.0), rel=1e-2)
    assert observables.mean_torsion(helix(400, 3.0, -1.0, 4.0), 2.0) == pytest.approx(0.2, rel=1e-3)
