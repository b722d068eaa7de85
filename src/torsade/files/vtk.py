"""Legacy VTK: polydata of polylines, which ParaView and PyVista open; written, not read."""

from __future__ import annotations

from torsade.centerline import Centerline
from torsade.files.gathered import rows

__all__ = ["written"]


def written(centerline: Centerline) -> bytes:
    """Points in double precision and one polyline a strand; a closed one returns to its first point."""
    n_points = sum(len(x) for x in centerline.strands)
    polylines, first = [], 0
    for x, closed in zip(centerline.strands, centerline.closed, strict=True):
        polylines.append([*range(first, first + len(x)), *([first] if closed else [])])
        first += len(x)
    text = ["# vtk DataFile Version 3.0", "centerline nodes [m]", "ASCII", "DATASET POLYDATA"]
    text.append(f"POINTS {n_points} double")
    text += [f"{a!r} {b!r} {c!r}" for x in centerline.strands for a, b, c in rows(x)]
    text.append(f"LINES {len(polylines)} {sum(len(line) + 1 for line in polylines)}")
    text += [" ".join(map(str, [len(line), *line])) for line in polylines]
    # A number for every polyline, to colour strands by.
    text += [f"CELL_DATA {len(polylines)}", "SCALARS strand int 1", "LOOKUP_TABLE default"]
    text += [str(k) for k in range(len(polylines))]
    return ("\n".join(text) + "\n").encode()
