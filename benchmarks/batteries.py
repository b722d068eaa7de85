"""Batteries: discharge times of the 14 knots, how far they move under refinement, and what mirror images do.

Writes its tables into docs/batteries.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.errors import TorsadeError
from torsade.figures.battery_map import KNOTS, SHARES
from torsade.knots.likeness import likeness
from torsade.knots.loops import tight_loop
from torsade.protocols.battery import NODES_PER_RADIUS, Battery

PAGE = Path(__file__).parents[1] / "docs" / "batteries.md"

STUDIED = (("3_1", 0.0), ("4_1", 0.0), ("7_4", 0.0), ("3_1", 2.0), ("4_1", 2.0), ("7_4", 2.0), ("4_1", 4.0))
"""Knots and twist densities that are refined."""

AMPHICHIRAL = (("4_1", 2.0), ("4_1", 4.0), ("6_3", 2.0), ("6_3", 4.0))
CHIRAL = ("3_1", 2.0)
PLACES = 8
"""Where batteries are cut whose times are compared whatever the cut, evenly along the fiber."""

MIRROR = np.array([1.0, 1.0, -1.0])
QUICK: Mapping[str, Any] = {"duration": "0.2 s", "charging": "0.5 s", "nodes": 60}

Found = dict[str, Any]


def variants() -> dict[str, Mapping[str, Any]]:
    """Ways to run a battery, by name; the first is as it is."""
    nodes = round(NODES_PER_RADIUS * 50)
    return {
        "as it is": {},
        "nodes doubled": {"nodes": 2 * nodes},
        "tolerance / 10": {"tolerance": 1e-3},
        "other noise": {"seed": 1},
        "eta_f / eta = 0.2": {"eta_f_ratio": 0.2},
        "cut a quarter farther": {},
    }


def run(knot: str, twist: float, **options: Any) -> Found:
    """The report of a battery, or why there is none."""
    try:
        return Battery.report(Battery(knot=knot, twist=twist, **options).run())
    except TorsadeError as error:
        return {"knot": knot, "twist_density": twist, "failed": str(error)}


def times(found: Found) -> list[float | None]:
    """Discharge times [T_0] to 50, 10 and 1 %."""
    return [None] * 3 if "failed" in found else [found["discharge_time_T0"][share] for share in SHARES]


def refined(studied: Sequence[tuple[str, float]], short: Mapping[str, Any]) -> list[Found]:
    """Every battery in all variants."""
    rows = []
    for knot, twist in studied:
        first: Found = {}
        for name, options in variants().items():
            place = {}
            if name.startswith("cut") and "failed" not in first:
                place = {"cut_at": (first["cut_at"] + 0.25) % 1.0}
            found = run(knot, twist, **{**options, **place, **short})
            first = first or found
            rows.append({"variant": name, **found})
    return rows


def mirrored(knot: str, twist: float, short: Mapping[str, Any]) -> list[Found]:
    """A knot at both twists, the second cut where the first is, as far as the shapes are mirror images.

    The third is the mirror image of the knot, with the same noise, cut where its own stress is largest.
    `mirror_distance` [radii] says how far: charged, and in their starting shape.
    """
    first, second = (Battery(knot=knot, twist=t, **short) for t in (twist, -twist))
    shapes = [spec.charged()[0].state.x for spec in (first, second)]
    start = tight_loop(knot).fiber(first.slenderness, len(shapes[0]))
    reflected = likeness(shapes[0] * MIRROR, shapes[1])
    n = len(shapes[0])
    found = Battery.report(first.run())
    place = reflected.node(round(found["cut_at"] * n), n) / n
    other = Battery.report(second.model_copy(update={"cut_at": place}).run())
    apart = {
        "mirror_distance": reflected.distance / first.h,
        "mirror_distance_tight": likeness(start * MIRROR, start).distance,
    }
    return [found | apart, other | apart, run(f"m{knot}", -twist, **short) | apart]


def everywhere(knot: str, twist: float, short: Mapping[str, Any], places: int = PLACES) -> Found:
    """A battery cut at places all along: energy, writhe, and the times to 10 %."""
    rows = [run(knot, twist, cut_at=k / places, **short) for k in range(places)]
    kept = {name: rows[0][name] for name in ("knot", "twist_density", "energy_E0", "writhe")}
    return kept | {"tenth": [t for row in rows if (t := times(row)[1]) is not None]}


def surveyed(knots: Sequence[str], twists: Sequence[float], short: Mapping[str, Any]) -> list[Found]:
    """All knots at all twist densities."""
    return [run(knot, twist, **short) for knot in knots for twist in twists]


def refinement_table(rows: Sequence[Found]) -> str:
    """Energy and discharge times of every variant."""
    heads = ["knot", "h θ′", "", "energy [E_0]", "Wr", "50 %", "10 %", "1 %", "knots on the way"]
    return common.table(heads, [_row(found, found["variant"]) for found in rows])


def survey_table(rows: Sequence[Found], doubled: Sequence[Found] = ()) -> str:
    """Energy, discharge times and intermediate knots, and, where they are given, times at twice the nodes."""
    heads = ["knot", "h θ′", "energy [E_0]", "Wr", "50 %", "10 %", "1 %", "knots on the way"]
    heads += [f"{share} %, nodes doubled" for share in SHARES] if doubled else []
    cells = []
    for k, found in enumerate(rows):
        row = list(_row(found, ""))
        del row[2]
        cells.append([*row, *(times(doubled[k]) if doubled else ())])
    return common.table(heads, cells)


def mirror_table(rows: Sequence[Found]) -> str:
    """Energy and discharge times of mirror images, and how far their shapes are from being so."""
    heads = ["knot", "h θ′", "energy [E_0]", "Wr", "50 %", "10 %", "1 %"]
    cells = []
    for found in rows:
        knot, twist, _, *numbers, _ = _row(found, "")
        cells.append([knot, twist, *numbers, found["mirror_distance"], found["mirror_distance_tight"]])
    return common.table([*heads, "charged, apart [h]", "tight, apart [h]"], cells)


def everywhere_table(rows: Sequence[Found]) -> str:
    """Either twist of a knot side by side, whatever the place of the cut."""
    cells = []
    for right, left in zip(rows[::2], rows[1::2], strict=True):
        logs = [np.log(one["tenth"]) for one in (right, left)]
        line: list[object] = [right["knot"], f"±{right['twist_density']:g}"]
        for one, log in zip((right, left), logs, strict=True):
            spread = f"{min(one['tenth']):.3g} to {max(one['tenth']):.3g}" if one["tenth"] else None
            mean = math.exp(log.mean()) if len(log) else None
            line += [one["energy_E0"]["total"], one["writhe"], mean, spread]
        if min(map(len, logs)) < 2:
            cells.append([*line, None, None])
            continue
        error = math.hypot(*(float(log.std(ddof=1)) / math.sqrt(len(log)) for log in logs))
        cells.append([*line, math.exp(logs[0].mean() - logs[1].mean()), math.exp(2 * error)])
    heads = ["energy [E_0]", "Wr", "to 10 %, mean", "range"]
    both = [*(f"{head}, +" for head in heads), *(f"{head}, −" for head in heads)]
    return common.table(["knot", "h θ′", *both, "ratio of means", "by chance up to"], cells)


def _row(found: Found, note: str) -> Iterator[object]:
    yield found["knot"]
    yield f"{found['twist_density']:+g}"
    yield note
    if "failed" in found:
        yield from (None,) * 5
        yield found["failed"].split(" (")[0]
        return
    yield found["energy_E0"]["total"]
    yield found["writhe"]
    yield from times(found)
    yield ", ".join(found["intermediate_knots"]) or "-"


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    """Measure and print, and write the tables into the docs."""
    parser = common.parser(__doc__)
    parser.add_argument("--no-write", action="store_true", help=f"leave {PAGE.name} as it is")
    options = parser.parse_args(arguments)
    short = QUICK if options.quick else {}
    knots = KNOTS[:1] if options.quick else KNOTS
    double = {"nodes": 2 * round(NODES_PER_RADIUS * 50)}
    found: dict[str, Any] = {
        "refined": refined(STUDIED[:1] if options.quick else STUDIED, short),
        "mirror": [
            row
            for knot, twist in AMPHICHIRAL[: 1 if options.quick else None]
            for row in mirrored(knot, twist, short)
        ],
        "everywhere": [
            everywhere(knot, sign * twist, short, 2 if options.quick else PLACES)
            for knot, twist in (CHIRAL, *AMPHICHIRAL)[: 1 if options.quick else None]
            for sign in (1, -1)
        ],
        "untwisted": surveyed(knots, (0.0,), short),
        "untwisted_doubled": surveyed(knots, (0.0,), {**double, **short}),
        "twisted": surveyed(knots, (3.0, -3.0), short),
    }
    tables = {
        "refinement": refinement_table(found["refined"]),
        "mirror": mirror_table(found["mirror"]),
        "everywhere": everywhere_table(found["everywhere"]),
        "untwisted": survey_table(found["untwisted"], found["untwisted_doubled"]),
        "twisted": survey_table(found["twisted"]),
    }
    if not (options.no_write or options.quick):
        for name, text in tables.items():
            common.put(text, PAGE, name)
    return common.show(found, list(tables.values()), options.json)


if __name__ == "__main__":
    main()
