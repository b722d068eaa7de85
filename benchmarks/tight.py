"""Ropelengths of tight knots beside those that are listed, their times, and how they converge with nodes.

The listed ones are KnotInfo's, after Ashton, Cantarella, Piatek and Rawdon (2011). Times are of the
processor, one thread, with kernels compiled before.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benchmarks import common
from torsade.knots import tighten
from torsade.knots.loose import listed_ropelength, loose_knot
from torsade.topology import writhe
from torsade.topology.table import contents

CROSSINGS = 7
SPACINGS = (0.4, 0.3, 0.2, 0.15, 0.1)
"""Of nodes [radii], for the study of convergence."""


def measure(name: str, **options: Any) -> dict[str, Any]:
    """One knot made tight."""
    loose = loose_knot(name)
    began = common.CLOCK()
    knot = tighten(loose, **options)
    taken = common.CLOCK() - began
    listed = listed_ropelength(name)
    return {
        "knot": name,
        "L/h": knot.ropelength,
        "listed": listed,
        "above_percent": None if listed is None else 100 * (knot.ropelength / listed - 1),
        "Wr": writhe(knot.strands, True),
        "nodes": sum(len(x) for x in knot.strands),
        "contacts": len(knot.contacts),
        "kinks": len(knot.kinks),
        "residual": knot.residual,
        "s": taken,
    }


def convergence(name: str, spacings: Sequence[float]) -> list[dict[str, Any]]:
    """The same knot with more and more nodes."""
    whole = listed_ropelength(name) or 0.0
    return [measure(name, nodes=round(whole / spacing), tries=0) for spacing in spacings]


def lines(rows: Sequence[dict[str, Any]]) -> str:
    """A Markdown table of measurements."""
    heads = ["knot", "L/h", "listed", "above, %", "Wr", "nodes", "contacts", "kinks", "residual", "s"]
    shown = [
        [
            row["knot"], f"{row['L/h']:.4f}", "-" if row["listed"] is None else f"{row['listed']:g}",
            row["above_percent"], f"{row['Wr']:+.3f}", row["nodes"], row["contacts"], row["kinks"],
            f"{row['residual']:.1e}", row["s"],
        ]
        for row in rows
    ]  # fmt: skip
    return common.table(heads, shown)


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--crossings", type=int, default=CROSSINGS, help="knots through so many crossings")
    chosen = options.parse_args(arguments)
    names = [name for name in contents()["knots"] if int(name.split("_")[0]) <= chosen.crossings]
    measure("3_1", tries=0)  # compiles
    if chosen.quick:
        rows, study = [measure("3_1", tries=0)], convergence("3_1", SPACINGS[:1])
    else:
        rows = [measure(name) for name in [*names, "L2a1", "L5a1", "L6a4"]]
        study = convergence("3_1", SPACINGS)
    clean = [{key: value for key, value in row.items() if value is not None} for row in rows]
    return common.show({"knots": clean, "convergence": study}, [lines(rows), lines(study)], chosen.json)


if __name__ == "__main__":
    main()
