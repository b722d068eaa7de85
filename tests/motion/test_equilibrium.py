"""Shapes in the twist device: units, refusals, and the inverse problem."""

from __future__ import annotations

import numpy as np
import pytest

from torsade import observables
from torsade.errors import TorsadeError
from torsade.motion.equilibrium import bent, bent_until, curvature_at_distance
from torsade.motion.supports import Fiber

UNIT = Fiber(1.0, 100, 1.0, 0.8)


def test_shapes_scale_with_length_and_forces_with_stiffness() -> None:
    """In SI units as in those of L and B: x ~ L, kappa ~ 1/L, F ~ B/L^2, M ~ B/L, E ~ B/L."""
    L, B = 3e-3, 2e-11
    one, other = bent(UNIT, 0.7, 3.0), bent(Fiber(L, 100, B, 0.8 * B), 0.7 * L, 3.0)
    assert other.x == pytest.approx(L * one.x, abs=1e-12)
    assert other.kappa == pytest.approx(one.kappa / L, rel=1e-9)
    assert other.force == pytest.approx(B / L**2 * one.force, abs=1e-12)
    assert other.torque == pytest.approx(B / L * one.torque, rel=1e-9)
    assert other.energy_bend == pytest.approx(B / L * one.energy_bend, rel=1e-9)
    assert other.stiffness() == pytest.approx(B / L**2 * one.stiffness(), rel=1e-6)


def test_an_assembled_shape_is_the_same_fiber() -> None:
    """Lengths, curvatures and twist as the rest of the package measures them."""
    b = bent(UNIT, 0.6, 2.5)
    a, state = b.assembled()
    assert a.rest_length == pytest.approx(0.01, rel=1e-12)
    m = observables.hinge_twist(a, state)
    assert m == pytest.approx(2.5 * a.hinge_length, rel=1e-9)
    assert observables.hinge_curvature(a, state) == pytest.approx(b.kappa[1:-1], rel=1e-9)


def test_the_way_to_a_shape_does_not_matter() -> None:
    """Bent then twisted, or from a neighbour: the same to 1e-8."""
    near = bent(UNIT, 0.75, 3.5)
    assert bent(UNIT, 0.7, 3.0, near).x == pytest.approx(bent(UNIT, 0.7, 3.0).x, abs=1e-8)
    assert bent(UNIT, 0.95, 0.2, near).x == pytest.approx(bent(UNIT, 0.95, 0.2).x, abs=1e-8)


@pytest.mark.parametrize(
    ("twist", "kappa"),
    [(0.0, 1e-3), (2.0, 1e-3), (-4.0, 0.5), (2.0, 3.4), (-4.0, 3.4), (0.0, 7.0), (1.0, 7.0)],
)
def test_the_distance_at_a_curvature(twist: float, kappa: float) -> None:
    """`bent_until` is the inverse of `bent`."""
    found = bent_until(UNIT, kappa, twist)
    assert found.kappa_max == pytest.approx(kappa, rel=1e-8 if kappa > 0.1 else 1e-6)
    assert found.total_twist == pytest.approx(twist, rel=1e-9)
    assert bent(UNIT, found.end_distance, twist).kappa_max == pytest.approx(kappa, rel=1e-5)


def test_rotation_held_is_the_same_family() -> None:
    """An arch of given twist has a rotation; given that, the same arch, also past the largest torque."""
    one = bent(UNIT, 0.6, 3.0)
    other = bent(UNIT, 0.6, rotation=one.rotation)
    assert other.x == pytest.approx(one.x, abs=1e-8)
    assert other.total_twist == pytest.approx(3.0, rel=1e-8)
    assert bent(UNIT, 0.6, rotation=one.rotation + 0.1, near=one).total_twist > 3.0
    with pytest.raises(TorsadeError) as caught:
        bent(UNIT, 0.3, 50.0)
    snaps = np.radians(float(str(caught.value).split("snaps at ")[1].split(" deg")[0]))
    top = bent(UNIT, 0.3, 0.999 * snaps)
    beyond = bent(UNIT, 0.3, near=top, rotation=top.rotation + 0.3)
    assert beyond.rotation == pytest.approx(top.rotation + 0.3, rel=1e-9)
    assert beyond.total_twist < top.total_twist


