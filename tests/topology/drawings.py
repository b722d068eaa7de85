"""The knots of the tables in all notations, where other reference data are, and random diagrams."""

from __future__ import annotations

import json
import os
import random
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from torsade.topology import Diagram, moves
from torsade.topology.table import contents

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[3] / "shared"))
KNOTS = SHARED / "data" / "knots"
needs_knots = pytest.mark.skipif(not KNOTS.is_dir(), reason="the reference knots are not here")


def table(name: str) -> Any:
    """A file of reference knots; empty where it is absent."""
    path = KNOTS / name
    return json.loads(path.read_text()) if path.is_file() else {}


@lru_cache
def closed_knots() -> dict[str, dict[str, Any]]:
    """The 249 knots through ten crossings, with all their codes as KnotInfo (knotinfo.org) has them.

    PD codes are in the package's table, the others in its catalogue; Gauss codes, further braids and
    signatures in `notations.json`.
    """
    catalogue = json.loads(files("torsade.knots").joinpath("catalogue/closed.json").read_text("utf-8"))
    notations = json.loads(Path(__file__).with_name("notations.json").read_text("utf-8"))
    first_without = {8: 19, 9: 42, 10: 124}  # alternating diagram
    found = {}
    for name, row in contents()["knots"].items():
        crossings, number = map(int, name.split("_"))
        found[name] = {
            **notations[name],
            "pd": row["pd"],
            "dt": catalogue[name]["dt"],
            "conway": catalogue[name]["conway"],
            "braids": [catalogue[name]["braid"], *notations[name].get("other_braids", [])],
            "crossing_number": crossings,
            "alternating": number < first_without.get(crossings, 999),
        }
    return found


def random_move(diagram: Diagram, rng: random.Random) -> tuple[str, Diagram]:
    """A random Reidemeister move and its name; growing and shrinking are about as likely."""
    made = [
        (
            "R1",
            [
                lambda: moves.add_kink(
                    diagram, rng.choice(diagram.ports), rng.choice((1, -1)), rng.random() < 0.5
                )
            ],
        ),
        ("R1", [lambda p=p: moves.remove_kink(diagram, p) for p in moves.kinks(diagram)]),
        (
            "R2",
            [lambda p=p: moves.add_bigon(diagram, *p, rng.random() < 0.5) for p in moves.fingers(diagram)],
        ),
        ("R2", [lambda p=p: moves.remove_bigon(diagram, p) for p in moves.bigons(diagram)]),
        ("R3", [lambda p=p: moves.slide_triangle(diagram, p) for p in moves.triangles(diagram)]),
    ]
    name, ways = rng.choice([(name, ways) for name, ways in made if ways])
    return name, rng.choice(ways)()


def scrambled(diagram: Diagram, n_crossings: int, rng: random.Random) -> Diagram:
    """A drawing with so many crossings, by random moves that do not take them away."""
    while diagram.n_crossings < n_crossings:
        u = rng.random()
        if u < 0.15:
            dart = rng.choice(diagram.ports)
            diagram = moves.add_kink(diagram, dart, rng.choice((1, -1)), rng.random() < 0.5)
        elif u < 0.6:
            diagram = moves.add_bigon(diagram, *rng.choice(moves.fingers(diagram)), rng.random() < 0.5)
        else:
            for _ in range(10):
                if places := moves.triangles(diagram):
                    diagram = moves.slide_triangle(diagram, rng.choice(places))
    return diagram
