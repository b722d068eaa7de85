"""What c_f owes to the free ends of a bend: 15 N on bends with tails of several lengths.

Writes its table into docs/knots.md, between two marks, unless `--no-write` is given.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.figures.runs import results
from torsade.protocols.prison_escape import PrisonEscape
from torsade.results import Result

PAGE = Path(__file__).parents[1] / "docs" / "knots.md"
BENDS = (
    "grief",
    "granny",
    "thief",
    "reef",
    "bowline14",
    "carrick14",
    "hunter13",
    "hunter14",
    "zeppelin14",
    "alpine13",
)
TAILS = (20, 25, 30, 40)  # [radii]
LONG = 120  # [radii]


def steady(result: Result) -> float:
    """c_f over the second half of a run, where the bend slides in one arrangement [-]."""
    spec, data = PrisonEscape(**result.spec), result.dataset
    t, s = data["sample_time"].values, data["sample_separation"].values
    speed = (s[-1] - np.interp(t[-1] / 2, t, s)) / (t[-1] / 2)
    return float(2 * spec.force / (spec.fiber_material.eta * np.pi * spec.h * speed))


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/knots.md as it is")
    given = options.parse_args(arguments)
    bends, tails = (BENDS[2:4], TAILS[:1]) if given.quick else (BENDS, TAILS)
    h = common.NYLON.radius
    short, long = (0.02, 0.04) if given.quick else (1.0, 2.0)
    specs = {
        f"{knot} {preset} {tail}": PrisonEscape(
            knot=knot, preset=preset, tail=tail * h, duration=long if tail == LONG else short
        )
        for knot in bends
        for preset in ("standard", "published")
        for tail in (*tails, LONG)
    }
    with tempfile.TemporaryDirectory() as folder:
        found = results(specs, Path(folder))
    rows = [_row(knot, preset, tails, found) for preset in ("standard", "published") for knot in bends]
    heads = ("bend", "preset", *(f"tail {t} h" for t in tails), f"tail {LONG} h, from 1 s to 2 s")
    text = common.table(heads, [[r["knot"], r["preset"], *map(_cell, r["tails"]), r["steady"]] for r in rows])
    if not (given.quick or given.no_write):
        common.put(text, PAGE, "tails")
    return common.show({"rows": rows}, [text], given.json)


def _row(knot: str, preset: str, tails: Sequence[int], found: dict[str, Result]) -> dict[str, Any]:
    """c_f and slip time with each tail, and what the bend comes to with the longest."""
    runs = [found[f"{knot} {preset} {tail}"] for tail in tails]
    short = [{"c_f": r.c_f, "slipped_at_s": r.slipped_at} for r in runs]
    return {
        "knot": knot,
        "preset": preset,
        "tails": short,
        "steady": steady(found[f"{knot} {preset} {LONG}"]),
    }


def _cell(run: dict[str, Any]) -> str:
    slipped = run["slipped_at_s"]
    return f"{run['c_f']:.1f}" + (f", slips at {slipped:.2f} s" if slipped else "")


if __name__ == "__main__":
    main()
