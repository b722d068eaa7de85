"""The numbers of chapter 4's bends, and how far they move when mesh and step are refined.

Pulls all 27 bends with both presets, again with twice the nodes and a tenth of the tolerance (`standard`) and
with half the step (`published`), and writes its tables into docs/chapter-4.md, between marks, unless
`--no-write` is given. `--time` measures instead how long all 54 runs take from scratch.
"""

from __future__ import annotations

import math
import os
import resource
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks import common
from torsade.figures import bends, figure_4_1, rules
from torsade.figures.base import Choice, Preset, Table
from torsade.figures.runs import results
from torsade.protocols.prison_escape import PrisonEscape
from torsade.protocols.pulled import PUBLISHED_STEP, STANDARD_SPACING

PAGE = Path(__file__).parents[1] / "docs" / "chapter-4.md"
ALLOWED = 60.0
"""Wall time [s] in which all runs are to be done on two cores."""

REFINED: Mapping[str, tuple[Preset, dict[str, float]]] = {
    "nodes doubled": ("standard", {"spacing": STANDARD_SPACING / 2 * common.NYLON.radius}),
    "tolerance / 10": ("standard", {"tolerance": 1e-3}),
    "step / 2": ("published", {"fixed_step": PUBLISHED_STEP / 2}),
}
"""What is refined of which preset."""

ORDERS = (
    ("granny", "grief", 1.0),
    ("reef", "thief", 1.0),
    ("reef", "granny", 1.0),
    ("thief", "grief", 1.0),
    ("zeppelin14", "alpine13", 1.0),
    ("hunter14", "hunter13", 2.0),
    ("hunter23", "hunter13", 2.0),
)
"""Stronger bend, weaker bend, and by what factor, as the thesis has them."""

SPACINGS = (0.5, 0.45, 0.4, 0.35, 0.3, 0.25, 0.2)  # [radii]
"""Distances between nodes for the one bend whose arrangement depends on them."""

Rows = dict[tuple[str, str], dict[str, Any]]


def refined(choice: Choice, fields: Mapping[str, float], preset: Preset) -> dict[str, PrisonEscape]:
    """The specifications of a preset with other fields."""
    plain = bends.specs(Choice((preset,), choice.quick))
    return {label: PrisonEscape(**(spec.stored() | fields)) for label, spec in plain.items()}


def tables(choice: Choice, folder: Path) -> dict[str, Table]:
    """The table of bends, by what is refined; the plain one is called ""."""
    asked = {"": bends.specs(choice)}
    asked |= {name: refined(choice, fields, preset) for name, (preset, fields) in REFINED.items()}
    every = {f"{label}, {name}": spec for name, specs in asked.items() for label, spec in specs.items()}
    found = results(every, folder)
    return {
        name: bends.table({label: found[f"{label}, {name}"] for label in specs}, choice)
        for name, specs in asked.items()
    }


def by_run(table: Table) -> Rows:
    """Rows of a table by knot and preset."""
    found = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    return {(row["knot"], row["preset"]): row for row in found}


def knots(rows: Rows) -> list[str]:
    """Bends in the order of their friction with the first preset."""
    return list(dict.fromkeys(knot for knot, _ in rows))


def bends_text(rows: Rows, choice: Choice) -> str:
    """Counts of all bends, and what is measured with each preset."""
    heads = ["bend", "pulled", "N", "N, fewest", "Wr", "τ", "Γ", "Γ, drawings", "Wh"]
    for preset in choice.presets:
        heads += [f"c_f, {preset}", "slips, s", "ΣF, N"]
    body = []
    for knot in knots(rows):
        row = rows[knot, choice.presets[0]]
        least, most = (f"{row[name]:.3g}" for name in ("Gamma_least", "Gamma_greatest"))
        line = [knot, row["pulled"], row["N"], row["N_fewest"], row["Wr"], row["tau"], row["Gamma"]]
        line += [least if least == most else f"{least} to {most}", row["Whitney"]]
        for preset in choice.presets:
            of = rows[knot, preset]
            line += [_fixed(of["c_f"], 1), _fixed(of["slipped_at_s"], 2, ""), _fixed(of["compression_N"], 0)]
        body.append(line)
    return common.table(heads, body)


def shapes_text(rows: Rows, choice: Choice) -> str:
    """What is measured at the end of the window."""
    quantities = {"twist_A_rad": 1, "twist_B_rad": 1, "log_strain_max": 2, "rotation_rad": 2}
    shown = {k: n for k, n in quantities.items() if any(row[k] is not None for row in rows.values())}
    words = {"twist_A_rad": "twist A, rad", "twist_B_rad": "twist B, rad"}
    words |= {"log_strain_max": "largest log strain", "rotation_rad": "rotation, rad"}
    heads = ["bend", *(f"{words[k]}, {preset}" for preset in choice.presets for k in shown)]
    body = [
        [_marked(knot), *(_fixed(rows[knot, p][k], n) for p in choice.presets for k, n in shown.items())]
        for knot in knots(rows)
    ]
    return common.table(heads, body)


