"""Time it takes to pull every bend for one second, with both presets.

Wall time is what one waits; processor time is the same on a machine that does nothing else.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

from benchmarks import common
from torsade.protocols.prison_escape import PrisonEscape


def pulled(name: str, path: Any, preset: str, duration: float, repeats: int) -> dict[str, Any]:
    """Median times [s] of a run, kernels warm; a bend that slips ends its run early."""
    what = {"knot": name} if path is None else {"centerline": str(path)}
    runs = []
    for _ in range(repeats):
        began = common.CLOCK()
        result = PrisonEscape(preset=preset, duration=duration, **what).run()
        runs.append((common.CLOCK() - began, PrisonEscape.report(result)))
    report = runs[0][1]
    wall = statistics.median(each["wall_s"] for _, each in runs)
    processor = statistics.median(taken for taken, _ in runs)
    simulated = float(report["times_s"][-1])
    return {
        "bend": name if path is None else path.name,
        "preset": preset,
        "steps": report["steps"],
        "simulated_s": simulated,
        "wall_s": wall,
        "wall_over_simulated": wall / simulated,
        "processor_over_simulated": processor / simulated,
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--data", help="folder of two-strand centerlines, such as reef.csv")
    given = options.parse_args(arguments)
    files, note = common.data_files(given.data, common.BENDS)
    shapes: list[tuple[str, Any]] = [(name, None) for name in common.BUILT_IN]
    shapes += list(files.items())
    duration, repeats = (0.005, 1) if given.quick else (1.0, 3)
    rows = []
    for preset in ("standard", "published"):
        pulled("reef", None, preset, 0.005, 1)  # compile, or load what is compiled
        rows += [pulled(n, p, preset, duration, repeats) for n, p in shapes[: 1 if given.quick else None]]
    slowest = max(rows, key=lambda row: row["wall_over_simulated"])
    found = {"rows": rows, "slowest": slowest["wall_over_simulated"]}
    heads = (
        "bend",
        "preset",
        "steps",
        "simulated [s]",
        "wall [s]",
        "wall / simulated",
        "processor / simulated",
    )
    tables = [
        common.table(heads, [list(row.values()) for row in rows]),
        f"slowest: {slowest['bend']}, {slowest['preset']}, {slowest['wall_over_simulated']:.2f} s "
        "of wall time for a second",
        *([note] if note else []),
    ]
    return common.show(found, tables, given.json)


if __name__ == "__main__":
    main()
