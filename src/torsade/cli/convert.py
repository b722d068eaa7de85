"""What `torsade convert` does: curves from one file to another, cleaned on the way if asked to."""

from __future__ import annotations

import json as json_format
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsade import curve
from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files import read_centerline, write_centerline
from torsade.files.centerlines import format_of

__all__ = ["convert"]


def convert(
    given: str,
    out: str,
    length_unit: str,
    smooth: str | None,
    spacing: str | None,
    every: str,
    json: bool,
    overwrite: bool,
) -> int:
    """Read, clean, write, and say what was read and written."""
    format_of(out, reading=False)
    if Path(out).exists() and not overwrite:
        raise TorsadeError(f"{out!r} exists already; give another name, or --overwrite to replace it")
    read = read_centerline(given, length_unit)
    written, scale = read, 0.0
    if not re.fullmatch(r"\d{1,6}", every.strip(), re.A):
        raise TorsadeError(
            f"--every is {quoted(every)}; give a whole number such as 4, for every fourth node"
        )
    if smooth is not None or spacing is not None or int(every) != 1:
        from torsade.knots.measured import clean

        written = cleaned = clean(read, smooth or 0.0, spacing, int(every))
        scale = cleaned.scale
    write_centerline(written, out)
    found = {
        "input": given,
        "output": out,
        "length_unit": length_unit,
        "smoothed_m": scale,
        "read": _measured(read),
        "written": _measured(written),
    }
    if json:
        print(json_format.dumps(found, allow_nan=False), flush=True)
        return 0
    from torsade.cli.table import print_file, print_rows

    print_file("read from", given)
    print_rows(_rows(found, smooth))
    print_file("written to", out)
    return 0


def _measured(centerline: Centerline) -> list[dict[str, Any]]:
    """Nodes, length [m] and kind of each strand."""
    return [
        {"nodes": len(x), "length_m": curve.length(x, closed), "closed": closed}
        for x, closed in zip(centerline.strands, centerline.closed, strict=True)
    ]


def _rows(found: dict[str, Any], smooth: str | None) -> Iterator[tuple[str, str]]:
    yield "strands", f"{len(found['read'])}, in {found['length_unit']}"
    if smooth is not None:
        yield "smoothed over", f"{1e3 * found['smoothed_m']:.4g} mm; the knot is the same"
    for k, (before, after) in enumerate(zip(found["read"], found["written"], strict=True)):
        kind = "closed" if after["closed"] else "open"
        now = f"{kind}, {after['nodes']} nodes, {1e3 * after['length_m']:.4g} mm"
        was = f"; read {before['nodes']} nodes, {1e3 * before['length_m']:.4g} mm" if before != after else ""
        yield f"strand {k}", now + was
