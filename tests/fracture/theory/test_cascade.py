"""The cascade of linear theory: published numbers of pieces, symmetry, times, disorder that repeats."""

import math
from itertools import pairwise

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.fracture.criteria import limit_curvature
from torsade.fracture.rod import Rod, spaghetti
from torsade.fracture.theory.cascade import disordered_cascades, linear_cascade
from torsade.fracture.theory.scales import bending_time

ROD = spaghetti()
SIGMA_C, LAMBDA = 1.9e7, 0.03


@pytest.mark.parametrize(
    ("degrees", "pieces"), [(0, 6), (60, 6), (120, 4), (200, 4), (240, 4), (280, 2), (350, 2), (400, 2)]
)
def test_pieces_against_twist(degrees: float, pieces: int) -> None:
    """6 at 0-60 degrees, 4 at 120-250, 2 from 280: as the full equations have it."""
    assert linear_cascade(ROD, math.radians(degrees), SIGMA_C, LAMBDA).pieces == pieces


@pytest.mark.parametrize("share", [0.2, 0.245, 0.25, 0.255, 0.3])
@pytest.mark.parametrize("C", [1.5, 1.65])
def test_two_pieces_exactly_when_no_third_fits(share: float, C: float) -> None:
    """Without twist a rod breaks in two from lambda = L/4 on."""
    found = linear_cascade(ROD, 0.0, SIGMA_C, share * ROD.L, C=C)
    assert (found.pieces == 2) == (share >= 0.25)


def test_lengths_and_times() -> None:
    """Pieces make up the rod, no break is nearer than lambda to another, and waves take their time."""
    found = linear_cascade(ROD, 0.0, SIGMA_C, LAMBDA)
    assert sum(found.lengths) == pytest.approx(ROD.L, rel=1e-14)
    np.testing.assert_allclose(found.lengths, found.lengths[::-1], rtol=1e-12)
    places = sorted(place for _, place in found.breaks)
    assert min(b - a for a, b in pairwise(places)) >= LAMBDA * (1 - 1e-9)
    times = [time for time, _ in found.breaks]
    assert times == sorted(times)
    assert times[0] == 0
    assert times[1] == pytest.approx(bending_time(ROD, LAMBDA), rel=1e-9)
    assert times[-1] == pytest.approx(2 * bending_time(ROD, LAMBDA), rel=1e-9)


def test_first_break_is_at_the_limit_curvature() -> None:
    twist = math.radians(200)
    kappa = linear_cascade(ROD, twist, SIGMA_C, LAMBDA).kappa_c
    limit = float(limit_curvature(twist / ROD.L, SIGMA_C, ROD.E, ROD.mu, ROD.h))
    assert kappa == pytest.approx(limit, rel=1e-6)


def test_twist_alone_breaks_it_in_two() -> None:
    found = linear_cascade(ROD, math.radians(365), SIGMA_C, LAMBDA)
    assert (found.kappa_c, found.breaks) == (0.0, ((0.0, 0.12),))


def test_a_weak_place_breaks_first() -> None:
    strength = np.ones(241)
    strength[80] = 0.5
    found = linear_cascade(ROD, 0.0, SIGMA_C, LAMBDA, strength=strength)
    assert found.breaks[0] == (0.0, pytest.approx(0.08))


def test_disorder_repeats_and_makes_odd_numbers() -> None:
    """A cascade depends on its seed and its number alone; both parities occur."""
    few = disordered_cascades(ROD, 1.0, SIGMA_C, LAMBDA, 0.05, 5, seed=3)
    many = disordered_cascades(ROD, 1.0, SIGMA_C, LAMBDA, 0.05, 40, seed=3)
    assert many[:5] == few
    assert {c.pieces % 2 for c in many} == {0, 1}
    other = disordered_cascades(ROD, 1.0, SIGMA_C, LAMBDA, 0.05, 5, seed=4)
    assert other != few


def test_without_scatter_disorder_is_none() -> None:
    """51 places, the middle among them, and all breaks of the thesis's rods nearly on them."""
    (found,) = disordered_cascades(ROD, math.radians(300), SIGMA_C, LAMBDA, 0.0, 1, seed=1)
    assert found.lengths == pytest.approx((0.12, 0.12))


def test_a_rod_too_strong_to_break_gets_a_sentence() -> None:
    with pytest.raises(TorsadeError, match=r"does not break before its ends have met and crossed; give less"):
        linear_cascade(Rod(3.8e9, 1.46e9, 1500.0, 7e-4, 0.05), 0.0, 1e9, 0.01)
