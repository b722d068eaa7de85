"""N, tau, Gamma and Whitney index of pulled bends: definitions, catalogue, and what moves leave alone."""

from __future__ import annotations

import random
from collections import Counter
from itertools import islice

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from hanging import no_hang
from topology.curves import random_loop
from topology.drawing import shared
from torsade.errors import TorsadeError
from torsade.knots import bend, bend_diagram, suture_diagram
from torsade.knots.bends import bends
from torsade.topology import (
    Diagram,
    braid_curves,
    canonical_form,
    circulation_range,
    identify,
    identify_strands,
    is_isomorphic,
    named_diagram,
    project,
    pull_choices,
    state,
    twist_fluctuation,
    whitney_index,
)
from torsade.topology.codes import from_braid, from_gauss, from_pd, to_gauss
from torsade.topology.moves import add_bigon, add_kink, fingers, slide_triangle, triangles
from torsade.topology.swing import swings
from torsade.topology.tangle import close, closures, cut, integer
from torsade.topology.views import turning_number

PULLS = ("A1B1", "A1B0", "A0B1", "A0B0")

# --- definitions


@pytest.mark.parametrize(
    ("name", "crossings", "tau", "gamma"),
    [("reef", 6, 1, 4), ("thief", 6, 1, 1), ("granny", 6, 0, 4), ("grief", 6, 0, 1)],
)
def test_the_reef_group(name: str, crossings: int, tau: float, gamma: float) -> None:
    """(N, tau, Gamma) of figure 4-5D of the thesis; of the catalogue's drawing and of the built curve."""
    for knot in (bend_diagram(name), bend(name)):
        found = state(knot)
        assert (found.crossings, found.tau, found.gamma) == (crossings, tau, gamma)


def test_a_pull_replaces_that_of_the_name() -> None:
    assert state(bend("reef"), "A1B0") == state(bend("thief"))
    assert state(bend_diagram("reef"), "A1B0") == state(bend_diagram("thief"))
    assert state(bend_diagram("thief"), ["A1", "B1"]) == state(bend_diagram("reef"))


@given(st.lists(st.sampled_from((-1, 1)), min_size=1, max_size=40))
def test_the_three_forms_of_tau_agree(charges: list[int]) -> None:
    one, two, three = twist_fluctuation(charges)
    assert one == pytest.approx(two, abs=1e-12)
    assert two == pytest.approx(three, abs=1e-12)
    assert 0 <= one <= 1


@settings(deadline=None, max_examples=30)
@given(st.lists(st.sampled_from((-3, -2, -1, 1, 2, 3)), min_size=1, max_size=12))
def test_tau_of_a_drawing_is_that_of_its_charges(word: list[int]) -> None:
    found = state(from_braid(word))
    assert found.tau == pytest.approx(twist_fluctuation(found.charges)[0], abs=1e-12)
    assert found.crossings == len(word)
    assert found.writhe == sum(1 if i > 0 else -1 for i in word)


def test_no_crossings() -> None:
    circle = state(Diagram.circle())
    assert (circle.crossings, circle.tau, circle.gamma, circle.whitney, circle.loops) == (0, 0, 0, 1, 1)
    with pytest.raises(TorsadeError, match="there are no crossings"):
        twist_fluctuation([])


def test_choices_of_pulled_ends() -> None:
    assert ["".join(choice) for choice in pull_choices(integer(2))] == list(PULLS)
    assert list(pull_choices(from_braid([1, 1, 1]))) == [()]
    with pytest.raises(TorsadeError, match="A0 or A1 and B0 or B1"):
        state(bend_diagram("reef"), "A2B1")


# --- Whitney index


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.integers(1, 4))
def test_the_whitney_index_is_the_turning_number(seed: int, waves: int) -> None:
    """Of a closed drawing: smoothing crossings against the angles by which a polygon turns (Whitney 1937)."""
    x = random_loop(seed, 150, waves)
    seen = project([x], True)
    assume(seen.diagram.n_crossings)  # a circle without crossings counts as counterclockwise
    assert whitney_index(seen.diagram) == round(turning_number(x, True, seen.direction))


