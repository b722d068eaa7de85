"""Which way Seifert circles run in the plane."""

from __future__ import annotations

from collections.abc import Sequence

from torsade.topology.diagram import Diagram

__all__ = ["turning"]


def turning(diagram: Diagram, loop: Sequence[int]) -> int:
    """+1 for a Seifert circle that runs counterclockwise in the plane, -1 for one that runs clockwise.

    Circles without crossings, (), count as counterclockwise.

    Args:
        diagram: connected, with its outer faces as they are in the plane.
        loop: one of `diagram.seifert_circles`.

    >>> from torsade.topology.codes import from_braid
    >>> closed = from_braid([1, 1, 1])
    >>> [turning(closed, loop) for loop in closed.seifert_circles]
    [-1, -1]
    """
    if not loop:
        return 1
    mine = set(loop)
    outside = set(diagram.outer_faces)
    todo = list(outside)
    while todo:
        for p in diagram.faces[todo.pop()]:
            # Around the edges of others, and between two strands of the circle that smoothing parts.
            near = set() if diagram.edge_at[p] in mine else {diagram.face_at[diagram.mate[p]]}
            q = diagram.mate[p]
            if q >= 0 and diagram.is_tail(p) != diagram.is_tail(diagram.cw(q)):
                near.add(diagram.face_at[diagram.ccw(q)])
            todo += near - outside
            outside |= near
    tail, _ = diagram.edges[loop[0]]
    return -1 if diagram.face_at[tail] in outside else 1