def test_small_arches_are_sines() -> None:
    """ERRATA to thesis 3.7: kappa_max = 2 pi sqrt(1 - d/L)/L times 1 + O(1 - d/L)."""
    for short in (1e-6, 1e-4):
        found = bent(Fiber(1.0, 400), 1 - short)
        assert found.kappa_max == pytest.approx(2 * np.pi * np.sqrt(short), rel=max(1e-4, 2 * short))


def test_curvatures_at_distances_and_their_errors() -> None:
    """The range is where the distance may be, by the elastica: kappa falls from 5.0352 to 4.7179 to 4.3971.

    Rows d/L = 0.49, 0.54, 0.59 of the table of test_elastica.
    """
    found = curvature_at_distance(Fiber(1.0, 400), 0.54, 0.0, 0.05)
    assert found == pytest.approx((4.71794167824, 4.39707289197, 5.03517181293), rel=1e-4)
    exact = curvature_at_distance(UNIT, 0.8, 1.0)
    assert exact.low == exact.value == exact.high
    nearly = curvature_at_distance(UNIT, 0.999, 1.0, 0.01)
    assert nearly.low == 0.0 < nearly.value < nearly.high


@pytest.mark.parametrize(("distance", "farther"), [(0.7, 0.98), (0.7, 0.999), (0.4, 0.99), (0.05, 1 - 1e-8)])
def test_an_arch_is_opened_until_it_is_nearly_straight(distance: float, farther: float) -> None:
    """However long the way, the shape is the arch that is found without a neighbour, on the same side."""
    near = bent(UNIT, distance)
    opened, alone = bent(UNIT, farther, near=near), bent(UNIT, farther)
    assert opened.kappa_max == pytest.approx(alone.kappa_max, rel=1e-7)
    assert opened.x[:, 1].min() >= -1e-12
    low = curvature_at_distance(UNIT, distance, 0.0, farther - distance).low
    assert low == pytest.approx(alone.kappa_max, rel=1e-7)


@pytest.mark.parametrize(
    ("distance", "twist", "says"),
    [
        (1.0, 0.0, "give a distance from 0 to less than its length"),
        (-0.1, 0.0, "give a distance from 0 to less than its length"),
        (float("nan"), 0.0, "give a distance from 0 to less than its length"),
        (0.5, float("inf"), "give a finite angle"),
        (0.5, 9.0, "there it snaps at"),
        (0.3, -1e9, "there it snaps at -"),
    ],
)
def test_refusals(distance: float, twist: float, says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        bent(UNIT, distance, twist)


def test_a_curvature_that_no_distance_gives() -> None:
    with pytest.raises(TorsadeError, match="give one above 0"):
        bent_until(UNIT, 0.0)
    with pytest.raises(TorsadeError, match="give a smaller one"):
        bent_until(UNIT, 40.0)
    with pytest.raises(TorsadeError, match="give a smaller one"):
        bent_until(UNIT, 12.0, 4.0)


def test_where_it_snaps_is_where_no_more_twist_is_held() -> None:
    """A thousandth less than the twist said is held, a thousandth more is not, at any end distance."""
    for d in (0.05, 0.22, 0.4, 0.47):
        with pytest.raises(TorsadeError) as caught:
            bent(UNIT, d, 50.0)
        snaps = np.radians(float(str(caught.value).split("snaps at ")[1].split(" deg")[0]))
        assert bent(UNIT, d, 0.999 * snaps).total_twist == pytest.approx(0.999 * snaps, rel=1e-9)
        with pytest.raises(TorsadeError):
            bent(UNIT, d, 1.001 * snaps)
