"""The map of chapter 5: 238 batteries in one sweep, killed half-way and gone on with, and what it shows.

Writes its tables into docs/batteries.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import json
import resource
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from benchmarks.batteries import PAGE, run, times, variants
from benchmarks.sweeps import alike, begun, kill, stored, until
from torsade.figures import battery_map
from torsade.figures.base import Choice, Table
from torsade.figures.ranking import agreement
from torsade.protocols.charging import AT_REST
from torsade.sweep import Catalogue

WORKERS = 2
LOOSE = 100.0
"""L/h at which no knot through 7 crossings has to be stretched."""

Found = dict[str, Any]

DESIGN = 'protocol = "battery"\n\n[fixed]\n{fixed}\n[grid]\nknot = {knots}\ntwist = {twists}\n'


def design(folder: Path, quick: bool) -> Path:
    """The file of the sweep."""
    path = folder / "batteries.toml"
    knots = battery_map.QUICK_KNOTS if quick else battery_map.KNOTS
    twists = battery_map.QUICK_TWISTS if quick else battery_map.TWISTS
    fixed = "".join(f"{name} = {json.dumps(value)}\n" for name, value in battery_map.QUICK.items())
    path.write_text(
        DESIGN.format(
            fixed=fixed if quick else "", knots=json.dumps(list(knots)), twists=json.dumps(list(twists))
        )
    )
    return path


def swept(path: Path, folder: Path) -> Found:
    """The sweep without disturbance: how long it took, and what of it on processors."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    out, _ = begun(path, folder, "--workers", str(WORKERS)).communicate()
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    last = json.loads(out)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"points": last["points"], "failed": last["failed"], "wall_s": wall, "processor_s": cpu}


def killed(path: Path, folder: Path, points: int) -> Found:
    """The sweep with its command killed (SIGKILL) when half is stored, and gone on with."""
    running = begun(path, folder, "--workers", str(WORKERS), errors=subprocess.DEVNULL)
    half = until(lambda: stored(folder) >= points / 2, running)
    if half:
        kill(running.pid)
    running.communicate()
    there = stored(folder)
    out, _ = begun(path, folder, "--workers", str(WORKERS)).communicate()
    return {"stored_when_killed": there, "ran_afterwards": json.loads(out)["ran"], "killed": half}


def checks(catalogue: Catalogue) -> Found:
    """What has to hold of every battery before the cut, and of its energy after it."""
    sql = (
        "SELECT count(*), max(link_error), count(*) FILTER (knot_kept), "
        f"count(*) FILTER (loss_per_T0 < {AT_REST}), max(loss_per_T0), max(balance_error), "
        "count(*) FILTER (discharge_time_T0_1 IS NOT NULL) FROM runs WHERE status = 'done'"
    )
    names = ("batteries", "link_error", "knot_kept", "at_rest", "loss_per_T0", "balance_error", "emptied")
    return dict(zip(names, catalogue.query(sql).rows[0], strict=True))


def changes() -> dict[str, Mapping[str, Any]]:
    """How resonant batteries are run once more: all ways but a finer tolerance, which moves nothing."""
    return {name: options for name, options in variants().items() if not name.startswith("tolerance")}


def resonances(table: Table, short: Mapping[str, Any]) -> list[Found]:
    """Every resonant battery once more, refined and otherwise, with its slowness then."""
    columns = ("knot", "twist_density", "T10_T0", "slowness", "resonant", "peak", "cut_at")
    rows = [dict(zip(columns, row, strict=True)) for row in table.only(*columns).rows]
    found = []
    for row in (row for row in rows if row["resonant"]):
        median = row["T10_T0"] / row["slowness"]
        for name, options in changes().items():
            place = {"cut_at": (row["cut_at"] + 0.25) % 1.0} if name.startswith("cut") else {}
            if name == "as it is":
                then = row["slowness"]
            else:
                one = run(row["knot"], row["twist_density"], **{**options, **place, **short})
                tenth = times(one)[1]
                then = None if tenth is None else tenth / median
            found.append({**row, "variant": name, "slowness": then})
    return found