def refined_text(found: Mapping[str, Rows]) -> str:
    """Changes of what is measured on each bend, in per cent; of angles, in radians."""
    relative = {"c_f": "c_f", "slipped_at_s": "slip", "compression_N": "ΣF", "log_strain_max": "strain"}
    angles = {"twist_A_rad": "twist A", "twist_B_rad": "twist B", "rotation_rad": "rotation"}
    angles = {k: word for k, word in angles.items() if any(r[k] is not None for r in found[""].values())}
    parts = []
    for name, (preset, _) in REFINED.items():
        heads = ["bend", *(f"{w}, %" for w in relative.values()), *(f"{w}, rad" for w in angles.values())]
        body = []
        for knot, of in found[name]:
            before, after = found[""][knot, of], found[name][knot, of]
            line = [_change(before[k], after[k]) for k in relative]
            body.append([_marked(knot), *line, *(_fixed(_less(after[k], before[k]), 1, "-") for k in angles)])
        worst = max((abs(float(line[1])) for line in body if line[1] not in ("-", "")), default=0.0)
        parts.append(
            f"`{preset}`, {name} (largest change of c_f: {worst:.2f} %):\n\n{common.table(heads, body)}"
        )
    return "\n\n".join(parts)


def orders_text(found: Mapping[str, Rows]) -> str:
    """c_f of the stronger over that of the weaker, in the pairs that the thesis names."""
    columns = [("standard", ""), ("standard", "nodes doubled"), ("standard", "tolerance / 10")]
    columns += [("published", ""), ("published", "step / 2")]
    heads = ["c_f of", "over", "thesis", *(", ".join(filter(None, column)) for column in columns)]
    body = []
    for strong, weak, factor in ORDERS:
        line = []
        for preset, name in columns:
            pair = [found[name].get((knot, preset), {}).get("c_f") for knot in (strong, weak)]
            line.append("-" if None in pair else f"{pair[0] / pair[1]:.2f}")
        body.append([strong, weak, "above 1" if factor == 1 else f"about {factor:g}", *line])
    return common.table(heads, body)


def rules_text(found: Mapping[str, Table], choice: Choice) -> str:
    """How each rule orders c_f: Kendall's tau_b, intervals over bends and over knots, and pairs.

    After the pairs stands their net share of all: (right - wrong) over the number of all pairs.
    """
    plain = _by_rule(rules.rules_table(found[""], choice))
    fine = _by_rule(rules.rules_table(found["nodes doubled"], Choice(("standard",), choice.quick)))
    words = ("τ_b", "by knot", "pairs", "net")
    heads = ["bends", "rule", *(f"{p}: {w}" for p in choice.presets for w in words)]
    body = []
    for _, which, rule in [key for key in plain if key[0] == choice.presets[0]]:
        line = []
        for preset in choice.presets:
            row = plain[preset, which, rule]
            line += [
                f"{_fixed(row['kendall'], 2)} {_between(row, 'kendall_low', 'kendall_high')}",
                _between(row, "kendall_low_by_knot", "kendall_high_by_knot"),
                f"{row['pairs_right']} : {row['pairs_wrong']}",
                _fixed(row["net"], 2),
            ]
        refined = fine.get(("standard", which, rule), {}).get("kendall")
        body.append([which, rule, *line, _fixed(refined, 2)])
    return common.table([*heads, "standard, nodes doubled: τ_b"], body)


def rankings_text(found: Mapping[str, Table], choice: Choice) -> str:
    """How total compression ranks bends as c_f does."""
    heads = ("preset", "refined", "bends", "n", "Kendall τ_b", "Spearman ρ", "pairs alike : reversed")
    body = []
    for name, table in found.items():
        presets = choice.presets if not name else (REFINED[name][0],)
        ranked = figure_4_1.rankings(table, Choice(presets, choice.quick))
        for values in ranked.rows:
            row = dict(zip(ranked.columns, values, strict=True))
            said = [
                f"{_fixed(row[k], 2)} {_between(row, f'{k}_low', f'{k}_high')}"
                for k in ("kendall", "spearman")
            ]
            pairs = f"{row['pairs_alike']} : {row['pairs_reversed']}"
            body.append((row["preset"], name or "-", row["bends"], row["n"], *said, pairs))
    return common.table(heads, body)


def pairs_text(found: Mapping[str, Table], choice: Choice) -> str:
    """Pairs of the thesis's bends in which all three rules are wrong, by more than 5 per cent of c_f.

    The last column marks those in which they are not all three wrong with the fewest crossings for N.
    """
    listed = rules.disagreements(found[""], choice)
    fine = {preset: by_run(found[name]) for name, (preset, _) in reversed(REFINED.items())}
    heads = ("preset", "N, τ, Γ say that", "is above", "c_f of both", "their ratio", "refined", "fewest N")
    body = []
    for values in listed.rows:
        row = dict(zip(listed.columns, values, strict=True))
        names, preset = (row["stronger_by_rules"], row["weaker_by_rules"]), row["preset"]
        if row["c_f_ratio"] < 0.95:
            both = f"{row['c_f_stronger']:.1f}, {row['c_f_weaker']:.1f}"
            strong, weak = (fine[preset][name, preset]["c_f"] for name in names)
            holds = "" if row["with_fewest_N"] else "not so"
            body.append((preset, *names, both, f"{row['c_f_ratio']:.2f}", f"{strong / weak:.2f}", holds))
    return common.table(heads, body)


