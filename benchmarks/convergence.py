"""Whether results of the standard preset depend on resolution: nodes doubled, tolerance tightened tenfold.

Writes its table into docs/convergence.md, between two marks, unless `--no-write` is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks import common
from torsade.motion.overdamped import Stepping
from torsade.protocols.prison_escape import PrisonEscape
from torsade.protocols.pulled import STANDARD_SPACING

PAGE = Path(__file__).parents[1] / "docs" / "convergence.md"
SPACING_LIMIT, TOLERANCE_LIMIT = 0.03, 0.01
"""Changes of c_f, and of the thief's slip time, that are allowed."""


def outcome(what: dict[str, str], spacing: float, tolerance: float, duration: float) -> dict[str, Any]:
    """c_f and slip time [s] of a bend; spacing in radii."""
    spec = PrisonEscape(spacing=spacing * common.NYLON.radius, tolerance=tolerance, duration=duration, **what)
    result = spec.run()
    report = PrisonEscape.report(result)
    nodes = int(result.dataset.sizes["node"])
    return {"nodes": nodes, "c_f": report["c_f"], "slipped_at_s": report["slipped_at_s"]}


def study(
    what: dict[str, str], name: str, spacing: float, tolerance: float, duration: float
) -> dict[str, Any]:
    """A bend at the standard resolution, and how its numbers move when that is refined."""
    base = outcome(what, spacing, tolerance, duration)
    fine = outcome(what, spacing / 2, tolerance, duration)
    tight = outcome(what, spacing, tolerance / 10, duration)
    row = {"bend": name, **base}
    for label, other in (("nodes_doubled", fine), ("tolerance_tightened", tight)):
        for key in ("c_f", "slipped_at_s"):
            row[f"{key}_{label}"] = _change(base[key], other[key])
    return row


def _change(before: float | None, after: float | None) -> float | None:
    return None if before is None or after is None else after / before - 1


def worst(rows: Sequence[dict[str, Any]], label: str) -> float:
    """Largest change of c_f, and of the slip time of a thief."""
    keys = [(row, "c_f") for row in rows]
    keys += [(row, "slipped_at_s") for row in rows if "thief" in row["bend"]]
    changes = [row[f"{key}_{label}"] for row, key in keys]
    return max((abs(change) for change in changes if change is not None), default=0.0)


def page_table(found: dict[str, Any]) -> str:
    """The table and what it says, in Markdown."""
    percent = lambda change: "-" if change is None else f"{100 * change:+.2f} %"  # noqa: E731
    heads = (
        "bend", "nodes", "c_f", "slips at [s]", "c_f, nodes doubled", "slip, nodes doubled",
        "c_f, tolerance / 10", "slip, tolerance / 10",
    )  # fmt: skip
    body = []
    for row in found["rows"]:
        c_f, slip = row["c_f"], row["slipped_at_s"]
        body.append(
            [
                row["bend"], row["nodes"], "-" if c_f is None else f"{c_f:.2f}",
                "-" if slip is None else f"{slip:.3f}",
                *(percent(row[f"{k}_{label}"]) for label in ("nodes_doubled", "tolerance_tightened")
                  for k in ("c_f", "slipped_at_s")),
            ]
        )  # fmt: skip
    nodes, tolerance = found["worst_nodes_doubled"], found["worst_tolerance_tightened"]
    return (
        f"Spacing {found['spacing']:g} radii, tolerance {found['tolerance']:g}; changes when "
        f"the number of nodes\nis doubled, and when the tolerance is tightened tenfold.\n\n"
        f"{common.table(heads, body)}\n\n"
        f"Largest change of c_f or of a thief's slip time: {100 * nodes:.2f} % with twice the nodes\n"
        f"(allowed: {100 * SPACING_LIMIT:g} %), {100 * tolerance:.2f} % with a tenth of the tolerance "
        f"(allowed: {100 * TOLERANCE_LIMIT:g} %)."
    )


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--data", help="folder of two-strand centerlines, such as reef.csv")
    options.add_argument("--no-write", action="store_true", help="leave docs/convergence.md as it is")
    options.add_argument("--spacing", type=float, default=STANDARD_SPACING, help="in radii")
    options.add_argument("--tolerance", type=float, default=Stepping().tolerance, help="in radii")
    given = options.parse_args(arguments)
    files, note = common.data_files(given.data, common.BENDS)
    shapes = [(name, {"centerline": str(path)}) for name, path in files.items()]
    shapes += [(f"{name} (built-in)", {"knot": name}) for name in common.BUILT_IN]
    if given.quick:
        shapes = [("reef (built-in)", {"knot": "reef"})]
    duration = 0.004 if given.quick else 1.0
    rows = [study(what, name, given.spacing, given.tolerance, duration) for name, what in shapes]
    found = {
        "spacing": given.spacing,
        "tolerance": given.tolerance,
        "rows": rows,
        "worst_nodes_doubled": worst(rows, "nodes_doubled"),
        "worst_tolerance_tightened": worst(rows, "tolerance_tightened"),
    }
    text = page_table(found)
    if not (given.quick or given.no_write):
        common.put(text, PAGE, "convergence")
    return common.show(found, [text, *([note] if note else [])], given.json)


if __name__ == "__main__":
    main()
