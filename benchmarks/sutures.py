"""Sutures: what six knots do to the skin, how far it moves under refinement, what it depends on, what holds.

Writes its tables into docs/sutures.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.errors import TorsadeError
from torsade.protocols.ensemble import ensemble
from torsade.protocols.suture import SIX, Suture, turns_of

PAGE = Path(__file__).parents[1] / "docs" / "sutures.md"

QUICK: Mapping[str, Any] = {"duration": 0.2, "frames": 4, "skin_radius": 1e-3}

Found = dict[str, Any]
Options = Mapping[str, Any]

REFINED: Mapping[str, Options] = {
    "as it is": {},
    "nodes twice as dense": {"spacing": 0.05e-3},
    "tolerance / 10": {"tolerance": 1e-3},
    "both": {"spacing": 0.05e-3, "tolerance": 1e-3},
}

STUDIED: Mapping[str, Options] = {
    "as it is": {},
    "friction 0.1": {"friction": 0.1},
    "friction 0.3": {"friction": 0.3},
    "friction 0.6": {"friction": 0.6},
    "friction 0.3, v_0 / 10": {"friction": 0.3, "friction_speed": 1e-7},
    "drag on skin x 1/3": {"skin_drag": 1 / 3},
    "drag on skin x 3": {"skin_drag": 3.0},
    "k_s = 5 N/m": {"skin_stiffness": 5.0},
    "k_s = 80 N/m": {"skin_stiffness": 80.0},
    "zeta/k_s = 10 ms": {"skin_relaxation": 0.01},
    "zeta/k_s = 1 s": {"skin_relaxation": 1.0},
    "h_s = 1 mm": {"skin_radius": 1e-3},
    "h_s = 4 mm": {"skin_radius": 4e-3},
    "gap 0.5 mm": {"gap": 0.5e-3},
    "gap 2 mm": {"gap": 2e-3},
    "pull at 0 deg": {"angle": 0.0},
    "pull at 15 deg": {"angle": "15 deg"},
    "pull at 45 deg": {"angle": "45 deg"},
    "pull at 60 deg": {"angle": "60 deg"},
    "F_P = 5 mN": {"force": 5e-3},
    "F_P = 20 mN": {"force": 20e-3},
    "eta_f = eta": {"eta_f_ratio": 1.0},
}

LET_GO: Mapping[str, Options] = {
    "drag alone": {"release": 1.0},
    "friction 0.3": {"release": 1.0, "friction": 0.3},
}


def reports(options: Options) -> list[Found]:
    """The report of every knot; why there is none, where a run fails."""
    try:
        results = ensemble([Suture(throws=throws, **options) for throws in SIX])
        return [Suture.report(result) for result in results]
    except TorsadeError:
        return [_alone(throws, options) for throws in SIX]


def _alone(throws: str, options: Options) -> Found:
    try:
        return Suture.report(Suture(throws=throws, **options).run())
    except TorsadeError as error:
        return {"throws": throws, "failed": str(error)}


def study(variants: Mapping[str, Options], short: Options) -> dict[str, list[Found]]:
    """Reports of all knots in every variant."""
    return {name: reports({**options, **short}) for name, options in variants.items()}


def displacement(key: str) -> Callable[[Found], float | None]:
    """Of side a along z [um], at the end of the pull or where it was largest; None where a run failed."""
    return lambda report: None if "failed" in report else 1e6 * report[key]["a"]


def number(key: str, unit: float = 1.0) -> Callable[[Found], float | None]:
    """What a report has under a key, in a unit; None where there is none."""
    return lambda report: None if report.get(key) is None else report[key] / unit


def six_table(found: Sequence[Found]) -> str:
    """What is found of each knot."""
    heads = (
        "throws", "knot", "N", "Wr", "τ", "z_a [µm]", "relative [µm]", "largest [µm]", "gap [mm]",
        "normal [mN]", "shear [µN]", "c_f",
    )  # fmt: skip
    rows = [
        (
            r["throws"], SIX[r["throws"]], r["crossings"], f"{r['writhe']:+d}" if r["writhe"] else "0",
            f"{r['tau']:.4g}",
            *(1e6 * r["z_displacement_m"][k] for k in ("a", "relative")), 1e6 * r["z_peak_m"]["a"],
            f"{1e3 * r['gap_m']:.3f}", 1e3 * r["skin_force_N"]["normal"][0],
            1e6 * r["skin_force_N"]["shear"][0], r["c_f"],
        )
        for r in found
    ]  # fmt: skip
    return common.table(heads, rows)


def study_table(
    found: Mapping[str, list[Found]], value: Callable[[Found], float | None], ordered: bool = False
) -> str:
    """A number of every knot in every variant; ordered, whether displacements are in the thesis's order."""
    heads = ["", *SIX]
    if ordered:
        heads.append("least of one hand / largest of two")
    rows = []
    for name, reported in found.items():
        values = [value(r) for r in reported]
        rows.append([name, *values, *([separation(values)] if ordered else [])])
    return common.table(heads, rows)


def let_go_table(found: Mapping[str, list[Found]]) -> str:
    """Gaps [mm] when the ends are let go, and a second later."""
    moments = {"gap_m": "at the end of the pull", "gap_after_release_m": "1 s later"}
    rows = [
        [f"{name}, {when}", *(number(key, 1e-3)(r) for r in reported)]
        for name, reported in found.items()
        for key, when in moments.items()
    ]
    return common.table(["", *SIX], rows)


def separation(z: Sequence[float | None]) -> float | None:
    """Least |z| of throws of one hand over the largest of throws of two; above 1 as in the thesis."""
    if any(value is None for value in z):
        return None
    size = {throws: abs(value or 0.0) for throws, value in zip(SIX, z, strict=True)}
    same = [v for throws, v in size.items() if np.prod(turns_of(throws)) > 0]
    other = [v for throws, v in size.items() if np.prod(turns_of(throws)) < 0]
    return min(same) / max(other)


def main(arguments: list[str] | None = None) -> dict[str, Any]:
    """Run as a program; returns the numbers."""
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="print the tables, and leave the page alone")
    given = options.parse_args(arguments)
    short: Options = QUICK if given.quick else {}
    refined = study(REFINED if not given.quick else {"as it is": {}}, short)
    studied = {"as it is": refined["as it is"]}
    if not given.quick:
        studied |= study({name: o for name, o in STUDIED.items() if o}, short)
    let_go = study(LET_GO if not given.quick else {"drag alone": {"release": 0.05}}, short)
    tables = {
        "six": six_table([r for r in refined["as it is"] if "failed" not in r]),
        "refined": study_table(refined, displacement("z_displacement_m")),
        "refined-largest": study_table(refined, displacement("z_peak_m")),
        "refined-friction": study_table(refined, number("c_f")),
        "studied": study_table(studied, displacement("z_displacement_m"), ordered=True),
        "studied-largest": study_table(studied, displacement("z_peak_m"), ordered=True),
        "let-go": let_go_table(let_go),
    }
    if not (given.quick or given.no_write):
        for name, text in tables.items():
            common.put(text, PAGE, f"sutures-{name}")
    return common.show(
        {"refined": refined, "studied": studied, "let_go": let_go}, list(tables.values()), given.json
    )


if __name__ == "__main__":
    main()
