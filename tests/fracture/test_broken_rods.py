"""The fracture cascade of thesis chapter 3: how many pieces, where, when, and what a break conserves."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.assembly import assemble
from torsade.errors import TorsadeError
from torsade.fracture.cascade import Cascade, Fracture, most_breaks, strengths
from torsade.fracture.criteria import CRITERIA, stress
from torsade.fracture.limit import breaking_shape, rod_fiber
from torsade.material import Section, named_material
from torsade.motion.grips import gripped
from torsade.motion.inertial import Inertial
from torsade.motion.moving import Outcome
from torsade.protocols import SnapTwist

SPAGHETTI, SECTION = named_material("spaghetti"), Section(7e-4)
SPEED = np.sqrt(SPAGHETTI.E / SPAGHETTI.rho)


def pieces(**fields: object) -> int:
    cascade, _ = SnapTwist(**fields).broken()
    cascade.advance(SnapTwist(**fields).lasting)
    return len(cascade.lengths)


@pytest.mark.parametrize(("twist", "count"), [(0, 6), (30, 6), (60, 6), (180, 4), (220, 4), (250, 4)])
def test_low_twist_breaks_a_rod_into_six_or_four(twist: int, count: int) -> None:
    """24 cm, 1.4 mm, sigma_c 1.9e7 Pa, lambda 30 mm, no disorder (thesis Fig 3-4): even numbers."""
    assert pieces(twist=f"{twist} deg") == count


@pytest.mark.parametrize("twist", [280, 300, 320, 340, 355])
@pytest.mark.parametrize("going", ["moving", "frozen"])
def test_high_twist_breaks_a_rod_in_two(twist: int, going: str) -> None:
    """Beyond the switch between 250 and 280 degrees."""
    assert pieces(twist=f"{twist} deg", pieces=going) == 2


@pytest.mark.parametrize("edges", [50, 100])
def test_the_other_rod_of_the_thesis_switches_below_200_degrees(edges: int) -> None:
    """20 cm, 1.7 mm: theory has the switch at 168 degrees for C = 1.43 and 175 for C = 1.5."""
    rod = {"length": "20 cm", "radius": "0.85 mm", "edges": edges}
    assert pieces(twist="0 deg", **rod) >= 4
    assert pieces(twist="160 deg", **rod) == 4
    assert pieces(twist="200 deg", **rod) == 2


@pytest.mark.parametrize(("mm", "two"), [(40, False), (50, False), (56, False), (60, True), (80, True)])
def test_an_untwisted_rod_breaks_in_two_only_where_lambda_is_a_quarter_of_it(mm: int, two: bool) -> None:
    """Half of it then cannot break into two longer pieces (thesis 3.3). Nodes are 2.4 mm apart."""
    assert (pieces(min_fragment=f"{mm} mm", edges=100) == 2) == two


def test_near_the_switch_the_second_break_comes_with_the_peak_of_the_wave() -> None:
    """At l^2/(2 pi h c_s) within 5 %: where strength asks for nearly all of the amplification."""
    for twist in (220, 250):
        cascade, _ = SnapTwist(twist=f"{twist} deg").broken()
        cascade.advance(1e-3)
        second = cascade.breaks[1]
        l = abs(second.place - 0.12)
        assert second.time == pytest.approx(l**2 / (2 * np.pi * SECTION.h * SPEED), rel=0.05)


@pytest.mark.parametrize(("twist", "edges"), [(0, 50), (180, 50), (300, 50), (250, 100)])
def test_amplification_lies_between_143_and_165(twist: int, edges: int) -> None:
    """Largest curvature beyond 2 cm from the break, in units of that at the break (thesis Fig 3-6A)."""
    spec = SnapTwist(twist=f"{twist} deg", edges=edges, min_fragment="240 mm")
    cascade, found = spec.broken()
    a = cascade.motion.assembly
    from_break = np.abs(np.cumsum(a.rest_length)[a.hinges[:, 0]] - 0.12)
    inside = (from_break > 0.02) & (from_break < 0.1)
    largest = 0.0
    while cascade.time < 0.5 * spec.lasting:
        cascade.advance(cascade.time + 5e-6)
        cascade.measure()
        largest = max(largest, float(cascade.kappa()[inside].max()))
    assert 1.40 < largest / found["critical_curvature_per_m"] < 1.65


def test_both_sides_of_an_untwisted_rod_break_alike_without_being_told_to() -> None:
    cascade, _ = SnapTwist().broken()
    cascade.advance(2e-3)
    np.testing.assert_allclose(cascade.lengths, cascade.lengths[::-1], atol=1e-12)
    times = sorted(b.time for b in cascade.breaks)
    assert times[1] == times[2]
    assert times[3] == times[4]
    assert cascade.lengths.sum() == pytest.approx(0.24, abs=1e-12)
    assert cascade.lengths.min() > 0.03


def test_a_break_changes_neither_mass_nor_momentum_and_frees_what_the_hinge_held() -> None:
    cascade, _ = SnapTwist(twist="100 deg").broken()
    cascade.advance(1e-4)
    m = cascade.motion
    mass, momentum = m.inertia.mass.sum(), m.inertia.mass @ m.state.v
    energy, released = m.energies(), cascade.released
    hinge = 12
    cascade.measure()
    kappa, twist = cascade.kappa()[hinge], cascade.twist_density()[hinge]
    lbar = m.assembly.hinge_length[hinge]
    cascade.snap([hinge])
    assert m.inertia.mass.sum() == pytest.approx(mass, rel=1e-14)
    np.testing.assert_allclose(m.inertia.mass @ m.state.v, momentum, atol=1e-18)
    after = m.energies()
    held = 0.5 * lbar * (m.rod.B * kappa**2 + m.rod.C * twist**2)
    assert energy.total - after.total == pytest.approx(held, rel=1e-9)
    assert cascade.released - released == pytest.approx(held, rel=1e-9)
    assert (after.kinetic, after.spin) == pytest.approx((energy.kinetic, energy.spin), rel=1e-12)


def test_energy_is_accounted_for_through_all_breaks() -> None:
    cascade, _ = SnapTwist(twist="60 deg").broken()
    m = cascade.motion

    def all_of_it() -> float:
        return m.energies().total + m.dissipation + cascade.released

    begun = all_of_it()
    cascade.advance(2e-3)
    assert len(cascade.breaks) == 5
    assert all_of_it() == pytest.approx(begun, rel=2e-3)


def test_frozen_pieces_stay_where_they_broke_off() -> None:
    cascade, _ = SnapTwist(pieces="frozen").broken()
    cascade.advance(4e-4)
    assert len(cascade.breaks) == 5
    start = cascade.motion.assembly.node_start
    free = slice(start[1], start[5])
    before = cascade.motion.state.x[free].copy()
    cascade.advance(8e-4)
    assert np.array_equal(cascade.motion.state.x[free], before)
    assert np.abs(cascade.motion.state.v[: start[1]]).max() > 0


def test_a_saved_cascade_goes_on_to_the_same_bits() -> None:
    spec = SnapTwist(twist="60 deg", disorder=0.03, seed=2)
    whole, _ = spec.broken()
    whole.advance(2.5e-4)
    saved = whole.saved()
    assert len(whole.breaks) > 1
    whole.advance(1e-3)
    resumed, _ = spec.broken()
    resumed.recover(saved)
    resumed.advance(1e-3)
    assert resumed.breaks == whole.breaks
    for name, value in whole.saved().items():
        assert np.array_equal(value, resumed.saved()[name]), name


def test_a_cascade_is_over_a_given_time_after_its_first_break() -> None:
    shape, weakest = breaking_shape(
        rod_fiber(SPAGHETTI, SECTION, 0.24, 50), SPAGHETTI, SECTION, 0.0, np.full(49, 1.9e7)
    )
    a, state, boundary = gripped(shape.x, shape.grips)
    motion = Inertial(a, SPAGHETTI, SECTION, boundary, state)
    cascade = Cascade(motion, Fracture(np.full(51, 2e7)), SPAGHETTI, SECTION, followed=1e-4)
    assert cascade.advance(5e-5) is Outcome.REACHED
    cascade.snap([weakest + 1])
    assert cascade.advance(1e-3) is Outcome.OVER
    assert cascade.time == pytest.approx(1.5e-4, abs=2e-6)


@pytest.mark.parametrize("name", list(CRITERIA))
def test_every_criterion_breaks_the_rod_at_the_stress_that_it_says(name: str) -> None:
    """The kernel's stress is that of `fracture.criteria`, and without twist all limits are the same."""
    cascade, found = SnapTwist(twist="100 deg", criterion=name).broken()
    cascade.advance(1e-4)
    got = cascade.measure().copy()
    E, mu = SPAGHETTI.E_b, SPAGHETTI.mu
    wanted = stress(cascade.kappa(), cascade.twist_density(), E, mu, SECTION.h, name)
    np.testing.assert_allclose(got, wanted, rtol=1e-12)
    assert cascade.breaks[0].ratio == pytest.approx(1.0, abs=1e-8)
    _, untwisted = SnapTwist(criterion=name).broken()
    assert untwisted["critical_curvature_per_m"] == pytest.approx(2 * 1.9e7 / (E * SECTION.h), rel=1e-8)
    assert found["critical_curvature_per_m"] < untwisted["critical_curvature_per_m"]


