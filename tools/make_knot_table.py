"""Make the table of knots that `torsade.topology.identify` looks into.

    python tools/make_knot_table.py CODES.json > src/torsade/topology/data/knots.json

CODES.json has `knots` and `links`, from name to PD code; without it, the codes of the present table are
used again. Invariants are computed here, with the package itself.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from torsade.topology.table import contents, record


def main() -> None:
    if len(sys.argv) > 1:
        codes = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
        knots, links = codes["knots"], codes["links"]
    else:
        knots = {name: row["pd"] for name, row in contents()["knots"].items()}
        links = contents()["links"]
    print('{"knots": {')
    print(_lines({name: record(pd) for name, pd in knots.items()}))
    print('}, "links": {')
    print(_lines(links))
    print("}}")


def _lines(rows: dict[str, Any]) -> str:
    """One row per line."""
    return ",\n".join(
        f"{json.dumps(name)}: {json.dumps(row, separators=(',', ':'))}" for name, row in rows.items()
    )


if __name__ == "__main__":
    main()
