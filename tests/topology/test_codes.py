"""Codes in and out: what goes in comes out, bad codes are refused in one sentence, and the tables agree."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import permutations, product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from topology.drawings import closed_knots, needs_knots, scrambled, table
from topology.invariants import colourings, determinant, signature
from torsade.errors import TorsadeError
from torsade.knots.bends import bends
from torsade.topology import Diagram, canonical_form, is_isomorphic, pull_choices
from torsade.topology.codes import (
    from_braid,
    from_dt,
    from_gauss,
    from_pd,
    to_braid,
    to_dt,
    to_gauss,
    to_open_pd,
    to_pd,
    to_unsigned_gauss,
)
from torsade.topology.seifert import turning
from torsade.topology.tangle import integer

CLOSED = closed_knots()
BENDS = table("bends.json")
SUTURES = table("sutures.json") or []

words = st.integers(2, 5).flatmap(
    lambda n: st.lists(st.integers(1 - n, n - 1).filter(bool), min_size=1, max_size=12)
)


def mirrors(diagram: Diagram) -> list[Diagram]:
    """The drawing and its mirror images, on either side of the plane."""
    return [diagram, diagram.mirror(), diagram.reflected(), diagram.mirror().reflected()]


# --- the table of closed knots


@pytest.mark.parametrize("name", CLOSED)
def test_codes_of_closed_knots(name: str) -> None:
    """PD, DT, braid and Gauss codes of KnotInfo, all 249 knots through ten crossings.

    Its DT codes of 9_6, 9_9, 9_18, 10_24 and 10_25 are other drawings than its PD codes, of the same knots.
    """
    entry: dict[str, Any] = CLOSED[name]
    pd, dt, gauss = from_pd(entry["pd"]), from_dt(entry["dt"]), from_gauss(entry["gauss"])
    braid = from_braid(entry["braids"][0])
    assert to_pd(pd) == [tuple(row) for row in entry["pd"]]
    assert to_unsigned_gauss(pd) == to_unsigned_gauss(gauss) == [entry["gauss"]]
    assert to_dt(dt) in (entry["dt"], [-k for k in entry["dt"]])
    assert any(is_isomorphic(pd, d) for d in mirrors(gauss))
    if name not in ("9_6", "9_9", "9_18", "10_24", "10_25"):
        assert any(is_isomorphic(pd, d, unoriented=True) for d in mirrors(dt))
    for p in (3, 5, 7):
        assert colourings(pd, p) == colourings(dt, p) == colourings(gauss, p) == colourings(braid, p)
    word = to_braid(pd)
    assert max(map(abs, word)) + 1 == len(pd.seifert_circles)
    assert is_isomorphic(from_braid(to_braid(braid)), braid)
    assert determinant(pd) == determinant(dt) == determinant(braid) == determinant(from_braid(word))
    assert signature(from_braid(word)) == signature(pd)
    assert signature(pd) == signature(braid) == entry["signature"]
    assert abs(signature(dt)) == abs(signature(gauss)) == abs(signature(pd))
    assert pd.is_alternating == entry["alternating"]
    assert pd.n_crossings == dt.n_crossings == gauss.n_crossings == entry["crossing_number"]


# --- bends and sutures


@needs_knots
@pytest.mark.parametrize("name", BENDS)
def test_codes_of_bends(name: str) -> None:
    entry: dict[str, Any] = BENDS[name]
    d = from_pd(entry["pd"])
    k = entry["boundary_ccw"].index("A0")
    assert list(d.ends) == entry["boundary_ccw"][k:] + entry["boundary_ccw"][:k]
    assert list(from_pd(entry["pd"], entry["boundary_ccw"]).ends) == entry["boundary_ccw"]
    assert d.signs == tuple(entry["signs"].values())
    for k, strand in enumerate(entry["strands"].values()):
        assert [(q >> 2) + 1 for q in d.strands[k]] == [c for c, _ in strand]
        assert ["UO"[q & 1] for q in d.strands[k]] == [level for _, level in strand]
    assert to_gauss(d) == entry["gauss"]
    assert [list(row) for row in to_open_pd(d)] == entry["pd"]
    assert canonical_form(from_gauss(entry["gauss"], closed=False)) == canonical_form(d)


def named_faces(d: Diagram) -> dict[frozenset[str], int]:
    return {
        frozenset(("+" if d.is_tail(p) else "-") + d.edge_name(d.edge_at[p]) for p in face): f
        for f, face in enumerate(d.faces)
    }


@needs_knots
@pytest.mark.parametrize("name", BENDS)
def test_faces_of_bends(name: str) -> None:
    entry: dict[str, Any] = BENDS[name]
    d = from_pd(entry["pd"])
    faces = named_faces(d)
    assert len(faces) == len(d.faces) == len(entry["faces"])
    for face in entry["faces"]:
        f = faces[frozenset(face["edges"])]
        assert d.is_bounded(f) == face["bounded"]
        if face["bounded"]:
            assert d.circulation(f) == face["circulation"]


@needs_knots
@pytest.mark.parametrize("name", BENDS)
def test_pulled_bends(name: str) -> None:
    d = from_pd(BENDS[name]["pd"])
    for pulled, state in BENDS[name]["pulls"].items():
        p = d.pulled(pulled)
        assert (p.n_crossings, p.writhe) == (state["N"], state["Wr"])
        assert len(p.seifert_circles) == state["seifert_loops"]
        assert sum(turning(p, loop) for loop in p.seifert_circles) == state["Whitney"]
        own = [s for s, (i, j) in zip(p.signs, p.strands_at, strict=True) if i == j]
        assert (len(own), sum(own)) == (state["N_self"], state["Wr_self"])
        faces = [f for f in range(len(p.faces)) if p.is_bounded(f)]
        assert sum(abs(p.circulation(f)) / len(p.faces[f]) for f in faces) == pytest.approx(
            state["Gamma"], abs=1e-3
        )


@needs_knots
@pytest.mark.parametrize("entry", SUTURES, ids=lambda e: f"{e['b']},{e['t']}")
def test_sutures(entry: dict[str, Any]) -> None:
    d = from_gauss(entry["gauss"], closed=False)
    assert to_gauss(d) == entry["gauss"]
    assert (d.n_crossings, d.writhe) == (entry["N"], entry["Wr"])
    bounded = [f for f in range(len(d.faces)) if d.is_bounded(f)]
    assert sorted([len(d.faces[f]), d.circulation(f)] for f in bounded) == sorted(entry["faces"])
    assert canonical_form(from_pd(to_open_pd(d))) == canonical_form(d)


# --- there and back


@settings(deadline=None)
@given(words)
def test_braids_there_and_back(word: list[int]) -> None:
    d = from_braid(word)
    assert d.genus == 0
    assert d.signs == tuple(1 if i > 0 else -1 for i in word)
    assert len(d.seifert_circles) == max(map(abs, word)) + 1
    assert canonical_form(from_gauss(to_gauss(d))) == canonical_form(d)
    if not d.circles:
        assert to_pd(from_pd(to_pd(d))) == to_pd(d)
        above = any(
            all(q & 1 for q in strand) for strand in d.strands
        )  # a PD code may not show its direction
        assert is_isomorphic(from_pd(to_pd(d)), d, unoriented=above)


@settings(deadline=None, max_examples=60)
@given(st.sampled_from([[1, 1, 1], [1, -2, 1, -2], [1, 1], [1, -2, 1, -2, 1, -2]]), st.integers(0, 10**6))
def test_scrambled_drawings_there_and_back(word: list[int], seed: int) -> None:
    d = scrambled(from_braid(word), 18, random.Random(seed))
    form = canonical_form(d)
    assert canonical_form(from_gauss(to_gauss(d))) == form
    assert is_isomorphic(from_pd(to_pd(d, first=0)), d, unoriented=True)
    gauss, dt = from_gauss(to_unsigned_gauss(d)), from_dt(to_dt(d))
    assert gauss.genus == dt.genus == 0
    assert to_unsigned_gauss(gauss) == to_unsigned_gauss(d)
    assert to_dt(dt) == to_dt(d)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_tangles_there_and_back(seed: int) -> None:
    reef = from_gauss("O1+ U2+ O3+ O4- U5- O6- | U3+ O2+ U1+ U6- O5- U4-", closed=False)
    d = scrambled(reef, 16, random.Random(seed))
    form = canonical_form(d)
    assert canonical_form(from_pd(to_open_pd(d), d.ends)) == form
    assert canonical_form(from_gauss(to_gauss(d), closed=False, boundary=d.ends)) == form


@pytest.mark.parametrize("name", bends())
def test_bends_keep_the_names_of_their_ends_however_they_are_pulled(name: str) -> None:
    for choice in pull_choices(bends()[name].diagram):
        d = bends()[name].diagram.pulled(choice)
        again = from_pd(to_open_pd(d)), from_gauss(to_gauss(d), closed=False)
        bounded = (
            from_pd(to_open_pd(d), d.ends),
            from_gauss(to_gauss(d), closed=False, boundary=d.ends),
        )
        for read in again + bounded:
            assert canonical_form(read.pulled(choice)) == canonical_form(d)


def test_strands_in_any_order_keep_the_names_of_their_ends() -> None:
    """A knot beside them, and more of them than there are letters; other names are not kept."""
    clasp = integer(3) | from_braid([1, 1, 1])
    later = replace(clasp, starts=(clasp.starts[2], clasp.starts[1], clasp.starts[0]))
    for d in (clasp, later, later.reverse([1])):
        again = from_pd(to_open_pd(d), d.ends)
        assert canonical_form(again.pulled("A1B1")) == canonical_form(d.pulled("A1B1"))
    n = 30
    row = from_gauss(
        " | ".join(f"O{k}+ U{k + 1}+" for k in range(n)).replace("O0+ ", "").replace(f" U{n}+", ""),
        closed=False,
    )
    assert canonical_form(from_pd(to_open_pd(row), row.ends)) == canonical_form(row)
    other = integer(3).renamed(["NW", "SW", "SE", "NE"])
    assert sorted(from_pd(to_open_pd(other)).ends) == ["A0", "A1", "B0", "B1"]


def test_a_prime_drawing_is_found_again_from_its_shadow() -> None:
    """Signs found from planarity alone, for a link of three strands and a knot of sixteen crossings."""
    for d in (from_braid([1, -2] * 3), from_braid([1, -2] * 8)):
        found = from_gauss(to_unsigned_gauss(d))
        assert any(is_isomorphic(found, m) for m in mirrors(d))
        assert any(is_isomorphic(from_dt(to_dt(d)), m, unoriented=True) for m in mirrors(d))


@pytest.mark.parametrize(("n", "impossible"), [(3, 0), (4, 0), (5, 7)])
def test_signs_are_found_exactly_where_there_are_some(n: int, impossible: int) -> None:
    """Against brute force: all DT codes of n crossings, and all signs for each."""
    refused = 0
    for entries in permutations(range(2, 2 * n + 1, 2)):
        at = {c: (2 * c + 1, entries[c]) for c in range(n)}
        visits = sorted(
            (label, c, level) for c, two in at.items() for label, level in zip(two, "UO", strict=True)
        )

        def signed(signs: tuple[str, ...], visits: list[tuple[int, int, str]] = visits) -> str:
            return " ".join(f"{level}{c}{signs[c]}" for _, c, level in visits)

        def succeeds(read: Any, code: Any) -> bool:
            try:
                read(code)
            except TorsadeError:
                return False
            return True

        possible = any(succeeds(from_gauss, signed(signs)) for signs in product("+-", repeat=n))
        assert succeeds(from_dt, list(entries)) == possible
        refused += not possible
    assert refused == impossible


def test_conventions() -> None:
    """[1, 1, 1] is the right-handed trefoil; so is the first drawing of what leaves the choice open."""
    assert from_braid([1, 1, 1]).signs == from_dt([4, 6, 2]).signs == from_gauss([1, -2, 3, -1, 2, -3]).signs
    assert signature(from_braid([1, 1, 1])) == -2
    assert to_dt(from_dt([-4, -6, -2])) == [4, 6, 2]
    assert to_unsigned_gauss(from_dt([4, 6, 2])) == [[1, -2, 3, -1, 2, -3]]


def test_circles_in_codes() -> None:
    assert from_pd([]) == from_gauss("") == Diagram.circle()
    assert to_pd(Diagram.circle()) == to_braid(Diagram.circle()) == []
    assert to_braid(from_gauss("O1- U1-")) == [-1]
    assert from_braid([], 3).circles == 3
    assert from_braid([1], 3).circles == 1
    assert from_gauss("O1+ U1+ | ").circles == 1
    assert to_gauss(from_gauss("O1+ U1+ | ")) == "O1+ U1+ | "
    code = to_pd(from_braid([1, 1], 3))
    assert len(code) == 3  # the circle has been given a kink
    assert from_pd(code).n_strands == 3
    arc = from_gauss(" | O1+ U1+", closed=(False, True))
    assert (arc.ends, arc.n_strands, arc.n_crossings) == (("A0", "A1"), 2, 1)


def test_a_strand_above_all_runs_towards_larger_labels() -> None:
    above = from_gauss("O1+ O2- O3+ O4- | U1+ U2- U3+ U4-")
    assert to_gauss(from_pd(to_pd(above))) == to_gauss(above)


def test_separate_pieces_of_a_tangle_follow_one_another() -> None:
    d = from_gauss("O1+ U1+ | O2+ U2+", closed=False)
    assert d.ends == ("A0", "A1", "B0", "B1")
    nested = from_gauss("O1+ U1+ | O2+ U2+", closed=False, boundary=["A0", "B0", "B1", "A1"])
    assert nested.genus == 0
    assert canonical_form(nested) != canonical_form(d)


@settings(deadline=None, max_examples=30)
@given(st.sampled_from([[1, 1, 1], [1, -2, 1, -2], [1, 1], [1, -2, 1, -2, 1, -2]]), st.integers(0, 10**6))
def test_every_drawing_is_a_closed_braid(word: list[int], seed: int) -> None:
    d = scrambled(from_braid(word), 14, random.Random(seed))
    closed = from_braid(to_braid(d))
    assert closed.n_strands == d.n_strands
    assert len(closed.seifert_circles) == len(d.seifert_circles)
    assert (determinant(closed), signature(closed)) == (determinant(d), signature(d))
    assert sorted(closed.linking.ravel()) == sorted(d.linking.ravel())


# --- refusals


@pytest.mark.parametrize(
    ("read", "code", "says"),
    [
        (from_pd, [(1, 5, 2)], r"crossing 0 of the PD code has 3 labels, \[1, 5, 2\]; give four"),
        (from_pd, [(1, 1, 2, 1), (2, 3, 4, 3)], "label 1 occurs 3 times in the PD code; give each edge"),
        (from_pd, [(1, "?", 2, 4)], "label '\\?' of the PD code is not understood; give integers, or names"),
        (from_pd, [(2, 4, 1, 5), (3, 1, 4, 6), (5, 3, 6, 2)], "does not begin with its incoming lower edge"),
        (from_pd, [(1, 4, 2, 3), (2, 3, 1, 4)], "cannot be drawn in the plane: its graph needs"),
        (from_gauss, "O1+ X2+", "'X2\\+' in the Gauss code is not understood; give passages such as"),
        (from_gauss, "O1+ U1-", "crossing 1 of the Gauss code has both signs; give it the same one twice"),
        (from_gauss, "O1+ O1+", "crossing 1 of the Gauss code is passed 2 times above and 0 times below"),
        (from_gauss, "O1+ U1+ O2+", "crossing 2 of the Gauss code is passed 1 times above and 0 times below"),
        (from_gauss, "O1+ U2+ O3- U1+ O2+ U3-", "the Gauss code cannot be drawn in the plane"),
        (from_gauss, [1, -2, -1, 2], "cannot be drawn in the plane: strands would have to cross"),
        (from_gauss, [[1], [-1]], "the Gauss code cannot be drawn in the plane"),
        (from_gauss, [1, 2, -1], "crossing 2 of the Gauss code is passed 0 times above and 1 times below"),
        (from_dt, [4, 5, 2], "the DT code has the odd entry 5; give the even label"),
        (from_dt, [4, 4, 2], r"the DT code \[4, 4, 2\] does not have each of 2, 4 ... 6 once"),
        (from_dt, [4, 8, 2], "does not have each of 2, 4 ... 6 once"),
        (from_dt, [4, 6, 8, 10, 2], "the DT code cannot be drawn in the plane"),
        (from_braid, [], "the braid word is empty; give nonzero integers, or the number of strands"),
        (from_braid, [1, 0], "has an entry that is no generator; give nonzero integers"),
    ],
)  # fmt: skip
def test_bad_codes_are_refused(read: Any, code: Any, says: str) -> None:
    with pytest.raises(TorsadeError, match=says) as caught:
        read(code)
    assert "\n" not in str(caught.value)


def test_bad_options_are_refused() -> None:
    with pytest.raises(TorsadeError, match="a braid of 2 strands has generators 1 to 1"):
        from_braid([1, 2], 2)
    with pytest.raises(TorsadeError, match="1 strands have 2 closed flags"):
        from_gauss("O1+ U1+", closed=(True, False))
    with pytest.raises(TorsadeError, match="an unsigned Gauss code is given for open strands"):
        from_gauss([1, -1], closed=False)
    with pytest.raises(
        TorsadeError, match=r"the boundary is \['A0'\]; give each of the ends \['A0', 'A1'\] once"
    ):
        from_gauss("O1+ U1+", closed=False, boundary=["A0"])
    crossed = ["A0", "B0", "A1", "B1"]
    with pytest.raises(TorsadeError, match="cannot be drawn in the plane with ends A0 B0 A1 B1 around it"):
        from_gauss("O1+ U1+ | O2+ U2+", closed=False, boundary=crossed)
    with pytest.raises(TorsadeError, match="has ends A0 A1"):
        to_pd(from_gauss("O1+ U1+", closed=False))
    with pytest.raises(TorsadeError, match="a DT code is for closed strands"):
        to_dt(from_gauss("O1+ U1+", closed=False))
    with pytest.raises(TorsadeError, match="no DT code shows"):
        to_dt(from_braid([1], 3))
    with pytest.raises(TorsadeError, match="a braid word is of a connected closed diagram"):
        to_braid(from_braid([1], 3))
