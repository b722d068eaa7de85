"""Whether knots pulled tight and Reidemeister moves depend on resolution, and moves on length.

Writes its tables into docs/tightening.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks import common
from torsade.figures import move_energies, twist_share
from torsade.figures.base import Choice
from torsade.figures.runs import results
from torsade.material import preset
from torsade.protocols.base import Spec
from torsade.protocols.reidemeister import Reidemeister
from torsade.protocols.tighten import Tighten
from torsade.results import Result

PAGE = Path(__file__).parents[1] / "docs" / "tightening.md"

KNOT_NUMBERS = (
    "still_at_s",
    "end_to_end_m",
    "h_kappa_max",
    "total_twist_rad",
    "log_strain_max",
    "twist_share",
    "twist_adds",
)
SMALL = ("total_twist_rad", "twist_share", "twist_adds")
"""Numbers near zero, where a change in per cent says little: shown as they become."""

MOVE_NUMBERS = ("start_L_per_B", "top_L_per_B", "end_L_per_B")
LENGTHS = (50, 70, 100, 140, 200)  # [radii]

NOTHING = 1e-12
"""Energies below this, of strands that lie apart, are left out."""

FINER: Mapping[str, Mapping[str, float]] = {
    "nodes doubled": {"spacing": 0.5},
    "tolerance / 10": {"tolerance": 0.1},
    "half the speed": {"duration": 2.0},
}
"""Factors on fields of a specification."""


def refined(spec: Spec, factors: Mapping[str, float]) -> Spec:
    """A specification with some of its fields multiplied; fixed steps are refined where there are any."""
    fields = spec.stored()
    for name, factor in factors.items():
        if name == "spacing":
            value = factor * float(spec.node_spacing or 0.0)
        elif name == "tolerance" and spec.stepping.fixed_step:
            name, value = "fixed_step", factor * spec.stepping.fixed_step
        else:
            value = factor * (fields["duration"] if name == "duration" else spec.stepping.tolerance)
        fields[name] = value
    return type(spec)(**fields)


def knots(data: str | None, quick: bool) -> dict[str, Spec]:
    """Built-in knots in both presets, and the thesis's trefoil where it is given."""
    specs = twist_share.runs(Choice(quick=quick))
    files, _ = common.data_files(data, ("trefoil",))
    for path in files.values():
        for model in ("standard", "published"):
            fields = {"duration": "20 s", "frames": 1000, "until_still": twist_share.STILL, "preset": model}
            specs[f"thesis's trefoil, {model}"] = Tighten.model_validate({"centerline": str(path)} | fields)
    return specs


def study(specs: Mapping[str, Spec], ways: Sequence[str]) -> dict[str, dict[str, Result]]:
    """Every run as it is and refined in several ways, two or more at a time."""
    every = {f"{label}: plain": spec for label, spec in specs.items()}
    for way in ways:
        for label, spec in specs.items():
            if spec.node_spacing is None and way == "nodes doubled":
                continue  # on the nodes of a file, as they are
            every[f"{label}: {way}"] = refined(spec, FINER[way])
    with tempfile.TemporaryDirectory() as folder:
        found = results(every, Path(folder))
        for result in found.values():
            result.dataset.load()
    return {
        label: {way: found[f"{label}: {way}"] for way in ("plain", *ways) if f"{label}: {way}" in found}
        for label in specs
    }


def knot_rows(found: Mapping[str, Mapping[str, Result]]) -> list[dict[str, Any]]:
    """What each knot came to, and how its numbers change."""
    rows = []
    for label, by_way in found.items():
        numbers = {way: twist_share.share_of(result) for way, result in by_way.items()}
        rows.append({"run": label, "ways": numbers, "still_at_s": numbers["plain"]["still_at_s"]})
    return rows


def move_rows(found: Mapping[str, Mapping[str, Result]]) -> list[dict[str, Any]]:
    """What each move costs, and how that changes."""
    rows = []
    for label, by_way in found.items():
        numbers = {way: move_energies.barrier_of(result) for way, result in by_way.items()}
        rows.append({"run": label, "ways": numbers})
    return rows


def changes(rows: Sequence[dict[str, Any]], names: Sequence[str], ways: Sequence[str]) -> str:
    """A Markdown table with a row for every number: what it is, and its change in each way."""
    body = []
    for row in rows:
        plain = row["ways"]["plain"]
        label = row["run"].removeprefix("tighten ").removeprefix("reidemeister ")
        for name in names:
            if plain[name] is None or abs(plain[name]) < NOTHING:
                continue
            others = [row["ways"][way][name] if way in row["ways"] else None for way in ways]
            body.append([label, name, f"{plain[name]:.4g}", *(_change(name, plain[name], x) for x in others)])
    return common.table(("run", "number", "value", *ways), body)


def _change(name: str, before: float, after: float | None) -> str:
    """A change in per cent, or of `SMALL` what the number becomes; a dash where it is not known."""
    if after is None:
        return "-"
    return f"{after:.4g}" if name in SMALL else f"{100 * (after / before - 1):+.2f} %"


def lengths() -> list[dict[str, Any]]:
    """The cost of each move against the length of its strands, as slow for each as it relaxes."""
    h = preset("optomechanical").radius
    specs: dict[str, Spec] = {
        f"{name} {n}": Reidemeister.model_validate(
            {"move": move, "ends": ends, "length": n * h, "duration": 600.0 * (n / 100) ** 2, "frames": 120}
        )
        for name, (move, ends) in move_energies.MOVES.items()
        for n in LENGTHS
    }
    with tempfile.TemporaryDirectory() as folder:
        found = results(specs, Path(folder))
        return [
            {"move": name, "L_per_h": n, **move_energies.barrier_of(found[f"{name} {n}"])}
            for name in move_energies.MOVES
            for n in LENGTHS
        ]


def length_table(rows: Sequence[dict[str, Any]]) -> str:
    """Highest energies in B/L and in B h²/L³, a column for every length."""
    body = []
    for name in move_energies.MOVES if rows else ():
        own = {row["L_per_h"]: row["top_L_per_B"] for row in rows if row["move"] == name}
        body.append([f"{name}, B/L", *(f"{own[n]:.4g}" for n in LENGTHS)])
        if not name.startswith("R1"):
            body.append([f"{name}, B h²/L³", *(f"{own[n] * n**2:.0f}" for n in LENGTHS)])
    return common.table(("highest energy", *(f"L = {n} h" for n in LENGTHS)), body)


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--data", help="folder of centerlines with trefoil.csv")
    options.add_argument("--no-write", action="store_true", help="leave docs/tightening.md as it is")
    given = options.parse_args(arguments)
    still = tuple(FINER)[:2]
    tight = knots(given.data, given.quick)
    moves = move_energies.runs(Choice(quick=given.quick))
    if given.quick:
        tight, moves = ({label: specs[label] for label in list(specs)[:1]} for specs in (tight, moves))
    found = {
        "knots": knot_rows(study(tight, still)),
        "moves": move_rows(study(moves, tuple(FINER))),
        "lengths": [] if given.quick else lengths(),
    }
    tables = {
        "tight-knots": changes(found["knots"], KNOT_NUMBERS, still),
        "moves": changes(found["moves"], MOVE_NUMBERS, tuple(FINER)),
        "lengths": length_table(found["lengths"]),
    }
    if not (given.quick or given.no_write):
        for name, text in tables.items():
            common.put(text, PAGE, name)
    return common.show(found, list(tables.values()), given.json)


if __name__ == "__main__":
    main()