def zeppelin_text(folder: Path, quick: bool) -> str:
    """c_f and speeds of zeppelin14 with `standard`, for several distances between nodes."""
    duration = 0.02 if quick else 1.0
    specs = {
        f"{apart:g}": PrisonEscape(knot="zeppelin14", spacing=apart * common.NYLON.radius, duration=duration)
        for apart in (SPACINGS[:1] if quick else SPACINGS)
    }
    body = []
    for apart, result in results({f"zeppelin14, {k} h": spec for k, spec in specs.items()}, folder).items():
        speed = 1e3 * result.dataset["pull_speed"].values
        shown = [f"{speed[round(share * (len(speed) - 1))]:.1f}" for share in (0.25, 0.35, 0.45, 0.6, 1.0)]
        body.append((apart.split(", ")[1], result.dataset.sizes["node"], _fixed(result.c_f, 1), *shown))
    times = (f"{share * duration:g} s" for share in (0.25, 0.35, 0.45, 0.6, 1.0))
    return common.table(("nodes apart", "nodes", "c_f", *(f"mm/s at {t}" for t in times)), body)


def timing(choice: Choice) -> dict[str, Any]:
    """Time [s] of all runs from scratch, kernels being compiled, and of the table of them."""
    PrisonEscape(knot="reef", duration=1e-3, frames=1).run()
    specs = bends.specs(choice)
    with tempfile.TemporaryDirectory() as folder:
        before, began = _children(), time.perf_counter()
        found = results(specs, Path(folder))
        wall, processor = time.perf_counter() - began, _children() - before
        began = time.perf_counter()
        bends.table(found, choice)
        table = time.perf_counter() - began
    taken = {"runs": len(specs), "cores": os.cpu_count(), "wall [s]": wall, "processor [s]": processor}
    return taken | {"table [s]": table, "allowed [s]": ALLOWED}


def _children() -> float:
    """Processor time of all processes that were started and have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _by_rule(table: Table) -> dict[tuple[str, str, str], dict[str, Any]]:
    rows = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    return {(row["preset"], row["bends"], row["rule"]): row for row in rows}  # type: ignore[misc]


def _between(row: Mapping[str, Any], low: str, high: str) -> str:
    ends = [_fixed(row[name], 2, "") for name in (low, high)]
    return f"[{ends[0]}, {ends[1]}]" if all(ends) else ""


def _less(after: float | None, before: float | None) -> float | None:
    return None if after is None or before is None else after - before


def _change(before: float | None, after: float | None) -> str:
    """A change in per cent; - where there is nothing before or after, and nothing where neither."""
    if before is None or after is None:
        return "" if before is after else "-"
    return f"{round(100 * (after / before - 1), 2) + 0.0:+.2f}"


def _marked(knot: str) -> str:
    """A bend's name, with a star where chance decides how it twists and turns."""
    return f"{knot}*" if knot in bends.BY_CHANCE else knot


def _fixed(value: float | None, digits: int, without: str = "-") -> str:
    """A number with so many digits after the point."""
    if value is None or math.isnan(value):
        return without
    return f"{round(value, digits) + 0.0:.{digits}f}"


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/chapter-4.md as it is")
    options.add_argument("--out", help="folder to keep the runs in; by default they are not kept")
    options.add_argument("--time", action="store_true", help="measure how long all runs take from scratch")
    given = options.parse_args(arguments)
    choice = Choice(quick=given.quick)
    if given.time:
        taken = timing(choice)
        text = common.table(list(taken), [list(taken.values())])
        if not (given.quick or given.no_write):
            common.put(text, PAGE, "time")
        return common.show(taken, [text], given.json)
    with tempfile.TemporaryDirectory() as folder:
        found = tables(choice, Path(given.out or folder))
        zeppelin = zeppelin_text(Path(given.out or folder), given.quick)
    rows = {name: by_run(table) for name, table in found.items()}
    texts = {
        "bends": bends_text(rows[""], choice),
        "shapes": shapes_text(rows[""], choice),
        "orders": orders_text(rows),
        "rankings": rankings_text(found, choice),
        "rules": rules_text(found, choice),
        "pairs": pairs_text(found, choice),
        "zeppelin": zeppelin,
        "refined": refined_text(rows),
    }
    if not (given.quick or given.no_write):
        for name, text in texts.items():
            common.put(text, PAGE, name)
    numbers = {name or "plain": list(of.values()) for name, of in rows.items()}
    return common.show(numbers, list(texts.values()), given.json)


if __name__ == "__main__":
    main()