def test_twist_beyond_361_degrees_breaks_the_straight_rod() -> None:
    with pytest.raises(TorsadeError, match=r"bears less than 361\.2 deg"):
        SnapTwist(twist="362 deg").broken()
    _, found = SnapTwist(twist="360 deg").broken()
    assert found["critical_curvature_per_m"] < 1.5


def test_a_rod_is_the_same_at_every_number_of_nodes() -> None:
    """Finer hinges are at least as strong as the coarser one that stands for their lengths too."""
    coarse, fine = (strengths(np.full(n, 0.24 / n), 1.9e7, 0.1, seed=5) for n in (40, 80))
    assert coarse.shape == (39,)
    assert np.all(np.minimum(np.minimum(fine[:-2:2], fine[1:-1:2]), fine[2::2]) <= coarse + 1e-6)
    assert fine.min() == pytest.approx(coarse.min())
    assert not np.array_equal(coarse, strengths(np.full(40, 0.006), 1.9e7, 0.1, seed=6))


def test_disorder_moves_the_first_break_from_the_middle_and_lets_odd_numbers_occur() -> None:
    counts, places = [], []
    for seed in range(24):
        cascade, found = SnapTwist(twist="200 deg", disorder=0.05, seed=seed).broken()
        cascade.advance(2e-3)
        counts.append(len(cascade.lengths))
        places.append(cascade.breaks[0].place)
        assert found["critical_curvature_per_m"] < 12.0
    assert np.std(places) > 5e-3
    assert {n % 2 for n in counts} == {0, 1}