@pytest.mark.parametrize("word", [[1], [1, 1], [1, -2], [1, -2, 1, -2], [1, 2, 3], [-1, 2, 2, -3, 1]])
def test_the_whitney_index_of_links_adds(word: list[int]) -> None:
    """Closed braids run clockwise in space, once around for each strand."""
    curves = braid_curves(word)
    seen = project(curves, True)
    assert whitney_index(seen.diagram) == -(max(map(abs, word)) + 1)
    assert whitney_index(seen.diagram) == sum(round(turning_number(x, True, seen.direction)) for x in curves)


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.randoms(use_true_random=False))
def test_what_regular_isotopy_leaves_alone(seed: int, chance: random.Random) -> None:
    """Second and third Reidemeister moves keep writhe and Whitney index; a kink changes both by one.

    Closed drawings, all of whose faces are inside: of a tangle a move may change which arcs are left out.
    """
    drawn = project([random_loop(seed, 60)], True).diagram
    inner = [f for f in fingers(drawn) if drawn.face_at[f[0]] not in drawn.outer_faces]
    assume(inner)
    before, moved = state(drawn), add_bigon(drawn, *chance.choice(inner), over=True)
    for dart in list(triangles(moved))[:1]:
        if moved.face_at[dart] not in moved.outer_faces:
            moved = slide_triangle(moved, dart)
    after = state(moved)
    assert after.crossings == before.crossings + 2
    assert (after.writhe, after.whitney) == (before.writhe, before.whitney)
    kinked = state(add_kink(moved, moved.edges[0][0], 1))
    assert (kinked.writhe, abs(kinked.whitney - after.whitney)) == (after.writhe + 1, 1)


@pytest.mark.parametrize("pulled", PULLS)
@pytest.mark.parametrize("name", sorted(bends()))
def test_reversals_and_mirrors(name: str, pulled: str) -> None:
    """All strands reversed: charges stay, the Whitney index changes sign. A mirror changes the charges."""
    d = bends()[name].diagram.pulled(pulled)
    here, back, mirrored, flipped = (state(x) for x in (d, d.reverse(), d.mirror(), d.reflected()))
    assert (back.writhe, back.gamma, back.whitney) == (here.writhe, here.gamma, -here.whitney)
    assert (mirrored.writhe, mirrored.gamma, mirrored.whitney) == (-here.writhe, here.gamma, here.whitney)
    assert (flipped.writhe, flipped.gamma, flipped.whitney) == (-here.writhe, here.gamma, -here.whitney)
    assert here.loops == len(d.seifert_circles)


# --- the catalogue against the shared codes


def test_the_catalogue_has_the_shared_codes() -> None:
    published = shared("bends.json")
    assert list(bends()) == list(published)
    for name, row in published.items():
        entry = bends()[name]
        assert to_gauss(entry.diagram) == to_gauss(from_pd(row["pd"], row["boundary_ccw"]))
        assert sorted(entry.diagram.ends) == sorted(row["boundary_ccw"])
        assert list(entry.pulls) == list(PULLS)


@pytest.mark.parametrize("pulled", PULLS)
@pytest.mark.parametrize("name", sorted(bends()))
def test_states_of_bends(name: str, pulled: str) -> None:
    row = shared("bends.json")[name]["pulls"][pulled]
    for drawn in (bends()[name].diagram, from_pd(shared("bends.json")[name]["pd"])):
        found = state(drawn, pulled)
        assert (found.crossings, found.writhe, found.whitney) == (row["N"], row["Wr"], row["Whitney"])
        assert found.tau == pytest.approx(row["tau"], abs=1e-6)
        assert found.gamma == pytest.approx(row["Gamma"], abs=1e-6)
        assert found.gamma_with_outer == pytest.approx(row["Gamma_alt_incl_outer_regions"], abs=1e-6)
        assert found.loops == row["seifert_loops"]


@pytest.mark.parametrize("name", sorted(bends()))
def test_faces_of_bends(name: str) -> None:
    row = shared("bends.json")[name]
    drawn = state(bends()[name].diagram, "A1B1")
    bounded = Counter((f.edges, f.circulation) for f in drawn.faces if f.bounded)
    assert bounded == Counter((len(f["edges"]), f["circulation"]) for f in row["faces"] if f["bounded"])
    assert len(drawn.faces) == len(row["faces"])


@pytest.mark.parametrize("name", sorted(bends()))
def test_closures_and_strands_of_bends(name: str) -> None:
    row = shared("bends.json")[name]
    drawn = bends()[name].diagram
    types = {"AB"[k]: str(one) for k, one in enumerate(identify_strands(drawn))}
    assert types == row["strand_knot_types"]
    published = {frozenset(frozenset(j.split("-")) for j in c["joins"].split()): c for c in row["closures"]}
    for joins, closed in closures(drawn):
        wanted = published.pop(frozenset(map(frozenset, joins)))
        found = identify(closed)
        assert closed.n_strands == (2 if wanted["type"] == "link" else 1)
        if wanted["type"] == "link":
            # The strands run as they do in the file: A and B along their numbers.
            assert found.linking[0][1] == wanted["lk"]
            for component, names in zip(found.components, wanted["components"], strict=True):
                assert set(component.names) <= set(names)
        elif found.names:
            assert found.names[0] in wanted["jones_matches"]
        else:
            assert all(
                int(match.strip("m").split("n")[0].split("_")[0]) > 10 for match in wanted["jones_matches"]
            )
    assert not published


