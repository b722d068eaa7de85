"""Make src/torsade/knots/catalogue/tight.json: tight shapes of the prime knots through 7 crossings.

Takes a few minutes. Of two starts, the closed braid and the fiber of the drawing, the shorter result is kept;
nodes are spread anew, `SPACING` radii apart, and rounded to 1e-4 radii.
"""

from __future__ import annotations

import json
from pathlib import Path

from torsade.curve import resample
from torsade.knots.loops import SPACING, tightest
from torsade.topology.identify import identify_curves
from torsade.topology.table import entries

CROSSINGS = 7
FILE = Path(__file__).parents[1] / "src" / "torsade" / "knots" / "catalogue" / "tight.json"


def main() -> None:
    """Write the file."""
    rows = []
    for entry in (e for e in entries() if not e.name.startswith("m")):
        if entry.crossings > CROSSINGS:
            break
        knot = tightest(entry.name)
        nodes = resample(knot.strands[0] / knot.radius, spacing=SPACING, closed=True)
        nodes = (nodes - nodes.mean(axis=0)).round(4)
        assert str(identify_curves([nodes])) == entry.name
        found = {"ropelength": round(knot.ropelength, 4), "nodes": nodes.tolist()}
        rows.append(f"{json.dumps(entry.name)}: {json.dumps(found, separators=(',', ':'))}")
        print(entry.name, found["ropelength"], len(nodes), flush=True)
    FILE.write_text("{\n" + ",\n".join(rows) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
