"""Names of knots and links, their mirror images and sums, and what is left open."""

from __future__ import annotations

import random
from collections import defaultdict
from functools import reduce
from importlib.resources import files
from itertools import combinations_with_replacement

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from topology.drawing import (
    PD,
    braid,
    closed_bend,
    connected_sum,
    crossings_changed,
    knot_codes,
    mirrored,
    shared,
    turned_round,
    with_bigon,
    with_kink,
)
from topology.drawings import closed_knots
from torsade.errors import TorsadeError
from torsade.topology.codes import from_pd
from torsade.topology.diagram import Diagram
from torsade.topology.identify import identify, identify_pd
from torsade.topology.invariants import oriented
from torsade.topology.links import prime_links
from torsade.topology.lookup import match_knot
from torsade.topology.names import name_order, split_union, sum_name
from torsade.topology.table import contents, entries, link_codes, record
from torsade.topology.tangle import cut

KNOTS = knot_codes()
ENTRIES = {entry.name: entry for entry in entries()}


def drawn(name: str) -> PD:
    """A diagram of a knot of the table, of a mirror image, or of a sum."""
    pds = [mirrored(KNOTS[part[1:]]) if part[0] == "m" else KNOTS[part] for part in name.split("#")]
    return reduce(connected_sum, pds)


def sums_through(crossings: int) -> list[str]:
    """Every sum of two or more knots of the table with at most so many crossings."""
    small = [entry for entry in entries() if entry.crossings <= crossings - 3]
    return [
        sum_name(entry.name for entry in factors)
        for n in (2, 3)
        for factors in combinations_with_replacement(small, n)
        if sum(entry.crossings for entry in factors) <= crossings
    ]


SUMS = sums_through(10)

# --- the table


def test_the_file_is_what_the_codes_give() -> None:
    for name, row in contents()["knots"].items():
        assert record(row["pd"]) == row, name
    size = files("torsade.topology").joinpath("data/knots.json").read_bytes()
    assert len(size) < 100_000


def test_the_codes_are_the_published_ones() -> None:
    """Each with as many crossings as its name says; chirality and names as KnotInfo has them."""
    published = shared("closed.json")
    assert list(KNOTS) == list(published)
    for name, row in published.items():
        assert [list(crossing) for crossing in KNOTS[name]] == row["pd"]
        assert len(KNOTS[name]) == ENTRIES[name].crossings == row["crossing_number"]
        assert ("m" + name in ENTRIES) == row["chiral"]


def test_numbers_of_knots_and_links() -> None:
    """D. Rolfsen, Knots and Links: 1, 1, 2, 3, 7, 21, 49, 165 knots and 1, 0, 1, 1, 6, 9, 29 links."""
    knots = [sum(len(pd) == n for pd in KNOTS.values()) for n in range(3, 11)]
    links = [sum(len(code.crossings) == n for code in link_codes().values()) for n in range(2, 9)]
    assert knots == [1, 1, 2, 3, 7, 21, 49, 165]
    assert links == [1, 0, 1, 1, 6, 9, 29]


def test_coincidences_are_the_ones_documented() -> None:
    """Pairs that polynomials and signature leave together, and that colourings separate (`TIE_BREAKERS`)."""
    coarse, fine = defaultdict(set), set()
    for name in [*ENTRIES, *SUMS]:
        match = [ENTRIES[part] for part in name.split("#")]
        delta, v = match[0].alexander, match[0].jones
        for entry in match[1:]:
            delta, v = delta * entry.alexander, v * entry.jones
        coarse[delta, v, sum(entry.signature for entry in match)].add(name)
        fine.add(identify_pd(drawn(name)).names)
    pairs = """
        8_8 m10_129, m8_8 10_129, 8_16 10_156, m8_16 m10_156, 9_12 4_1#5_2, m9_12 4_1#m5_2, 10_25 10_56,
        m10_25 m10_56, 10_40 10_103, m10_40 m10_103, 10_48 m10_48, 10_71 m10_71, 10_91 m10_91,
        10_104 m10_104
    """
    alike = {frozenset(names) for names in coarse.values() if len(names) > 1}
    assert alike == {frozenset(pair.split()) for pair in pairs.split(",")}
    assert len(fine) == len(ENTRIES) + len(SUMS) == 478 + 78


