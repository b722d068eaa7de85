"""Topological friction c_f of the thesis's 22 pulled bends, made from their diagrams.

Beside it stands that of its own centerlines, where there are any: they are not shipped, and are read from the
folder of `--data`. Preset `published`, with its own spacing of nodes, 15 N for 1 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import torsade as ts
from benchmarks import common

CLEAR = 1.15
"""Two of the published bends that differ by more than this factor must come in the same order here."""


def measure(duration: str, **shape: Any) -> dict[str, Any]:
    """c_f, when it slips, and steps of one run."""
    result = ts.protocols.PrisonEscape(preset="published", duration=duration, **shape).run()
    report = ts.protocols.PrisonEscape.report(result)
    return {key: report[key] for key in ("c_f", "slipped_at_s", "steps", "wall_s")}


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    parser = common.parser(__doc__)
    parser.add_argument("--data", help="folder with the published centerlines, reef.csv and others")
    given = parser.parse_args(arguments)
    duration = "0.02 s" if given.quick else "1 s"
    files, note = common.data_files(given.data, common.BENDS)
    labels = list(ts.knots.variants())[: 3 if given.quick else None]
    rows: list[dict[str, Any]] = []
    for label in labels:
        row = {"label": label} | measure(duration, knot=label)
        if label in files:
            row["published"] = measure(duration, centerline=str(files[label]))["c_f"]
        rows.append(row)
    known = [row for row in rows if row.get("published") and row["c_f"]]
    wrong = [
        (a["label"], b["label"])
        for a, b in combinations(known, 2)
        if max(a["published"], b["published"]) > CLEAR * min(a["published"], b["published"])
        and (a["c_f"] < b["c_f"]) != (a["published"] < b["published"])
    ]
    heads = ("variant", "c_f", "c_f, published centerline", "slips, s", "steps", "s of wall")
    keys = ("label", "c_f", "published", "slipped_at_s", "steps", "wall_s")
    table = common.table(heads, [[row.get(key) for key in keys] for row in rows])
    said = f"pairs in another order than published, of those that differ by more than 15 %: {wrong or 'none'}"
    return common.show({"rows": rows, "wrong": wrong}, [table, said, note], given.json)


if __name__ == "__main__":
    main()
