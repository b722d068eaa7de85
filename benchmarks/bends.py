"""Wall time of pulling every bend for one second, with both presets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks import common
from torsade.protocols.prison_escape import PrisonEscape


def pulled(name: str, path: Any, preset: str, duration: float, repeats: int) -> dict[str, Any]:
    """Median wall time [s] of a run, kernels warm; a bend that slips ends its run early."""
    what = {"knot": name} if path is None else {"centerline": str(path)}
    runs = []
    for _ in range(repeats):
        runs.append(PrisonEscape(preset=preset, duration=duration, **what).run())
    runs.sort(key=lambda result: result.dataset.attrs["wall_s"])
    report = PrisonEscape.report(runs[len(runs) // 2])
    simulated = float(report["times_s"][-1])
    return {
        "bend": name if path is None else path.name,
        "preset": preset,
        "steps": report["steps"],
        "simulated_s": simulated,
        "wall_s": report["wall_s"],
        "wall_over_simulated": report["wall_s"] / simulated,
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
    heads = ("bend", "preset", "steps", "simulated [s]", "wall [s]", "wall / simulated")
    tables = [
        common.table(heads, [list(row.values()) for row in rows]),
        f"slowest: {slowest['bend']}, {slowest['preset']}, {slowest['wall_over_simulated']:.2f} s "
        "of wall time for a second",
        *([note] if note else []),
    ]
    return common.show(found, tables, given.json)


if __name__ == "__main__":
    main()