# --- knots


@pytest.mark.parametrize("name", ENTRIES)
def test_knots_of_the_table(name: str) -> None:
    found = identify_pd(drawn(name))
    assert (found.names, found.certain, found.reason, found.factors) == ((name,), True, "", (name,))
    assert (found.components, found.linking) == ((), ())
    assert (
        identify_pd(turned_round(crossings_changed(drawn(name)))).names
        == identify_pd(mirrored(drawn(name))).names
    )


def test_braids_have_the_names_of_their_codes() -> None:
    """All 249, right mirror image included; certain exactly where the diagram has 10 crossings or fewer."""
    for name, row in closed_knots().items():
        for word in row["braids"]:
            found = identify_pd(*braid(word))
            assert found.names == (name,)
            assert found.certain == (not found.reason)
            assert found.certain or len(word) > 10


@pytest.mark.parametrize("name", SUMS)
def test_sums(name: str) -> None:
    """Taken apart where the diagram shows the sum; matched as a whole where it is not taken apart."""
    pd = drawn(name)
    found = identify_pd(pd)
    assert (found.names, found.certain, found.reason) == ((name,), True, "")
    assert found.factors == tuple(name.split("#"))
    match = match_knot(oriented(pd))
    assert (match.names, match.certain) == ((name,), True)
    assert match.reason == f"{name} is known by its invariants, the diagram does not show the sum"


@pytest.mark.parametrize("word", [[1], [-1, 2], [1, -1, 1], [1, 2, -3], [1, -2, 3, -4, 5, -6]])
def test_unknots(word: list[int]) -> None:
    found = identify_pd(*braid(word))
    assert (found.names, found.certain, found.factors) == (("0_1",), True, ())


def test_an_unknot_of_many_crossings_is_certain() -> None:
    """Jones polynomial 1 is enough for so few."""
    rng = random.Random(3)
    pd: PD = braid([1, -2])[0]
    for _ in range(6):
        pd = [tuple(row) for row in oriented(with_bigon(pd, rng)).crossings]  # type: ignore[misc]
    assert len(pd) == 14
    assert identify_pd(pd).names == ("0_1",)
    assert identify_pd(pd).certain


def test_a_knot_beyond_the_table() -> None:
    """12n_328, the closed hunter's bend: no name, and a reason."""
    hunter = shared("bends.json")["hunter"]
    found = identify_pd(closed_bend(hunter["pd"], "B1-A1 A0-B0"))
    assert (found.names, found.certain, found.factors) == ((), False, ())
    assert found.reason.startswith("none of the prime knots through 10 crossings")
    assert str(found) == "unknown"


def test_a_diagram_that_is_too_wide_has_no_name() -> None:
    """The torus knot T(13, 14): no error, and the reason says what to do."""
    found = identify_pd(*braid(list(range(1, 13)) * 14))
    assert (found.names, found.certain) == ((), False)
    assert found.reason.endswith("simplify it first")


def test_torus_knots_beyond_the_table() -> None:
    assert identify_pd(*braid([1] * 11)).names == ()
    assert identify_pd(*braid([1, 2, 3] * 5)).names == ()


def test_a_name_that_more_crossings_leave_open() -> None:
    """10_139 in 12 crossings may be another knot of its invariants, and the result says so."""
    pd = [tuple(row) for row in oriented(with_bigon(drawn("10_139"), random.Random(5))).crossings]
    found = identify_pd(pd)
    assert (found.names, found.certain) == (("10_139",), False)
    assert "the diagram has 12 crossings, and a knot beyond the table may share them" in found.reason


@settings(deadline=None, max_examples=40)
@given(st.sampled_from(list(ENTRIES)), st.integers(0, 10**6))
def test_kinks_come_off_by_themselves(name: str, seed: int) -> None:
    rng = random.Random(seed)
    pd = drawn(name)
    for _ in range(3):
        pd = [tuple(row) for row in oriented(with_kink(pd, rng)).crossings]  # type: ignore[misc]
    found = identify_pd(pd)
    assert (found.names, found.certain) == ((name,), True)


