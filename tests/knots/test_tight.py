"""Tight knots against exact links, published ropelengths, and the balance of forces."""

from __future__ import annotations

import numpy as np
import pytest

import torsade as ts
from torsade.knots import TightKnot, thickness, tighten
from torsade.knots.loose import listed_ropelength, loose_knot
from torsade.knots.tight import Interrupted
from torsade.topology import identify_curves, writhe
from torsade.topology.table import contents

THROUGH_SEVEN = [name for name in contents()["knots"] if int(name.split("_")[0]) <= 7]


def within(knot: TightKnot, name: str, share: float) -> None:
    """Above what Ashton, Cantarella, Piatek and Rawdon (2011) found, and by no more than a share of it."""
    listed = listed_ropelength(name)
    assert listed is not None
    excess = knot.ropelength / listed - 1
    assert 0 <= excess < share


@pytest.fixture(scope="module")
def trefoil() -> TightKnot:
    return tighten(loose_knot("3_1"), radius=2e-4)


# --- exact values


def test_the_unknot_is_a_circle() -> None:
    """2 pi: it is all bent as sharply as it can be, and touches itself nowhere."""
    knot = tighten(loose_knot("unknot"), tries=0)
    assert 2 * np.pi <= knot.ropelength < 2 * np.pi * 1.002
    assert len(knot.kinks) == len(knot.strands[0])
    assert len(knot.contacts) == 0


@pytest.mark.parametrize(
    ("name", "ropelength"), [("hopf", 8 * np.pi), ("L2a1#L2a1", 12 * np.pi + 4)], ids=["hopf", "chain"]
)
def test_chains_of_circles_and_a_stadium(name: str, ropelength: float) -> None:
    """Cantarella, Kusner and Sullivan (2002): these link shapes are proven to be the shortest."""
    knot = tighten(loose_knot(name), tries=3)
    assert ropelength <= knot.ropelength < 1.003 * ropelength


# --- the trefoil


def test_the_trefoil(trefoil: TightKnot) -> None:
    """L/D 16.371637 and writhe 3.418: the ideal shape of Pieranski and Przybyl."""
    within(trefoil, "3_1", 0.002)
    assert trefoil.length / (2 * trefoil.radius) > 16.3716
    assert writhe(trefoil.strands, True) == pytest.approx(3.418, rel=0.004)
    assert str(identify_curves(trefoil.strands)) == "3_1"
    assert trefoil.residual < 3e-3


def test_what_is_returned_can_be_measured_again(trefoil: TightKnot) -> None:
    found = thickness(trefoil.strands)
    assert found.radius == pytest.approx(2e-4, rel=1e-12)
    assert found.length == pytest.approx(trefoil.length, rel=1e-12)
    assert trefoil.bend >= trefoil.radius
    assert trefoil.centerline.closed == (True,)
    ts.centerline.check(trefoil.centerline, trefoil.radius)


def test_the_virial_of_contacts_is_that_of_tension(trefoil: TightKnot) -> None:
    """Blown up by a factor, length grows as the work of tension, distances 2h as that of contacts: L = 2h sum
    f."""
    assert 2 * trefoil.forces.sum() == pytest.approx(trefoil.ropelength, rel=2e-3)
    assert np.all(trefoil.forces > 0)
    assert trefoil.contacts.max() < len(trefoil.strands[0])


def test_same_arguments_same_bits_and_mirror_images(trefoil: TightKnot) -> None:
    again = tighten(loose_knot("3_1"), radius=2e-4)
    assert np.array_equal(again.strands[0], trefoil.strands[0])
    left = tighten(loose_knot("m3_1"), tries=1)
    assert writhe(left.strands, True) == pytest.approx(-3.418, rel=0.01)


def test_ropelength_converges_with_nodes() -> None:
    """Always above the reference, and nearer with twice the nodes."""
    excess = [tighten(loose_knot("3_1"), nodes=n, tries=0).ropelength / 32.7429 - 1 for n in (82, 164)]
    assert 0 < 2.5 * excess[1] < excess[0]


# --- other knots


def test_the_figure_eight_is_tight_and_its_own_mirror_image() -> None:
    knot = tighten(loose_knot("4_1"))
    within(knot, "4_1", 0.004)
    assert abs(writhe(knot.strands, True)) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in THROUGH_SEVEN if n not in ("3_1", "4_1")])
def test_knots_through_seven_crossings(name: str) -> None:
    knot = tighten(loose_knot(name))
    within(knot, name, 0.005 if name in ("5_1", "5_2") else 0.02)
    assert str(identify_curves(knot.strands)) == name


def test_borromean_rings() -> None:
    """58.0060, the critical shape of Cantarella, Fu, Kusner, Sullivan and Wrinkle (2006)."""
    knot = tighten(loose_knot("borromean"), tries=0)
    assert 58.006 < knot.ropelength < 58.4
    assert str(identify_curves(knot.strands)) == "L6a4"


# --- a given ropelength


@pytest.mark.parametrize("name", ["3_1", "4_1"])
def test_stopped_at_a_ropelength(name: str) -> None:
    knot = tighten(loose_knot(name), ropelength=50.0)
    assert knot.reached
    assert knot.ropelength == pytest.approx(50.0, rel=1e-9)
    assert thickness(knot.strands).ropelength == pytest.approx(50.0, rel=1e-9)
    assert str(identify_curves(knot.strands)) == name
    assert ts.curve.turning_angles(knot.strands[0], True).max() < 0.25  # smooth: nodes a fifth of h apart


def test_a_ropelength_below_the_tight_one_is_not_reached() -> None:
    knot = tighten(loose_knot("4_1"), ropelength=40.0, tries=1)
    assert not knot.reached
    within(knot, "4_1", 0.01)


# --- what may go wrong


def test_interrupted_with_the_best_so_far() -> None:
    def stop(share: float, note: str) -> None:
        if share > 0.2:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stopped:
        tighten(loose_knot("3_1"), progress=stop)
    assert 32.74 < stopped.value.best.ropelength < 34


def test_rough_curves_are_smoothed() -> None:
    """A trefoil of few nodes with noise."""
    random = np.random.default_rng(3)
    x = loose_knot("3_1")[0][::10]
    within(tighten([x + 0.03 * random.normal(size=x.shape)], tries=3), "3_1", 0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radius": 0.0}, "radius of the fiber is 0"),
        ({"nodes": 10}, "10 nodes are asked for"),
        ({"nodes": 4000, "tries": 0}, "nodes would stand"),
        ({"ropelength": 6.0}, "above 2 pi"),
        ({"tries": -1}, "-1 tries"),
        ({"tolerance": 2.0}, "tolerance is 2"),
    ],
)
def test_refusals(options: dict[str, float], message: str) -> None:
    with pytest.raises(ts.TorsadeError, match=message):
        tighten(loose_knot("3_1"), **options)  # type: ignore[arg-type]


def test_no_strand_is_refused() -> None:
    with pytest.raises(ts.TorsadeError, match="no strand"):
        tighten([])


def test_ropelengths_that_are_listed() -> None:
    """Those of the ideal shapes of Pieranski and Przybyl, L/D, are the same within 0.02 %."""
    ideal = {"3_1": 16.371637, "4_1": 21.043322, "5_1": 23.598564, "6_3": 28.915367, "7_1": 30.700289}
    for name, ratio in ideal.items():
        assert listed_ropelength(name) == pytest.approx(2 * ratio, rel=2e-4)
    assert listed_ropelength("trefoil") == listed_ropelength("m3_1") == listed_ropelength("3_1")
    assert listed_ropelength("L5a1") is None
