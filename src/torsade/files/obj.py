"""OBJ: vertices `v x y z` and polylines `l 1 2 3 ...`.

Indices count from 1, or back from the last vertex when negative. A record that begins where the last one
ended goes on with its strand; a strand that returns to its first vertex is closed.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files.gathered import MOST_NODES, MOST_STRANDS, Gathered, made, rows
from torsade.files.regular import lines, whole_number

__all__ = ["read", "written"]

IGNORED = frozenset({"vn", "vt", "vp", "f", "p", "o", "g", "s", "mg", "usemtl", "mtllib", "usemap", "maplib"})
"""Records that say nothing of polylines."""

RECORD = 1000
"""Vertices in a record that is written; a longer strand goes on in the next."""


def written(centerline: Centerline) -> bytes:
    """All vertices, then the records of each strand."""
    text = ["# centerline nodes [m]"]
    for x in centerline.strands:
        text += [f"v {a!r} {b!r} {c!r}" for a, b, c in rows(x)]
    first = 1
    for k, (x, closed) in enumerate(zip(centerline.strands, centerline.closed, strict=True)):
        vertices = [*range(first, first + len(x)), *([first] if closed else [])]
        text.append(f"o strand{k}")
        for start in range(0, max(1, len(vertices) - 1), RECORD):
            text.append("l " + " ".join(map(str, vertices[start : start + RECORD + 1])))
        first += len(x)
    return ("\n".join(text) + "\n").encode()


def read(path: Path) -> Centerline:
    """Polylines; faces and everything else are left out."""
    found = Gathered(path)
    found.begin()
    polylines: list[list[int]] = []
    n_indices, faces = 0, False
    for where, line in lines(path):
        word, *cells = line.partition("#")[0].split() or [""]
        if word == "v":
            if len(cells) < 3:
                raise TorsadeError(f"{where} has a vertex of {len(cells)} coordinates; give v x y z")
            found.add(cells[:3], where)
        elif word == "l":
            n_indices += len(cells)
            if n_indices > 2 * MOST_NODES:
                raise TorsadeError(f"{found.name} has polylines of more than {MOST_NODES} nodes; give fewer")
            _follow(polylines, _indices(cells, len(found.numbers[0]) // 3, where), where)
        elif word and word not in IGNORED:
            raise TorsadeError(f"{where} begins with {quoted(word, 40)}; give vertices v and polylines l")
        faces = faces or word == "f"
    if not polylines:
        has = "faces and no polylines" if faces else "no polylines"
        raise TorsadeError(f"{found.name} has {has}; give records such as l 1 2 3, of the curve's vertices")
    _check_apart(polylines, found.name)
    x = np.array(found.numbers[0]).reshape(-1, 3)
    closed = [line[0] == line[-1] for line in polylines]
    strands = [x[line[:-1] if shut else line] for line, shut in zip(polylines, closed, strict=True)]
    return made(found.name, strands, closed)


def _indices(cells: list[str], n_vertices: int, where: str) -> list[int]:
    """The vertices of a record, counted from 0."""
    if len(cells) < 2:
        raise TorsadeError(f"{where} has a polyline of fewer than 2 vertices; give at least 2")
    found = []
    for cell in cells:
        index = whole_number(cell.partition("/")[0], "vertex", where)
        k = index - 1 if index > 0 else n_vertices + index
        if index == 0 or not 0 <= k < n_vertices:
            raise TorsadeError(
                f"{where} has vertex {index}, and {n_vertices} vertices come before it; give 1 to "
                f"{n_vertices}, or -1 for the last"
            )
        found.append(k)
    return found


def _follow(polylines: list[list[int]], vertices: list[int], where: str) -> None:
    """Add a record to the strand that it goes on with, or as a new one."""
    last = polylines[-1] if polylines else []
    if last and last[-1] == vertices[0] and last[0] != last[-1]:
        last += vertices[1:]
        return
    if len(polylines) == MOST_STRANDS:
        raise TorsadeError(f"{where} begins strand {MOST_STRANDS}; give at most {MOST_STRANDS} strands")
    polylines.append(vertices)


def _check_apart(polylines: list[list[int]], name: str) -> None:
    """Refuse strands that share a vertex or come back to one before they end."""
    used: set[int] = set()
    for line in polylines:
        if any(a == b for a, b in pairwise(line)):
            raise TorsadeError(f"{name} has a polyline that repeats vertex {line[0] + 1}; give each once")
        for vertex in line[:-1] if line[0] == line[-1] else line:
            if vertex in used:
                raise TorsadeError(
                    f"{name} has lines that meet at vertex {vertex + 1}; a strand does not branch: give its "
                    "edges in their order along it"
                )
            used.add(vertex)
