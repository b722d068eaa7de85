"""Self-torque of all bends beside their writhe, and how far its numbers move with mesh, tolerance and window.

Writes its tables into docs/torque-writhe.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.figures import bends
from torsade.figures.base import Choice, Preset
from torsade.figures.figure_4_4 import fits
from torsade.figures.moments import coefficients, moment, torque_of
from torsade.figures.proportion import Estimate
from torsade.figures.runs import results
from torsade.figures.torque_writhe import Balance, balance, window
from torsade.motion.overdamped import Stepping
from torsade.protocols.prison_escape import PrisonEscape
from torsade.protocols.pulled import STANDARD_SPACING
from torsade.reptation import node_tangents
from torsade.results import Result

PAGE = Path(__file__).parents[1] / "docs" / "torque-writhe.md"
PRESETS: tuple[Preset, ...] = ("standard", "published")
WINDOWS = ((0.3, 0.45), (0.45, 0.6), (0.3, 0.9))
AGAINST = {"Wr": "Wr", "Wr3": "Wr₃", "Wr3_touching": "Wr₃ in contact"}
FOLLOWS = {"twist_rad": "twist", "turned_rad": "rotation"}

Found = Mapping[str, Balance]


def refined(short: Mapping[str, Any]) -> dict[str, Callable[[str], PrisonEscape]]:
    """Ways to run a bend: as it is, with twice the nodes, with a tenth of the tolerance."""
    spacing = STANDARD_SPACING * common.NYLON.radius / 2
    tolerance = Stepping().tolerance / 10
    return {
        "nodes doubled": lambda knot: PrisonEscape(knot=knot, spacing=spacing, **short),
        "tolerance / 10": lambda knot: PrisonEscape(knot=knot, tolerance=tolerance, **short),
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/torque-writhe.md as it is")
    options.add_argument("--runs", help="folder where runs are kept, and found again; by default nowhere")
    given = options.parse_args(arguments)
    choice = Choice(PRESETS, given.quick)
    same = bends.kinds(bends.labels(choice))
    single = [knot for knot in same if same[knot] == knot]
    short: dict[str, Any] = {"duration": bends.QUICK_DURATION, "frames": 4} if given.quick else {}
    ways = refined(short)
    specs = dict(bends.specs(choice, single))
    specs |= {f"{knot}, {way}": make(knot) for way, make in ways.items() for knot in single}
    with tempfile.TemporaryDirectory() as folder:
        runs = results(specs, Path(given.runs or folder))
        base: dict[str, Found] = {preset: _balances(runs, single, preset) for preset in PRESETS}
        finer = {way: _balances(runs, single, way) for way in ways}
        windows = {
            f"from {start:g} s to {until:g} s": _balances(runs, single, "standard", start, until)
            for start, until in WINDOWS
        }
        why = _why_table(base["standard"], runs)
    tables = {
        "bends": _bends_table(base),
        "fits": _fits_table({**base, **{f"standard, {w}": f for w, f in (finer | windows).items()}}),
        "why": why,
        "refinement": _refinement_table(base["standard"], finer),
    }
    if not (given.quick or given.no_write):
        for name, text in tables.items():
            common.put(text, PAGE, name)
    found: dict[str, Any] = {
        preset: {knot: [b.reduced_torque, b.writhe_3, b.touching_writhe] for knot, b in balances.items()}
        for preset, balances in base.items()
    }
    return common.show(found, list(tables.values()), given.json)


def _balances(
    runs: Mapping[str, Result], knots: Sequence[str], way: str, *window: float
) -> dict[str, Balance]:
    return {knot: balance(runs[f"{knot}, {way}"], *window) for knot in knots}


def _number(value: float, digits: int = 2) -> str:
    text = f"{value:.{digits}f}"
    return "-" if value != value else "0" if float(text) == 0 else text.replace("-", "−")


def _bends_table(base: Mapping[str, Found]) -> str:
    """One row for each bend: what is counted, and torque, writhe and agreement with both presets."""
    heads = [
        *("bend", "Wr", "Wr₃", "in contact", "torque, mN m", "reduced", "constant", "density r", "explained"),
        *("alignment", "twist, rad", "turned, rad"),
    ]
    rows = []
    for knot in base["standard"]:
        both = [found[knot] for found in base.values()]

        def pair(digits: int, *values: float) -> str:
            return " / ".join(_number(v, digits) for v in values)

        rows.append(
            [
                knot.replace("_", " "), _number(both[0].writhe, 0),
                pair(2, *(b.writhe_3 for b in both)), pair(2, *(b.touching_writhe for b in both)),
                pair(2, *(1e3 * b.torque for b in both)), pair(2, *(b.reduced_torque for b in both)),
                pair(2, *(b.constant for b in both)), pair(2, *(b.correlation for b in both)),
                pair(2, *(b.explained for b in both)), pair(2, *(b.alignment for b in both)),
                pair(1, *(b.twist for b in both)), pair(1, *(b.turned for b in both)),
            ]
        )  # fmt: skip
    return common.table(heads, rows)


def _fits_table(found: Mapping[str, Found]) -> str:
    """Slopes through the origin and correlations of reduced torque with each kind of writhe."""
    heads = ["runs", *(f"{what}, {name}" for name in AGAINST.values() for what in ("slope", "r"))]
    heads += [f"r, {name}" for name in FOLLOWS.values()]
    rows = []
    for way, balances in found.items():
        fitted = fits(balances)
        row = [way]
        for name in AGAINST:
            row += [_interval(fitted[name].slope), _interval(fitted[name].correlation)]
        rows.append(row + [_interval(fitted[name].correlation) for name in FOLLOWS])
    return common.table(heads, rows)


def _interval(estimate: Estimate) -> str:
    value, low, high = (_number(x) for x in estimate)
    return f"{value} [{low}, {high}]"


def _why_table(base: Found, runs: Mapping[str, Result]) -> str:
    """What makes torque over the writhe in contact differ from 1, where there is such writhe.

    And what it would be if strands moved as the fit says: with one speed, with two, and turning.
    """
    heads = [
        "bend",
        "(2h/R)²",
        "rest lengths",
        "strands' speed over v",
        "product",
        "torque over writhe in contact",
    ]
    heads += ["torque, mN m", "of one speed", "of two", "and of rotation"]
    rows = []
    for knot, b in base.items():
        if abs(b.touching_writhe) >= 0.8:
            pace = sum(b.strand_speed) / 2 / b.speed
            parts = (b.nearness, b.shortening, pace, b.nearness * b.shortening * pace)
            ratio = b.reduced_torque / b.touching_writhe
            torques = [1e3 * x for x in (b.torque, *_fitted_torques(runs[f"{knot}, standard"]))]
            rows.append([knot.replace("_", " "), *(_number(x) for x in (*parts, ratio, *torques))])
    return common.table(heads, rows)


def _fitted_torques(result: Result) -> list[float]:
    """Torque of both strands sliding at their mean speed, each at its own, and turning besides [N m]."""
    found = []
    for frame in window(result):
        m = moment(result, int(frame))
        if m.fit is None:
            continue
        tangents = [node_tangents(x) for x in m.strands]
        slides = [speed * t for speed, t in zip(m.fit.speed, tangents, strict=True)]
        alike = [m.fit.speed.mean() * t for t in tangents]
        turned = [
            v + np.cross(m.fit.rotation, x - m.fit.centre) for v, x in zip(slides, m.strands, strict=True)
        ]
        eta_f_J = coefficients(result).eta_f_J
        found.append([torque_of(m, v, eta_f_J) for v in (alike, slides, turned)])
    return [float(x) for x in np.mean(found, axis=0)] if found else [0.0] * 3


def _refinement_table(base: Found, finer: Mapping[str, Found]) -> str:
    """Reduced torque, Wr_3 and rotation of each bend, and what they are when refined."""
    ways = {"as it is": base, **finer}
    heads = ["bend"]
    for what in ("reduced torque", "Wr₃", "Wr₃ in contact", "density r", "turned, rad"):
        heads.append(f"{what}: {', '.join(ways)}")
    rows = []
    for knot in base:
        seen = [found[knot] for found in ways.values()]
        values = [
            [b.reduced_torque for b in seen], [b.writhe_3 for b in seen], [b.touching_writhe for b in seen],
            [b.correlation for b in seen], [b.turned for b in seen],
        ]  # fmt: skip
        rows.append([knot.replace("_", " "), *("; ".join(_number(v) for v in column) for column in values)])
    return common.table(heads, rows)


if __name__ == "__main__":
    main()
