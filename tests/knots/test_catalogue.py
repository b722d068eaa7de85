"""The catalogue: names, what they find, what is near them, and the files that it comes from."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from topology.drawing import shared
from torsade import TorsadeError, knots
from torsade.knots.bends import bends
from torsade.knots.entries import entries
from torsade.topology import from_text, identify, is_isomorphic, named_diagram, state
from torsade.topology.codes import from_braid, from_conway, from_dt, to_gauss
from torsade.topology.tangle import close


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("reef", ("reef", "bend", "A1B1")),
        (" Reef Knot", ("reef", "bend", "A1B1")),
        ("square knot", ("reef", "bend", "A1B1")),
        ("thief", ("thief", "bend", "A1B0")),
        ("Thief-knot", ("thief", "bend", "A1B0")),
        ("bread bag knot", ("thief", "bend", "A1B0")),
        ("what knot", ("grief", "bend", "A1B0")),
        ("Carrick bend", ("carrick", "bend", "A1B1")),
        ("carrick mat", ("8_18", "closed", None)),
        ("Hunter's bend", ("hunter", "bend", "A1B1")),
        ("riggers bend", ("hunter", "bend", "A1B1")),
        ("alpine butterfly bend", ("alpine_butterfly", "bend", "A1B1")),
        ("ABOK 1452", ("ashley", "bend", "A1B1")),
        ("grapevine", ("double_fisherman", "bend", "A1B1")),
        ("ring bend", ("water_knot", "bend", "A1B1")),
        ("flemish bend", ("figure_eight_bend", "bend", "A1B1")),
        ("figure-eight bend", ("figure_eight_bend", "bend", "A1B1")),
        ("figure-eight", ("figure-eight", "strand", "A0A1")),
        ("figure eight knot", ("figure-eight", "strand", "A0A1")),
        ("figure_eight", ("figure-eight", "strand", "A0A1")),
        ("Stevedore", ("stevedore", "strand", "A0A1")),
        ("overhand", ("overhand", "strand", "A0A1")),
        ("surgeon's knot", ("5,-3", "suture", "A1B1")),
        ("(3, -7)", ("3,-7", "suture", "A1B1")),
        ("trefoil knot", ("3_1", "closed", None)),
        ("unknot", ("0_1", "closed", None)),
        ("whitehead link", ("L5a1", "link", None)),
        ("Borromean rings", ("L6a4", "link", None)),
        ("T(3,4)", ("T(3,4)", "torus", None)),
        ("t(-2, 5)", ("T(2,-5)", "torus", None)),
        ("bowline23", ("bowline23", "variant", "A1B0")),
    ],
)
def test_names(name: str, found: tuple[str, str, str | None]) -> None:
    entry = knots.find(name)
    assert (entry.name, entry.kind, entry.pulled) == found


def test_every_name_and_alias_finds_its_entry() -> None:
    """What comes first in `find` has a name that two kinds share: figure-eight is the knot in one strand."""
    names = [entry.name for entry in entries()]
    assert len(names) == len(set(names))
    shared_words = {"figure-eight"}
    for entry in entries():
        for word in {entry.name, entry.name.upper(), *entry.aliases} - shared_words:
            assert knots.find(word) == entry, word


def test_how_many_there_are() -> None:
    counts = {kind: len(knots.search(kind=kind)) for kind in knots.KINDS}
    assert counts["closed"] == 1 + 249
    assert counts["suture"] == 24
    assert counts["link"] == 47
    assert len(bends()) == 13
    assert len(knots.variants()) == 22
    assert knots.search() == entries()


def test_search_by_part_of_a_name_or_alias() -> None:
    assert [entry.name for entry in knots.search("butterfly")] == ["alpine_butterfly", *_labels("alpine")]
    assert "5,-3" in [entry.name for entry in knots.search("surgeon")]
    assert [entry.name for entry in knots.search("GRAPEVINE")] == ["double_fisherman"]
    assert knots.search("grapevine", kind="closed") == ()
    with pytest.raises(TorsadeError, match="there is no kind 'bends'; choose one of bend, strand"):
        knots.search(kind="bends")


def _labels(begin: str) -> list[str]:
    return [label for label in knots.variants() if label.startswith(begin)]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("zepelin", "did you mean 'zeppelin'"),
        ("grany", "did you mean 'granny'"),
        ("figur eight bend", "did you mean 'figure eight bend'"),
        ("", "nothing is called ''"),
        ("10_166", "10_161 and 10_162 of older tables are one knot"),
        ("3_2", "no knot or link is called '3_2'; known are the prime knots through 10 crossings"),
        ("3_1#3_7", "no knot or link is called '3_7' in '3_1#3_7'"),
        ("T(0,3)", "give T\\(p,q\\) with p and q not 0"),
        ("T(99,99)", "fewer than 1000 crossings"),
        ("overhand-4", "give an odd number from 3 to 99"),
        ("open reef", "'reef' is not a closed knot"),
        ("4,2", "give two odd numbers"),
    ],
)
def test_names_that_nothing_has(name: str, says: str) -> None:
    with pytest.raises(TorsadeError, match=says) as caught:
        knots.find(name).diagram  # noqa: B018
    assert "\n" not in str(caught.value)


@given(st.text(max_size=30))
def test_any_text_finds_something_or_is_refused(text: str) -> None:
    said = ""
    try:
        said = knots.interpret(text).title
    except TorsadeError as error:
        said = str(error)
    assert said
    assert "\n" not in said


@pytest.mark.parametrize("name", ["reef", "hunter", "overhand", "3_1", "L5a1", "5,-3", "T(3,4)", "alpine24"])
def test_mirror_images(name: str) -> None:
    entry, mirror = knots.find(name), knots.find(f"mirror {name}")
    assert mirror.diagram == entry.diagram.mirror()
    assert mirror.pulled == entry.pulled


@pytest.mark.parametrize(
    ("name", "closure"),
    [
        ("overhand", "3_1"),
        ("figure-eight", "4_1"),
        ("double overhand", "5_1"),
        ("overhand-7", "7_1"),
        ("overhand-9", "9_1"),
        ("stevedore", "6_1"),
        ("open 8_20", "8_20"),
    ],
)
def test_knots_in_one_strand(name: str, closure: str) -> None:
    diagram = knots.find(name).diagram
    assert sorted(diagram.ends) == ["A0", "A1"]
    closed = identify(close(diagram, [("A0", "A1")]))
    assert {one.removeprefix("m") for one in closed.names} == {closure}


@pytest.mark.parametrize(
    ("p", "q", "name"), [(2, 3, "3_1"), (2, -3, "m3_1"), (3, 4, "8_19"), (3, 5, "10_124"), (2, 4, "L4a1")]
)
def test_torus_knots(p: int, q: int, name: str) -> None:
    drawn = identify(knots.find(f"T({p},{q})").diagram)
    assert drawn.names == identify(named_diagram(name)).names
    assert identify(knots.find(f"T({q},{p})").diagram).names == drawn.names if q > 0 else True


# --- files


def test_the_file_of_bends() -> None:
    rows = json.loads(files("torsade.knots").joinpath("catalogue/bends.json").read_text(encoding="utf-8"))
    for name, row in rows.items():
        diagram = bends()[name].diagram
        assert to_gauss(diagram) == row["gauss"]
        assert diagram.ends == tuple(row["boundary"].split())
        assert all(row[key] for key in ("title", "certainty", "source", "pulls"))
        assert set(row.get("other_pulls", {}).values()) <= set(row["pulls"])


@pytest.mark.parametrize("name", [entry.name for entry in entries() if entry.kind == "closed"][1:])
def test_codes_of_closed_knots_agree(name: str) -> None:
    """PD code, DT code, braid and Conway notation are the same knot; DT and Conway up to the mirror image."""
    facts = knots.facts(name)
    names = identify(named_diagram(name)).names
    assert identify(from_braid(facts["braid"])).names == names
    either = {names, identify(named_diagram(name).mirror()).names}
    assert identify(from_dt(facts["dt"])).names in either
    assert identify(from_conway(facts["conway"])).names in either
    assert identify(from_text(f"[{facts['conway']}]")).names in either
    amphichiral = len(either) == 1
    assert amphichiral == ("amphicheiral" in facts["symmetry"])
    assert float(facts["ropelength"]) > 32.7


def test_variants_are_those_of_the_shared_list() -> None:
    given: dict[str, Any] = shared("published_variants.json")
    assert list(knots.variants()) == list(given)
    for label, text in given.items():
        bend, pulled = text.split()[:2]
        diagram = bends()[bend].diagram
        entry = knots.variants()[label]
        assert entry.pulled == pulled
        assert is_isomorphic(entry.diagram, diagram.mirror() if "mirror" in text else diagram)


def test_thief_is_the_reef_pulled_otherwise() -> None:
    assert state(knots.bend_diagram("thief")).gamma == 1
    assert state(knots.bend_diagram("reef")).gamma == 4
    with pytest.raises(TorsadeError, match="'3_1' is no bend, but Knot 3_1: trefoil; choose one of reef"):
        knots.bend_diagram("3_1")
