"""Time and shape of fibers made from diagrams: knots, bends under all pulls, sutures, torus knots, braids.

Lengths are in radii of the fiber. The first fiber, which loads kernels, is not counted.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from benchmarks import common
from torsade import curve
from torsade.errors import TorsadeError
from torsade.knots.bends import bends
from torsade.knots.build import BuiltKnot, build
from torsade.knots.sutures import suture_diagram
from torsade.topology.codes import from_braid
from torsade.topology.diagram import Diagram
from torsade.topology.named import named_diagram
from torsade.topology.table import contents

PULLS = ("A1B1", "A1B0", "A0B1", "A0B0")
THROWS = (-7, -5, -3, 3, 5, 7)
TORUS = ((2, 3), (2, 5), (2, 7), (2, 9), (3, 4), (3, 5), (4, 5), (2, 4), (3, 3), (4, 4))
BRAIDS = 200


def braids(count: int, seed: int = 0) -> Iterator[tuple[str, Diagram]]:
    """Closures of random braid words of 1 to 12 letters on 2 to 5 strands, split ones among them."""
    chance = random.Random(seed)
    for _ in range(count):
        strands = chance.randint(2, 5)
        word = [chance.choice((-1, 1)) * chance.randint(1, strands - 1) for _ in range(chance.randint(1, 12))]
        yield " ".join(map(str, word)), from_braid(word)


def cases(quick: bool) -> Iterator[tuple[str, str, Diagram, str | None]]:
    """(family, name, diagram, pull) of all that is built."""
    few = slice(0, 2 if quick else None)
    for name in list(contents()["knots"])[few]:
        yield "knots", name, named_diagram(name), None
    for name, entry in list(bends().items())[few]:
        for pulled in PULLS[few]:
            yield "bends", f"{name} {pulled}", entry.diagram, pulled
    for bottom in THROWS[few]:
        for top in THROWS[few]:
            yield "sutures", f"{bottom},{top}", suture_diagram(bottom, top), "A1B1"
    for p, q in TORUS[few]:
        yield "torus", f"T({q},{p})", from_braid(list(range(1, p)) * q), None
    for word, diagram in braids(2 if quick else BRAIDS):
        yield "braids", word, diagram, None


def measured(family: str, name: str, diagram: Diagram, pulled: str | None) -> dict[str, Any]:
    """Time [s], nodes, length, clearance and curvature of one fiber; what went wrong, if anything did."""
    began = common.WALL()
    built: BuiltKnot | None = None
    failure = ""
    try:
        built = build(diagram, 1.0, pulled=pulled)
    except TorsadeError as error:
        failure = str(error)
    row: dict[str, Any] = {"family": family, "name": name, "seconds": common.WALL() - began}
    if built is not None:
        row["nodes"] = sum(len(x) for x in built.strands)
        row["length"] = sum(curve.length(x, c) for x, c in zip(built.strands, built.closed, strict=True))
        row["clearance"], row["h_kappa"] = built.clearance, built.h_kappa
    return row | {"failure": failure}


def summary(family: str, rows: Sequence[dict[str, Any]]) -> list[object]:
    """Of one family: count, failures, mean and greatest time, and extremes of what was measured."""
    made = [row for row in rows if not row["failure"]]
    seconds = [row["seconds"] for row in rows]
    lengths = [row["length"] for row in made] or [math.nan]
    return [
        family,
        len(rows),
        len(rows) - len(made),
        float(np.mean(seconds)),
        max(seconds),
        max((row["nodes"] for row in made), default=0),
        min(lengths),
        float(np.mean(lengths)),
        max(lengths),
        min((row["clearance"] for row in made), default=math.nan),
        max((row["h_kappa"] for row in made), default=math.nan),
    ]


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    given = common.parser(__doc__).parse_args(arguments)
    build(named_diagram("3_1"), 1.0)
    rows = [measured(*case) for case in cases(given.quick)]
    families = list(dict.fromkeys(row["family"] for row in rows))
    heads = (
        "family",
        "built",
        "failures",
        "mean [s]",
        "longest [s]",
        "most nodes",
        "least L/h",
        "mean L/h",
        "greatest L/h",
        "clearance/h",
        "h kappa",
    )
    parts = [[row for row in rows if row["family"] == family] for family in families]
    tables = [
        common.table(heads, [summary(*each) for each in zip(families, parts, strict=True)]),
        *(f"{row['family']} {row['name']}: {row['failure']}" for row in rows if row["failure"]),
    ]
    return common.show({"rows": rows}, tables, given.json)


if __name__ == "__main__":
    main()