@pytest.mark.parametrize(
    ("mm", "edges"), [(30, 13), (31.3, 14), (7, 3), (2.3, 1), (0, 1), (119, 50), (121, 51)]
)
def test_there_is_room_for_as_many_breaks_as_lambda_allows(mm: float, edges: int) -> None:
    """Against all places of the first break; each side then breaks into pieces of so many edges or more."""
    a = assemble([np.outer(np.linspace(0, 0.24, 101), [1.0, 0, 0])])
    most = max(1 + sum(max(side // edges - 1, 0) for side in (x, 100 - x)) for x in range(1, 100))
    assert most_breaks(a, 1e-3 * mm) == most


def test_frames_hold_a_short_first_piece_and_all_that_fit_beside_it() -> None:
    """35 edges of 4.8 mm of a rod that broke after the first can be cut six times at 33.6 mm."""
    spec = SnapTwist(frames=4)
    trial = spec.trial()
    fresh, _ = spec.broken()
    assert trial.sizes["piece_bound"] >= most_breaks(fresh.motion.assembly, spec.least_fragment) + 2


def test_a_rod_twisted_the_other_way_breaks_as_its_mirror_image() -> None:
    left, right = (SnapTwist(twist=f"{sign}200 deg").broken()[0] for sign in ("-", ""))
    for cascade in (left, right):
        cascade.advance(3e-4)
    np.testing.assert_allclose(left.lengths, right.lengths, atol=1e-12)
    mirrored = left.motion.state.x * [1.0, 1.0, -1.0]
    np.testing.assert_allclose(mirrored, right.motion.state.x, atol=1e-9)
    np.testing.assert_allclose(-left.motion.state.omega, right.motion.state.omega, atol=1e-3)