def test_states_and_closures_of_sutures() -> None:
    rows = shared("sutures.json")
    for row in rows:
        drawn = suture_diagram(row["b"], row["t"])
        assert to_gauss(drawn) == row["gauss"]
        for same in (drawn, from_gauss(row["gauss"], closed=False)):
            found = state(same, "A1B1")
            assert (found.crossings, found.writhe, found.whitney) == (row["N"], row["Wr"], row["Whitney"])
            assert found.tau == pytest.approx(row["tau"], abs=1e-6)
            assert found.gamma == row["Gamma"]
            assert sorted([f.edges, f.circulation] for f in found.faces if f.bounded) == sorted(row["faces"])
        names = [identify(closed).names for _, closed in closures(drawn) if closed.n_strands == 1]
        assert names == ([tuple(row["closed_loop_knot"])] if row["closed_loop_knot"] else names)
    assert len(rows) >= 8


def test_the_suture_of_three_and_three_is_the_reef_or_the_granny() -> None:
    for top, name in ((-3, "reef"), (3, "granny")):
        assert is_isomorphic(suture_diagram(3, top), bend_diagram(name))


@pytest.mark.parametrize(("bottom", "top"), [(4, 3), (3, 0), (101, 3)])
def test_a_throw_that_cannot_be(bottom: int, top: int) -> None:
    with pytest.raises(TorsadeError, match="give two odd numbers up to 99"):
        suture_diagram(bottom, top)


# --- the range of Gamma


@pytest.mark.parametrize(
    ("name", "crossings", "least", "greatest", "drawings"),
    [
        ("reef", 6, 8 / 3, 4.0, 9),
        ("thief", 6, 1.0, 2.0, 9),
        ("carrick", 8, 3.0, 3.0, 1),
        ("zeppelin", 10, 5.0, 5.0, 1),
        ("sheet_bend", 6, 13 / 6, 13 / 6, 1),
    ],
)
def test_ranges_of_gamma(name: str, crossings: int, least: float, greatest: float, drawings: int) -> None:
    found = circulation_range(bend_diagram(name))
    assert (found.crossings, found.drawings, found.complete) == (crossings, drawings, True)
    assert (found.least, found.greatest) == pytest.approx((least, greatest))


@pytest.mark.parametrize("pulled", PULLS)
@pytest.mark.parametrize(
    "name", ["reef", "granny", "carrick", "zeppelin", "water_knot", "fisherman", "alpine_butterfly"]
)
def test_ranges_of_gamma_lie_within_the_shared_ones(name: str, pulled: str) -> None:
    """Those come from a search that goes farther, through drawings with more crossings."""
    row = shared("bends.json")[name]["Gamma_over_minimal_diagrams_found"][pulled]
    found = circulation_range(bends()[name].diagram, pulled)
    assert (found.complete, found.crossings) == (True, row["N"])
    assert found.drawings <= row["n"]
    assert row["Gamma_min"] - 1e-3 <= found.least <= found.greatest <= row["Gamma_max"] + 1e-3
    if name in ("reef", "granny", "carrick", "zeppelin"):
        assert (found.least, found.greatest) == pytest.approx((row["Gamma_min"], row["Gamma_max"]), abs=1e-3)


@pytest.mark.parametrize("name", ["reef", "thief", "carrick", "sheet_bend"])
def test_the_range_is_the_same_from_wherever_it_is_begun(name: str) -> None:
    begun = bend_diagram(name)
    ranges = {circulation_range(d) for d in (begun, *swings(begun, begun.n_crossings + 1))}
    assert len(ranges) == 1


# --- swinging ends


@pytest.mark.parametrize("name", ["reef", "granny", "carrick", "sheet_bend", "water_knot"])
def test_what_swung_can_swing_back(name: str) -> None:
    begun = bend_diagram(name)
    form = canonical_form(begun)
    for swung in swings(begun, begun.n_crossings + 2):
        assert swung.genus == 0
        assert form in {canonical_form(back) for back in swings(swung, swung.n_crossings + 6)}


@pytest.mark.parametrize("name", ["overhand", "4_1", "5_2"])
def test_a_knot_in_one_strand_stays_when_its_ends_swing(name: str) -> None:
    """Joined around the outside, whichever way they go."""
    begun = cut(named_diagram("3_1" if name == "overhand" else name))
    knot = identify(close(begun, [("A0", "A1")]))
    for one in swings(begun, 9):
        for two in islice(swings(one, 9), 40):
            assert identify(close(two, [("A0", "A1")])).names == knot.names


def test_a_search_that_is_stopped_says_so() -> None:
    assert not circulation_range(bend_diagram("hunter"), limit=5).complete


def test_a_search_takes_about_as_long_for_large_drawings() -> None:
    """A limit of 20 stands for 4000 crossings drawn; each of these drawings has more than 1000 neighbours."""
    with no_hang():
        found = circulation_range(suture_diagram(11, -11), extra=2, limit=20)
    assert (found.crossings, found.complete) == (22, False)