@settings(deadline=None, max_examples=40)
@given(st.sampled_from(list(ENTRIES)), st.integers(0, 10**6))
def test_a_bigon_leaves_the_name(name: str, seed: int) -> None:
    pd = with_bigon(drawn(name), random.Random(seed))
    assert identify_pd(pd).names == (name,)


# --- bends and sutures


@pytest.mark.parametrize(
    ("bend", "joins", "name", "certain"),
    [
        ("reef", "B0-B1 A1-A0", "0_1 ⊔ 0_1", True),
        ("reef", "B1-A1 A0-B0", "3_1#m3_1", True),
        ("granny", "B1-A1 A0-B0", "m3_1#m3_1", True),
        ("sheet_bend", "B1-B0 A0-A1", "L2a1", True),
        ("sheet_bend", "B0-A0 A1-B1", "m6_2", True),
        ("carrick", "A1-A0 B1-B0", "mL8a8", True),
        ("carrick", "A0-B1 B0-A1", "8_18", True),
        ("zeppelin", "B0-A1 A0-B1", "3_1#m3_1", False),
        ("zeppelin_min10", "A0-B1 B0-A1", "3_1#m3_1", True),
        ("alpine_butterfly", "B1-A1 A0-B0", "0_1", True),
        ("figure_eight_bend", "B1-A0 A1-B0", "0_1", True),
        ("double_fisherman", "A0-B1 B0-A1", "0_1", True),
    ],
)
def test_closed_bends(bend: str, joins: str, name: str, certain: bool) -> None:
    """As the shared codes have them, from Jones polynomials and hyperbolic volumes."""
    found = identify_pd(closed_bend(shared("bends.json")[bend]["pd"], joins))
    assert (found.names, found.certain) == ((name,), certain)


def test_components_of_closed_bends() -> None:
    for bend in shared("bends.json").values():
        for closure in bend["closures"]:
            if closure["type"] == "link":
                found = identify_pd(closed_bend(bend["pd"], closure["joins"]))
                assert found.linking[0][1] == closure["lk"]
                for component, published in zip(found.components, closure["components"], strict=True):
                    (name,) = component.names
                    assert name in published


def test_sutures() -> None:
    """Stacked braids (b, t), closed, are sums of torus knots of opposite sign to the braids."""
    for row in shared("sutures.json"):
        if row["closed_loop_knot"]:
            pds = [braid([-1 if n > 0 else 1] * abs(n))[0] for n in (row["b"], row["t"])]
            assert list(identify_pd(connected_sum(*pds)).names) == row["closed_loop_knot"]


# --- another program


def test_names_agree_with_snappy() -> None:
    """Complements of hyperbolic knots are those of SnapPy's census under the same name.

    There 10_83 and 10_86 change places, and from 10_162 on numbers are one higher (Perko's pair).
    """
    snappy = pytest.importorskip("snappy")
    numbers = {"10_83": "10_86", "10_86": "10_83"} | {f"10_{k}": f"10_{k + 1}" for k in range(162, 166)}
    for name, pd in KNOTS.items():
        complement = snappy.Link(pd).exterior()
        if complement.volume() > 1:
            assert complement.is_isometric_to(snappy.Manifold(numbers.get(name, name))), name


# --- links


def test_links_that_are_their_own_mirror_images() -> None:
    """SnapPy finds isometries for the hyperbolic ones; L2a1 is plain, L8n8 has both strands doubled."""
    names = {link.name for link in prime_links()}
    own = {name for name in link_codes() if "m" + name not in names}
    assert own == {"L2a1", "L6a2", "L6a4", "L8a9", "L8a19", "L8a20", "L8n8"}