def loose(knots: Sequence[str], short: Mapping[str, Any]) -> list[Found]:
    """Untwisted batteries long enough not to be stretched."""
    options = {**short, "slenderness": LOOSE, "nodes": 80 if short else 200}
    return [run(knot, 0.0, **options) for knot in knots]


def crossing(table: Table) -> list[float]:
    """Where twist comes to exceed bending along |h theta'|, for every knot and sign, between neighbours."""
    found = []
    columns = ("knot", "twist_density", "bend_E0", "twist_E0")
    rows = np.array([row[1:] for row in table.only(*columns).rows], float)
    names = table.column("knot")
    for knot in dict.fromkeys(names):
        own = rows[[name == knot for name in names]]
        for sign in (1, -1):
            half = own[sign * own[:, 0] >= 0]
            half = half[np.argsort(np.abs(half[:, 0]))]
            # Nearly straight, as twist energy grows as the square.
            ratio = np.sqrt(half[:, 2] / half[:, 1]) - 1
            after = np.flatnonzero(ratio > 0)
            if len(after) and after[0] > 0:
                k = int(after[0])
                share = -ratio[k - 1] / (ratio[k] - ratio[k - 1])
                found.append(float(abs(half[k - 1, 0]) + share * abs(half[k, 0] - half[k - 1, 0])))
    return found


def grid_table(table: Table, name: str, digits: int = 3) -> str:
    """A column of the map, knots down and twists across; resonant batteries are printed bold."""
    columns = ("knot", "twist_density", name, "resonant")
    rows = table.only(*columns).rows
    twists = sorted({row[1] for row in rows})
    cells = []
    for knot in dict.fromkeys(row[0] for row in rows):
        line = [knot]
        for twist in twists:
            value, bold = next(row[2:] for row in rows if row[:2] == (knot, twist))
            text = "-" if value is None or not np.isfinite(value) else f"{value:.{digits}g}"
            line.append(f"**{text}**" if bold else text)
        cells.append(line)
    return common.table(["knot", *(f"{twist:+g}" for twist in twists)], cells)


def effort_table(found: Mapping[str, Any]) -> str:
    one, two = found["swept"], found["killed"]
    heads = ("batteries", "failed", "wall [s]", "processor [s]", "killed at", "run afterwards", "same bits")
    row = (one["points"], str(one["failed"]), one["wall_s"], one["processor_s"], two["stored_when_killed"],
           two["ran_afterwards"], f"{found['alike']['the_same']} of {found['alike']['shared']}")  # fmt: skip
    return common.table(heads, [row])


def checks_table(found: Found) -> str:
    heads = ("batteries", "Lk kept to", "same knot in every frame", "at rest when cut",
             "most lost in T_0 then", "energy and drag apart by", "emptied")  # fmt: skip
    cells = [f"{x:.1e}" if isinstance(x, float) else x for x in found.values()]
    return common.table(heads, [cells])


def resonance_table(rows: Sequence[Found]) -> str:
    """Slowness of each resonant battery in all variants."""
    names = list(changes())
    cells = []
    for key in dict.fromkeys((row["knot"], row["twist_density"]) for row in rows):
        own = [row for row in rows if (row["knot"], row["twist_density"]) == key]
        peak = "yes" if own[0]["peak"] else "no"
        cells.append([key[0], f"{key[1]:+g}", own[0]["T10_T0"], peak, *(row["slowness"] for row in own)])
    return common.table(["knot", "h θ′", "to 10 % [T_0]", "peak", *names], cells)


def loose_table(rows: Sequence[Found]) -> str:
    cells = []
    for found in sorted(rows, key=lambda row: -(times(row)[1] or 0.0)):
        knots = ", ".join(found.get("intermediate_knots", ())) or "-"
        energy = None if "failed" in found else found["energy_E0"]["total"]
        cells.append([found["knot"], energy, *times(found), knots])
    return common.table(["knot", "energy [E_0]", "50 %", "10 %", "1 %", "knots on the way"], cells)


