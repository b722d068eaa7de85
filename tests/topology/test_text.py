"""Codes as text: what a text is taken for, how large it may be, and what is refused in one sentence."""

from __future__ import annotations

import pytest

from hanging import no_hang
from topology.drawings import closed_knots
from torsade.errors import TorsadeError
from torsade.topology import Diagram, identify, is_isomorphic
from torsade.topology.codes import (
    code_kind,
    from_conway,
    from_gauss,
    from_pd,
    from_text,
    to_conway,
)
from torsade.topology.codes._limits import MOST

TREFOIL = [(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("[(3,2)(21,2)]", "Conway code"),
        ("[(3,2)-(21,2)]", "Conway code"),
        ("[(3,2)1(3,2)]", "Conway code"),
        ("[(3,2,2,2)(21,2)]", "Conway code"),
        ("[(1,5,2,4),(3,1,4,6),(5,3,6,2)]", "PD code"),
        ("[(1,5,2,4),(3,1,4)]", "PD code"),
        ("[(B2,A1,B3,A0), ]", "PD code"),
        ("((1,5,2,4),(3,1,4,6),(5,3,6,2))", "PD code"),
        ("[[1,5,2],[3,1,4,6]]", "PD code"),
        ("O1U2O3U1O2U3", "Gauss code"),
        ("BR[2,{1,1,1}]", "braid word"),
        ("3_1", None),
        ("trefoil", None),
        ("|", None),
    ],
)
def test_what_a_text_is_taken_for(text: str, kind: str | None) -> None:
    assert code_kind(text) == kind


@pytest.mark.parametrize(
    "text",
    [
        "X_{1,5,2,4} X_{3,1,4,6} X_{5,3,6,2}",
        "X_{1,5,2,4}X_{3,1,4,6}X_{5,3,6,2}",
        "PD[X[1, 5, 2, 4], X[3, 1, 4, 6], X[5, 3, 6, 2]]",
        "[(1,5,2,4),(3,1,4,6),(5,3,6,2)]",
        "((1,5,2,4),(3,1,4,6),(5,3,6,2))",
        "{1,1,1}",
        "BR[2,{1,1,1}]",
        "BR(2, [1, 1, 1])",
        "O1+U2+O3+U1+O2+U3+",
        "o1+u2+o3+u1+o2+u3+",
        "O1U2O3U1O2U3",
        "o1 u2, o3 u1 o2 u3",
        "DT: {4,6,2}",
    ],
)
def test_ways_to_write_a_right_handed_trefoil(text: str) -> None:
    assert is_isomorphic(from_text(text), from_pd(TREFOIL))


def test_braids_of_given_width() -> None:
    assert from_text("BR[4,{1}]").circles == 2


def test_a_link_as_two_rows_in_braces() -> None:
    assert is_isomorphic(from_text("DT: {{4,6},{2,8}}"), from_text("DT: [(4,6),(2,8)]"))


@pytest.mark.parametrize(
    ("text", "crossings"),
    [
        ("[12,3,2]", 8),
        ("[12;3;2]", 8),
        ("12 ;3 ;2", 17),
        ("[12 , 3 , 2]", 17),
        ("[12 ;3;2]", 17),
        ("[12 3]", 15),
        ("123", 6),
        ("3;3;2+ + ", 10),
        ("10*", 10),
        ("8*2:.20", 10),
    ],
)
def test_numbers_of_two_digits(text: str, crossings: int) -> None:
    assert from_conway(text).n_crossings == crossings


def test_numbers_of_two_digits_are_written_so_that_they_are_read_back() -> None:
    ring = from_conway("(3;2) 1 1 ;2 ;2")
    assert from_conway(to_conway(ring)).n_crossings == ring.n_crossings
    for code in ("(12 ;2) (3 ;2)", "(3;2 ;2)(2 ;2) 1 2", "(13 ;3 ;2)(15 ;2)"):
        first = from_conway(code)
        assert identify(from_conway(to_conway(first))).names == identify(first).names
        assert from_conway(to_conway(first)).n_crossings == first.n_crossings


@pytest.mark.parametrize("text", ["[12, 3, 2]", "C[21; 3; 2]", "[(3;2) 12]"])
def test_numbers_that_may_be_one_or_two_are_refused(text: str) -> None:
    with pytest.raises(TorsadeError, match="may be one number or several; leave out the spaces or write"):
        from_text(text)


