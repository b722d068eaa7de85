"""Names of bends, and the file that they come from."""

from __future__ import annotations

import json
from importlib.resources import files

import pytest

from torsade.errors import TorsadeError
from torsade.knots import bend_diagram, bend_names, find_bend
from torsade.knots.bends import bends
from torsade.topology.codes import to_gauss


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("reef", ("reef", "A1B1")),
        (" Reef Knot", ("reef", "A1B1")),
        ("square knot", ("reef", "A1B1")),
        ("thief", ("reef", "A1B0")),
        ("Thief-knot", ("reef", "A1B0")),
        ("what knot", ("granny", "A1B0")),
        ("grief", ("granny", "A1B0")),
        ("Carrick bend", ("carrick", "A1B1")),
        ("Hunter's bend", ("hunter", "A1B1")),
        ("riggers bend", ("hunter", "A1B1")),
        ("alpine butterfly bend", ("alpine_butterfly", "A1B1")),
        ("ABOK 1452", ("ashley", "A1B1")),
        ("grapevine", ("double_fisherman", "A1B1")),
        ("ring bend", ("water_knot", "A1B1")),
        ("flemish bend", ("figure_eight_bend", "A1B1")),
    ],
)
def test_names(name: str, found: tuple[str, str]) -> None:
    entry, pulled = find_bend(name)
    assert (entry.name, pulled) == found
    assert bend_diagram(name) == entry.diagram.pulled(pulled)


def test_no_two_bends_share_a_name() -> None:
    words = [
        word.lower()
        for entry in bends().values()
        for word in (entry.name, *entry.aliases, *entry.names_of_pulls)
    ]
    assert len(words) == len(set(words))
    assert all(find_bend(word) for word in words)
    assert {"reef", "thief", "granny", "grief"} <= set(bend_names())


def test_unknown_names() -> None:
    with pytest.raises(TorsadeError, match="did you mean 'zeppelin'"):
        bend_diagram("zepelin")
    with pytest.raises(TorsadeError, match="choose one of reef, granny"):
        find_bend("")


def test_the_file() -> None:
    rows = json.loads(files("torsade.knots").joinpath("catalogue/bends.json").read_text(encoding="utf-8"))
    for name, row in rows.items():
        diagram = bends()[name].diagram
        assert to_gauss(diagram) == row["gauss"]
        assert diagram.ends == tuple(row["boundary"].split())
        assert all(row[key] for key in ("title", "certainty", "source", "pulls"))
        assert set(row.get("names_of_pulls", {}).values()) <= set(row["pulls"])