LOOSE_CAUSES: Mapping[str, Callable[[Found], float]] = {
    "non-planarity on the way": lambda row: row["non_planarity"]["on_the_way"],
    "non-planarity, charged": lambda row: row["non_planarity"]["charged"],
    "torsion on the way": lambda row: row["torsion"]["on_the_way"],
    "size of the writhe": lambda row: abs(row["writhe"]),
    "share of stretch and contact": lambda row: (
        (row["energy_E0"]["stretch"] + row["energy_E0"]["contact"]) / row["energy_E0"]["total"]
    ),
    "a trefoil on the way": lambda row: float(
        any("3_1" in name for name in (row["knot"], *row["intermediate_knots"]))
    ),
}


def loose_causes_table(rows: Sequence[Found]) -> str:
    """Correlations of the times of untwisted, unstretched batteries."""
    known = [row for row in rows if "failed" not in row and None not in times(row)]
    cells = []
    for name, cause in LOOSE_CAUSES.items() if len(known) > 3 else ():
        values = [cause(row) for row in known]
        found = [agreement(values, [times(row)[k] for row in known]).spearman for k in (1, 2)]
        cells.append([name, *(f"{rho.value:+.2f} ({rho.low:+.2f}, {rho.high:+.2f})" for rho in found)])
    return common.table(["", "to 10 %", "to 1 %"], cells)


def causes_table(table: Table) -> str:
    """Correlations with their intervals, the time to 10 and 1 %."""
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    parts = list(dict.fromkeys(row["h_theta_prime"] for row in rows))
    shares = ("10 %", "1 %")
    cells = []
    for cause in dict.fromkeys(row["cause"] for row in rows):
        line = [cause]
        for part in parts:
            for share in shares:
                wanted = (part, cause, share)
                one = [r for r in rows if (r["h_theta_prime"], r["cause"], r["time_to"]) == wanted]
                line.append(
                    f"{one[0]['spearman']:+.2f} ({one[0]['low']:+.2f}, {one[0]['high']:+.2f})" if one else "-"
                )
        cells.append(line)
    return common.table(["", *(f"h θ′ {part}, to {share}" for part in parts for share in shares)], cells)


def table_of(table: Table) -> str:
    return common.table(table.columns, table.rows)


def tables_of(found: Mapping[str, Any], shown: Mapping[str, Table]) -> dict[str, str]:
    """All tables, by the name of their place in the page."""
    return {
        "map-effort": effort_table(found),
        "map-checks": checks_table(found["checks"]),
        "map-times": grid_table(shown["map"], "T10_T0"),
        "map-last": grid_table(shown["map"], "T1_T0"),
        "map-split": table_of(shown["split"]),
        "map-causes": causes_table(shown["causes"]),
        "map-resonances": resonance_table(found["resonances"]),
        "map-loose": loose_table(found["loose"]),
        "map-loose-causes": loose_causes_table(found["loose"]),
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    parser = common.parser(__doc__)
    parser.add_argument("--no-write", action="store_true", help=f"leave {PAGE.name} as it is")
    parser.add_argument("--out", help="folder to keep the sweeps in; by default they are not kept")
    options = parser.parse_args(arguments)
    short = battery_map.QUICK if options.quick else {}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(options.out or place)
        folder.mkdir(exist_ok=True)
        path = design(folder, options.quick)
        found: Found = {"swept": swept(path, folder / "whole")}
        found["killed"] = killed(path, folder / "killed", found["swept"]["points"])
        found["alike"] = alike(folder / "whole", folder / "killed")
        catalogue = Catalogue(folder / "whole")
        found["checks"] = checks(catalogue)
        shown = battery_map.measure(catalogue, Choice(quick=options.quick))
    found["crossing"] = crossing(shown["map"])
    found["resonances"] = resonances(shown["map"], short)
    found["loose"] = loose(battery_map.QUICK_KNOTS[:1] if options.quick else battery_map.KNOTS, short)
    tables = tables_of(found, shown)
    if not (options.no_write or options.quick):
        for name, text in tables.items():
            common.put(text, PAGE, name)
    return common.show(found, list(tables.values()), options.json)


if __name__ == "__main__":
    main()