# --- how large


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("braid: 999999999", "the braid word has more than 500 strands"),
        ("braid: 1000000", "more than 500 strands"),
        ("braid: 1 4000", "more than 500 strands"),
        ("BR[999999999,{1}]", "more than 500 strands"),
        ("[1 999999999]", "the Conway code has more than 500 crossings"),
        ("[1 99999]", "more than 500 crossings"),
        ("[1 " + "9" * 5000 + "]", "more than 500 crossings"),
        ("[ 8 83221:2]", "more than 500 crossings"),
        ("[" + "0 " * 4000 + "2]", "more than 500 numbers"),
        ("[3;3;2" + "+" * 4000 + "]", "more than 500 crossings"),
        ("{" + "1," * 4000 + "1}", "the braid word has more than 500 crossings"),
        ("DT: " + " ".join(str(2 * k) for k in range(1, 2000)), "the DT code has more than 500 crossings"),
        ("Gauss: " + " ".join(f"{k} -{k}" for k in range(1, 1000)), "the Gauss code has more than 500 cross"),
        ("O1+ U1+" + "|" * 4000, "the Gauss code has more than 500 strands"),
        (" ".join(f"O{k}U{k}" for k in range(1000)), "the Gauss code has more than 500 crossings"),
        (" ".join(f"X[{k},1,2,3]" for k in range(1000)), "the PD code has more than 500 crossings"),
        ("O" + "1" * 5000 + "+ U1+", "is not understood"),
        ("{" + "1," * 20000 + "1}", "the braid word has 40003 characters; give at most 20000"),
        ("[" + "(" * 5000 + "2" + ")" * 5000 + "]", "more than 50 parentheses within each other"),
        ("[" + "-" * 5000 + "2]", "more than 500 crossings"),
        ("[.2." + "-" * 400 + "²]", "where a tangle is due"),
    ],
)  # fmt: skip
def test_too_large_codes_are_refused_at_once(text: str, says: str) -> None:
    with no_hang(), pytest.raises(TorsadeError) as caught:
        from_text(text)
    assert says in str(caught.value)
    assert len(str(caught.value)) < 400
    assert "\n" not in str(caught.value)


def test_signs_do_not_nest() -> None:
    assert from_text("[" + "-" * 400 + "3]").signs == from_text("[3]").signs
    assert from_text("[" + "-" * 401 + "3]").signs == from_text("[-3]").signs
    assert from_text("[" + "(" * 40 + "3" + ")" * 40 + "]").n_crossings == 3


def test_a_code_of_the_greatest_size_is_read() -> None:
    size: list[Diagram] = [
        from_text("{" + ",".join(["1", "-2"] * (MOST // 2)) + "}"),
        from_text("[" + " ".join(["1"] * MOST) + "]"),
    ]
    assert [d.n_crossings for d in size] == [MOST] * 2


# --- refusals


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[4,6,2]", "'[4,6,2]' may be a DT code or Conway notation; say which with DT: or C before it"),
        ("[4, 8, -12, 2, -14, -16, -6, -10]", "may be a DT code or Conway notation"),
        ("[1,-2,3,-1,2,-3]", "may be a Gauss code or Conway notation; say which with Gauss: or C"),
        ("[1,1,1]", "may be a braid or Conway notation; say which with braid: or C before it"),
        ("[[1,5,2,4],[3,1,4,6],[5,3,6,2.5]]", "the label '2.5' in the PD code is no whole number"),
        ("[[1,5,2,4],[3,1,4,6],[5,3,6,-2]]", "the label '-2' in the PD code is no whole number"),
        ("[[1,5,2,4],[3,1,4,6],[5,3,6,2]", "has a bracket that is not closed"),
        ("X[1,5,2,4] X[3,1,4,6] X[5,3,6,2", "has a bracket that is not closed"),
        ("X[1,5,2,4] X[3,1,4,6] X[5,3,6,2)", "has a ')' that closes no bracket"),
        ("DT: 4,6,2]", "has a ']' that closes no bracket"),
        ("{1,1,1", "has a bracket that is not closed"),
        ("O1+ U2 O3+ U1+ O2+ U3+", "'U2' in the Gauss code is not understood"),
        ("O1 U1 X", "'X' in the Gauss code is not understood"),
        ("BR[2,{1,2}]", "a braid of 2 strands has generators 1 to 1"),
    ],
)
def test_what_cannot_be_read(text: str, says: str) -> None:
    with pytest.raises(TorsadeError) as caught:
        from_text(text)
    assert says in str(caught.value)


def test_lists_that_can_only_be_conway_notation() -> None:
    assert [from_text(code).n_crossings for code in ("[3,3,2]", "[3,3,-2]", "C[4,6,2]", "[2]")] == [
        8,
        8,
        12,
        2,
    ]


def test_counting_passages_of_a_long_code() -> None:
    code = " ".join(f"O{k}+ U{k}+" for k in range(2000))
    with no_hang():
        assert from_gauss(code).n_crossings == 2000


@pytest.mark.parametrize("name", closed_knots())
def test_conway_notation_of_the_tables(name: str) -> None:
    """All 249 in brackets, with semicolons and with commas; the mirror image is left open."""
    code = closed_knots()[name]["conway"]
    for text in (f"[{code}]", f"[{code.replace(';', ',')}]", f"C[{code}]"):
        assert code_kind(text) == "Conway code"
        found = identify(from_text(text)).names[0]
        assert found.removeprefix("m") == name
