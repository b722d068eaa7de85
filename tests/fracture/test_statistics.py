"""Means, shares, the smallest fragment and sectors, against textbooks and brute force."""

import math

import numpy as np
import pytest
from scipy import stats

from torsade.fracture.criteria import limit_curvature
from torsade.fracture.rod import spaghetti
from torsade.fracture.statistics import mean, sector_angle, sectors, share, smallest_fragment

ROD = spaghetti()


def test_mean_is_student_s() -> None:
    x = [3.0, 4.0, 4.0, 6.0]
    found = mean(x)
    low, high = stats.t.interval(0.95, 3, loc=np.mean(x), scale=stats.sem(x))
    assert (found.value, found.n) == (4.25, 4)
    assert (found.low, found.high) == (pytest.approx(low), pytest.approx(high))
    assert found.error == pytest.approx(stats.sem(x))


def test_one_value_has_no_error() -> None:
    found = mean([2.0])
    assert found.value == 2
    assert math.isnan(found.error)


@pytest.mark.parametrize(("k", "n"), [(0, 5), (3, 20), (7, 7)])
def test_share_is_wilson_s(k: int, n: int) -> None:
    interval = stats.binomtest(k, n).proportion_ci(0.95, "wilson")
    found = share(k, n)
    assert (found.low, found.high) == (pytest.approx(interval.low), pytest.approx(interval.high))


def test_smallest_fragment() -> None:
    """L/4 when a rod broke in **two**, whatever its pieces; else the smallest piece."""
    assert smallest_fragment(2, 0.11, 0.24) == 0.06
    assert smallest_fragment(4, 0.03, 0.24) == 0.03
    assert smallest_fragment(4, None, 0.24) is None


def test_angles_are_even_on_the_ellipse() -> None:
    """On the critical ellipse kappa = kappa_0 sin phi and Tw = Tw_0 cos phi."""
    phi = np.linspace(0.05, 1.5, 20)
    kappa_0 = 2 * 1.9e7 / (ROD.E * ROD.h)
    twist = math.sqrt(2) * 1.9e7 * ROD.L / (ROD.mu * ROD.h) * np.cos(phi)
    kappa = limit_curvature(twist / ROD.L, 1.9e7, ROD.E, ROD.mu, ROD.h)
    np.testing.assert_allclose(kappa, kappa_0 * np.sin(phi), rtol=1e-12)
    np.testing.assert_allclose(sector_angle(twist, kappa, ROD), phi, rtol=1e-12)
    np.testing.assert_allclose(sector_angle(-twist, kappa, ROD), phi, rtol=1e-12)


def test_printed_rays_go_through_the_printed_points() -> None:
    """(mu^2 J L^-1 cos phi, E^2 I sin phi) as twist and curvature."""
    I, J = ROD.section.I, ROD.section.J
    for phi in (0.2, 0.8, 1.4):
        point = ROD.mu**2 * J / ROD.L * math.cos(phi), ROD.E**2 * I * math.sin(phi)
        assert float(sector_angle(*point, ROD, "printed")) == pytest.approx(phi, rel=1e-12)


@pytest.mark.parametrize("rays", ["ellipse", "printed"])
def test_sectors_by_brute_force(rays: str) -> None:
    generator = np.random.default_rng(2)
    twist, kappa = generator.uniform(-6, 6, 200), generator.uniform(0, 15, 200)
    pieces = generator.integers(2, 6, 200)
    found = sectors(list(twist), list(kappa), list(pieces), ROD, rays=rays)  # type: ignore[arg-type]
    assert sum(s.pieces.n for s in found) == 200
    angle = sector_angle(twist, kappa, ROD, rays)  # type: ignore[arg-type]
    for s in found:
        inside = (angle >= s.low) & (angle < s.high)
        assert s.pieces.n == inside.sum()
        assert s.kappa.value == pytest.approx(kappa[inside].mean())
        assert s.twist.value == pytest.approx(np.abs(twist[inside]).mean())


def test_the_axes_belong_to_the_outer_sectors() -> None:
    found = sectors([0.0, 3.0], [10.0, 0.0], [4, 2], ROD)
    assert [(round(math.degrees(s.low)), round(math.degrees(s.high))) for s in found] == [(0, 9), (81, 90)]
