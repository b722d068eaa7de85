"""Walks through bare ports, before there is a diagram: directions of strands, faces, connected pieces."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

__all__ = ["CIRCLE", "around", "connected", "faces", "oriented"]

CIRCLE = 1 << 30
"""Stands in the starts of a diagram for a strand that is a circle without crossings."""


def oriented(
    mate: Sequence[int], starts: Iterable[int], m: int
) -> tuple[list[int], dict[int, int], bytearray]:
    """Directions for the strands of a graph, as for `Diagram.assemble`.

    Args:
        mate: the port that each port faces; the last m are those of ends.
        starts: where strands begin.
        m: how many ends there are.

    Returns:
        The start of each strand; its last port (an end, or the port of its last entry), by its start; and
        for each port whether a strand enters there.
    """
    entry = bytearray(len(mate))
    last: dict[int, int] = {}
    begun: list[int] = []

    def known(s: int) -> bool:
        return bool(entry[s] or (s in last if s < 0 else entry[s ^ 2]))

    def run(start: int) -> None:
        p = start
        while p >= 0 and (p := mate[p ^ 2]) != start:
            pass
        start = p  # the end of an open strand, wherever in it we were told to start
        begun.append(start)
        while True:
            q = mate[p]
            entry[q] = 1
            p = q ^ 2
            if q < 0 or p == start:
                break
        last[start] = q

    for s in starts:
        if s == CIRCLE:
            begun.append(s)
        elif not known(s):
            run(s)
    for s in range(-m, len(mate) - m):
        if not known(s):
            run(s if s < 0 else s ^ 2)
    return begun, last, entry


def around(ends: Sequence[int]) -> dict[int, int]:
    """Where a walk with the outside on its left comes in again, by the end where it goes out: as for `faces`.

    Args:
        ends: counterclockwise around the drawing.
    """
    return dict(zip(ends, [*ends[1:], *ends[:1]], strict=True))


def faces(mate: Sequence[int], beyond: Mapping[int, int]) -> tuple[list[list[int]], list[int]]:
    """The darts around each face, counterclockwise, and the face on the left of each dart.

    Ports that face themselves, where a crossing is gone, are left out; their face is -1.

    Args:
        mate: the port that each port faces; the last are those of ends.
        beyond: by which end a walk around a face goes on after it came to an end; by the same end if the face
            goes around its tip.
    """
    at = [-1] * len(mate)
    found: list[list[int]] = []
    m = len(beyond)
    for first in range(-m, len(mate) - m):
        if at[first] >= 0 or mate[first] == first:
            continue
        face, p, f = [], first, len(found)
        while at[p] < 0:
            at[p] = f
            face.append(p)
            q = mate[p]
            p = q & ~3 | q - 1 & 3 if q >= 0 else beyond[q]
        found.append(face)
    return found, at


def connected(mate: Sequence[int], m: int) -> list[list[int]]:
    """The ports of each connected piece, sorted; all that touches an end is one piece, and comes first."""
    seen = bytearray(len(mate))
    pieces = []
    for first in range(-m, len(mate) - m):
        if seen[first]:
            continue
        piece = list(range(-m, 0) if first < 0 else range(first, first + 4))
        for p in piece:
            seen[p] = 1
        for p in piece:  # grows as it is read
            q = mate[p]
            if not seen[q]:
                whole = range(q & ~3, (q & ~3) + 4)
                for near in whole:
                    seen[near] = 1
                piece += whole
        pieces.append(sorted(piece))
    return pieces
