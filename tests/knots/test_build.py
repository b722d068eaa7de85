"""Fibers from diagrams: what they are, how clear and smooth they are, and what they do not depend on."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from torsade import curve
from torsade.errors import TorsadeError
from torsade.knots import PULLS, BuiltKnot, bend_diagram, build, suture_diagram
from torsade.knots.bends import bends
from torsade.knots.build import _built
from torsade.knots.shape import shapes
from torsade.topology import from_text, identify, identify_curves, linking, named_diagram, project
from torsade.topology.codes import from_pd, to_pd
from torsade.topology.diagram import Diagram
from torsade.topology.table import contents
from torsade.topology.tangle import closures, cut, union

H = 2e-4
SMALL = [name for name in contents()["knots"] if name != "0_1" and int(name.split("_")[0]) <= 6]
LARGE = [name for name in contents()["knots"] if name not in ("0_1", *SMALL)]
LINKS = ["L2a1", "L4a1", "L5a1", "L6a4", "L6n1", "3_1#m3_1"]


def gap(strands: tuple[NDArray[np.float64], ...], closed: tuple[bool, ...]) -> float:
    """Smallest distance between nodes of different strands, or more than pi h apart along one."""
    least = math.inf
    for k, (x, is_closed) in enumerate(zip(strands, closed, strict=True)):
        for y in strands[k + 1 :]:
            least = min(least, float(cdist(x, y).min()))
        s = curve.arclength(x, is_closed)
        apart = np.abs(s[:, None] - s)
        if is_closed:
            apart = np.minimum(apart, curve.length(x, True) - apart)
        least = min([least, *cdist(x, x)[apart > math.pi * H]])
    return least


def assert_clean(built: BuiltKnot, spacing: float = 0.5) -> None:
    assert gap(built.strands, built.closed) > 2.1 * H
    assert 2.1 * H <= built.clearance < 2.6 * H or len(built.strands[0]) < 40
    for x, closed in zip(built.strands, built.closed, strict=True):
        edges = curve.edge_lengths(x, closed)
        assert edges.max() <= spacing * H * (1 + 1e-9)
        assert edges.min() > 0.98 * edges.max()
        a, b = (np.roll(x, -1, axis=0) - x, np.roll(x, -2, axis=0) - np.roll(x, -1, axis=0))
        if not closed:
            a, b = a[:-2], b[:-2]
        area = np.linalg.norm(np.cross(a, b), axis=1)
        sides = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1) * np.linalg.norm(a + b, axis=1)
        assert (2 * H * area / sides).max() < 0.505
    assert built.h_kappa <= 0.5


@pytest.mark.parametrize("name", SMALL)
def test_knots(name: str) -> None:
    for diagram, wanted in ((named_diagram(name), name), (named_diagram(name).mirror(), f"m{name}")):
        built = build(diagram, H)
        assert_clean(built)
        assert str(identify_curves(built.strands)) in (wanted, name if name in ("4_1", "6_3") else wanted)
        assert curve.length(built.strands[0], True) < 80 * H


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_larger_knots(name: str) -> None:
    built = build(named_diagram(name), H)
    assert_clean(built)
    assert str(identify_curves(built.strands)) == name
    assert curve.length(built.strands[0], True) < 130 * H


@pytest.mark.parametrize("name", LINKS)
def test_links_and_sums(name: str) -> None:
    diagram = named_diagram(name)
    built = build(diagram, H)
    assert_clean(built)
    assert str(identify_curves(built.strands)) == str(identify(diagram))
    if diagram.n_strands > 1:
        found = linking(built.strands, closed=True)
        off = ~np.eye(diagram.n_strands, dtype=bool)
        np.testing.assert_allclose(np.asarray(found)[off], diagram.linking[off], atol=1e-6)


@pytest.mark.parametrize("code", ["{1,2,3,-4}", "{3,2,-2,-1,-3,-1}", "{1,-2,-2,1,4,-4}", "{-4,-4,1,3,1,2,1}"])
def test_loops_and_what_falls_apart(code: str) -> None:
    """Nugatory crossings, bigons that open, split pieces and circles."""
    built = build(from_text(code), H)
    assert_clean(built)
    assert str(identify_curves(built.strands)) == str(identify(from_text(code)))


def test_a_circle_is_round() -> None:
    (x,) = build(Diagram.circle(), H).strands
    r = np.linalg.norm(x - x.mean(axis=0), axis=1)
    np.testing.assert_allclose(r, r.mean(), rtol=1e-3)
    assert 2 * H <= r.mean() < 2.1 * H


def test_pieces_lie_side_by_side() -> None:
    built = build(union(named_diagram("3_1"), union(named_diagram("4_1"), Diagram.circle())), H)
    assert_clean(built)
    reach = sorted((x[:, 0].min(), x[:, 0].max()) for x in built.strands)
    assert all(a[1] + 3 * H < b[0] for a, b in pairwise(reach))


# --- what it does not depend on


@pytest.mark.parametrize(
    ("diagram", "pulled"),
    [
        (named_diagram("5_2"), None),
        (named_diagram("8_20"), None),
        (named_diagram("L6a4"), None),
        (bends()["granny"].diagram, "A1B0"),
        (bends()["sheet_bend"].diagram, "A1B1"),
        (cut(named_diagram("4_1")), None),
    ],
)
def test_the_mirror_image_is_the_mirror_image(diagram: Diagram, pulled: str | None) -> None:
    one, other = build(diagram, H, pulled=pulled), build(diagram.mirror(), H, pulled=pulled)
    for x, y in zip(one.strands, other.strands, strict=True):
        np.testing.assert_array_equal(x * [1.0, 1.0, -1.0], y)


def test_crossings_may_be_numbered_otherwise() -> None:
    """The same drawing, its strand begun at the same edge: the same to the last bit."""
    diagram = named_diagram("7_5")
    code = to_pd(diagram)
    other = from_pd([code[k] for k in (3, 0, 6, 1, 5, 2, 4)])
    assert other.mate != diagram.mate
    np.testing.assert_array_equal(build(diagram, H).strands[0], build(other, H).strands[0])


def test_sizes_scale_with_the_radius() -> None:
    one, other = (build(named_diagram("4_1"), r).strands[0] for r in ("0.2 mm", "1 m"))
    np.testing.assert_allclose(5e3 * one, other, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("spacing", [0.2, 1.0])
def test_spacing(spacing: float) -> None:
    assert_clean(build(named_diagram("5_1"), H, spacing=spacing * H), spacing)


# --- lengths


def test_a_length_is_met() -> None:
    for diagram in (named_diagram("3_1"), named_diagram("L2a1"), cut(named_diagram("3_1"))):
        built = build(diagram, H, length="30 mm")
        total = sum(curve.length(x, c) for x, c in zip(built.strands, built.closed, strict=True))
        assert total == pytest.approx(30e-3, rel=1e-9)
        assert built.clearance >= 2.1 * H
        assert built.h_kappa <= 0.5


def test_the_shortest_length_is_told_and_can_be_had() -> None:
    diagram = named_diagram("3_1")
    natural = curve.length(build(diagram, H).strands[0], True)
    with pytest.raises(TorsadeError, match=r"the shortest fiber made of this diagram has 0\.007"):
        build(diagram, H, length=0.99 * natural)
    built = build(diagram, H, length=natural)
    assert curve.length(built.strands[0], True) == pytest.approx(natural, rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"radius": -1.0}, "radius is -1 m"),
        ({"spacing": "1 mm"}, "spacing is 0.001 m; give"),
        ({"lead": "1 mm"}, "a lead is given, but all strands are closed"),
        ({"pulled": "A1B1"}, "with no ends"),
    ],
)
def test_refusals(arguments: dict[str, object], says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        build(named_diagram("3_1"), **arguments)  # type: ignore[arg-type]


def test_refusals_of_tangles() -> None:
    reef = bend_diagram("reef")
    with pytest.raises(TorsadeError, match="one of each of two open strands"):
        build(reef, H, pulled="A1A0")
    with pytest.raises(TorsadeError, match="give lead and tail"):
        build(reef, H, length="10 cm")
    with pytest.raises(TorsadeError, match=r"lead is 0\.0001 m; give 0\.001 to 2 m"):
        build(reef, H, lead="0.1 mm")


# --- open strands


def ends(built: BuiltKnot) -> dict[str, NDArray[np.float64]]:
    return {f"{s}{k}": x[-k] for s, x in zip("AB", built.strands, strict=False) for k in (0, 1)}


def leaving(x: NDArray[np.float64], end: int) -> NDArray[np.float64]:
    """Unit direction in which the strand runs out at its end 0 or 1."""
    d = x[-1] - x[-2] if end else x[0] - x[1]
    return np.asarray(d / np.linalg.norm(d))


def assert_led_out(built: BuiltKnot) -> None:
    """Pulled ends on the x axis and along it, the first at -x; free ends 60 degrees from it, straight."""
    assert built.pulled is not None
    for name, at in ends(built).items():
        d = leaving(built.strands["AB".index(name[0])], int(name[1]))
        if name in (built.pulled[:2], built.pulled[2:]):
            side = -1.0 if name == built.pulled[:2] else 1.0
            np.testing.assert_allclose(at[1:], 0.0, atol=1e-12)
            np.testing.assert_allclose(d, [side, 0, 0], atol=1e-6)
            assert side * at[0] > 15 * H
        else:
            assert abs(d[0]) == pytest.approx(0.5, abs=1e-6)
            assert abs(d[1]) == pytest.approx(math.sqrt(0.75), abs=1e-6)


def assert_is(built: BuiltKnot, diagram: Diagram) -> None:
    """The same knot whichever way ends are joined, ends having the same names and order."""
    seen = project(built.strands).diagram
    k = seen.ends.index(diagram.ends[0])
    assert seen.ends[k:] + seen.ends[:k] == diagram.ends
    wanted = {frozenset(map(frozenset, joins)): identify(knot).names for joins, knot in closures(diagram)}
    for joins, knot in closures(seen):
        assert identify(knot).names == wanted[frozenset(map(frozenset, joins))]


@pytest.mark.parametrize("name", ["reef", "granny", "sheet_bend", "carrick"])
@pytest.mark.parametrize("pulled", PULLS)
def test_bends(name: str, pulled: str) -> None:
    diagram = bends()[name].diagram
    built = build(diagram, H, pulled=pulled)
    assert_clean(built)
    assert_led_out(built)
    assert_is(built, diagram)


@pytest.mark.slow
@pytest.mark.parametrize("name", bends())
@pytest.mark.parametrize("pulled", PULLS)
def test_all_bends(name: str, pulled: str) -> None:
    diagram = bends()[name].diagram
    built = build(diagram, H, pulled=pulled)
    assert_clean(built)
    assert_led_out(built)
    assert_is(built, diagram)


@pytest.mark.parametrize(("bottom", "top"), [(3, 3), (5, -3), (-7, 5)])
def test_sutures(bottom: int, top: int) -> None:
    diagram = suture_diagram(bottom, top)
    built = build(diagram, H)
    assert_clean(built)
    assert_led_out(built)
    assert_is(built, diagram)


def test_leads_and_tails_have_their_lengths() -> None:
    reef = bend_diagram("reef")
    short, long = build(reef, H, lead="4 mm", tail="6 mm"), build(reef, H, lead="5 mm", tail="9 mm")
    for x, y in zip(short.strands, long.strands, strict=True):
        assert curve.length(y) - curve.length(x) == pytest.approx(4e-3, rel=1e-3)


@pytest.mark.parametrize("name", ["3_1", "4_1", "5_2"])
def test_knots_in_one_strand(name: str) -> None:
    built = build(cut(named_diagram(name)), H)
    assert built.pulled == "A0A1"
    assert_clean(built)
    assert_led_out(built)
    (x,) = built.strands
    assert str(identify(next(closures(project([x]).diagram))[1])) == name


def test_the_same_fiber_is_made_once() -> None:
    assert build(named_diagram("3_1"), H) is build(named_diagram("3_1"), H)


@pytest.mark.parametrize("diagram", [named_diagram("8_19"), bend_diagram("carrick")], ids=["8_19", "carrick"])
def test_building_repeats_to_the_bit(diagram: Diagram) -> None:
    first = build(diagram, H)
    _built.cache_clear()
    shapes.cache_clear()
    again = build(diagram, H)
    assert again is not first
    for x, y in zip(first.strands, again.strands, strict=True):
        np.testing.assert_array_equal(x, y)
