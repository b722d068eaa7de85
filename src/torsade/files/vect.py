"""VECT, the polylines of Geomview: counts, then vertices, then colours, which are left out.

VECT
number of polylines, of vertices, of colours
vertices of each polyline, negative if it is closed
colours of each polyline
x y z of every vertex
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, quoted
from torsade.files.gathered import MOST_NODES, MOST_STRANDS, Gathered, rows
from torsade.files.regular import lines, whole_number

__all__ = ["read", "written"]

Words = Iterator[tuple[str, str]]


def written(centerline: Centerline) -> bytes:
    """Polylines without colours."""
    counts = [-len(x) if c else len(x) for x, c in zip(centerline.strands, centerline.closed, strict=True)]
    text = ["VECT  # centerline nodes [m]", f"{len(counts)} {sum(map(abs, counts))} 0"]
    text += [" ".join(map(str, counts)), " ".join("0" for _ in counts)]
    text += [f"{a!r} {b!r} {c!r}" for x in centerline.strands for a, b, c in rows(x)]
    return ("\n".join(text) + "\n").encode()


def read(path: Path) -> Centerline:
    """Polylines; a negative number of vertices closes one, and so does its last vertex at its first."""
    found = Gathered(path)
    words = _words(path)
    where, word = next(words, ("", ""))
    if word != "VECT":
        begins = f"begins with {quoted(word, 40)}" if word else "is empty"
        raise TorsadeError(f"{found.name} {begins}; a VECT file begins with the word VECT")
    n_lines = _count(words, "the number of polylines", found.name)
    n_vertices = _count(words, "the number of vertices", found.name)
    _count(words, "the number of colours", found.name)
    if not 0 < n_lines <= MOST_STRANDS or not 0 < n_vertices <= MOST_NODES:
        raise TorsadeError(
            f"{found.name} announces {n_lines} polylines of {n_vertices} vertices; give from 1 to "
            f"{MOST_STRANDS} of at most {MOST_NODES} in all"
        )
    counts = [_count(words, f"the vertices of polyline {k}", found.name) for k in range(n_lines)]
    for k in range(n_lines):
        _count(words, f"the colours of polyline {k}", found.name)
    if sum(map(abs, counts)) != n_vertices:
        raise TorsadeError(
            f"{found.name} announces {n_vertices} vertices, and its polylines have {sum(map(abs, counts))}; "
            "make them agree"
        )
    for k, count in enumerate(counts):
        found.begin()
        for i in range(abs(count)):
            what = f"vertex {i} of polyline {k}"
            (where, x), (_, y), (_, z) = (_next(words, what, found.name) for _ in range(3))
            found.add((x, y, z), where)
    return found.centerline([count < 0 for count in counts])


def _words(path: Path) -> Words:
    for where, line in lines(path):
        for word in line.partition("#")[0].split():
            yield where, word


def _next(words: Words, what: str, name: str) -> tuple[str, str]:
    where, word = next(words, ("", ""))
    if not where:
        raise TorsadeError(f"{name} ends before {what}; complete it")
    return where, word


def _count(words: Words, what: str, name: str) -> int:
    where, word = _next(words, what, name)
    return whole_number(word, what, where)