@pytest.mark.parametrize("name", list(link_codes()))
def test_links_of_the_table(name: str) -> None:
    code = link_codes()[name]
    found = identify_pd(code)
    assert (found.names, found.certain, found.reason) == ((name,), True, "")
    image = "m" + name if "m" + name in {link.name for link in prime_links()} else name
    assert identify_pd(code.mirrored()).names == (image,)
    assert found.linking == code.linking


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ([1, 1], "L2a1"),
        ([-1, -1], "L2a1"),
        ([1] * 4, "L4a1"),
        ([-1] * 4, "mL4a1"),
        ([1, -2] * 3, "L6a4"),
        ([1, 2] * 3, "L6n1"),
        ([2, 1, 3, 2] * 2, "L8n8"),
        ([1, 1, 2, 2], "L2a1#L2a1"),
        ([1, 1, 1, 2, 2], "3_1#L2a1"),
        ([1, 1, 1, -2, -2, -2, 3, 3], "3_1#m3_1#L2a1"),
        ([1, -1], "0_1 ⊔ 0_1"),
        ([1, 1, 1, 3, 3, 3], "3_1 ⊔ 3_1"),
        ([3, 3, 1, -1], "0_1 ⊔ 0_1 ⊔ L2a1"),
    ],
)
def test_small_links(word: list[int], name: str) -> None:
    found = identify_pd(*braid(word))
    assert (found.names, found.certain) == ((name,), True)


@settings(deadline=None, max_examples=60)
@given(st.sampled_from(list(link_codes())), st.data())
def test_orientation_of_components_leaves_the_name(name: str, data: st.DataObject) -> None:
    """Turning some components round changes Jones polynomial and signature, not what is compared."""
    code = link_codes()[name]
    turned = data.draw(st.sets(st.integers(0, code.n_components - 1)))
    owner = {edge: k for k, edges in enumerate(code.components) for edge in edges}
    # Labels that fall along the components that are turned keep the direction of those always over.
    rows = [
        tuple(
            -x - 1 if owner[x] in turned else x
            for x in (row[2:] + row[:2] if owner[row[0]] in turned else row)
        )
        for row in code.crossings
    ]
    assert identify_pd(rows).names == (name,)


def test_circles_and_pieces() -> None:
    assert identify_pd([], 1).names == ("0_1",)
    assert identify_pd([], 3).names == ("0_1 ⊔ 0_1 ⊔ 0_1",)
    apart = [*drawn("m8_19"), *(tuple(x + 100 for x in row) for row in drawn("3_1#4_1"))]
    found = identify_pd(apart, 1)
    assert (found.names, found.certain) == (("0_1 ⊔ 3_1#4_1 ⊔ m8_19",), True)
    assert found.factors == ("3_1", "4_1", "m8_19")
    assert sorted(str(component) for component in found.components) == ["0_1", "3_1#4_1", "m8_19"]


def test_a_link_beyond_the_table() -> None:
    found = identify_pd(*braid([1] * 10))
    assert (found.names, found.certain) == ((), False)
    assert (
        found.reason
        == "none of the links through 8 crossings has the invariants of this diagram of 10 crossings"
    )
    assert found.linking == ((0, 5), (5, 0))


# --- names, interface, errors, speed


def test_names_are_in_the_order_of_the_tables() -> None:
    names = ["m3_1", "10_2", "L2a1", "3_1", "9_42", "mL4a1", "L4a1", "4_1", "L6n1", "L6a3"]
    ordered = ["3_1", "m3_1", "4_1", "9_42", "10_2", "L2a1", "L4a1", "mL4a1", "L6a3", "L6n1"]
    assert sorted(names, key=name_order) == ordered
    assert sum_name(["m5_1", "0_1", "4_1#m3_1", "3_1"]) == "3_1#m3_1#4_1#m5_1"
    assert sum_name([]) == "0_1"
    assert split_union(["m3_1", "3_1#4_1", "0_1"]) == "0_1 ⊔ 3_1#4_1 ⊔ m3_1"


def test_diagrams_and_codes_have_one_name() -> None:
    from_code = from_pd(KNOTS["8_19"])
    assert identify(from_code).names == ("8_19",)
    assert identify(from_code | Diagram.circle()).names == ("0_1 ⊔ 8_19",)
    assert identify(Diagram.circle()).names == ("0_1",)
    with pytest.raises(TorsadeError, match="the diagram has ends"):
        identify(cut(from_code))


def test_nothing_is_refused() -> None:
    with pytest.raises(TorsadeError, match="the diagram is empty"):
        identify_pd([])
