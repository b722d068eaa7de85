"""The Reidemeister moves, one at a time: where they can be made, and the diagram after them.

Places are given as darts (see `torsade.topology.diagram`), so a move is made on one drawing: where
strands hang over a crossing or a face is not left to chance. Crossings may be numbered anew.
"""

from __future__ import annotations

from collections.abc import Iterator

from torsade.errors import TorsadeError
from torsade.topology.diagram import CIRCLE, Diagram
from torsade.topology.draft import Draft

__all__ = [
    "add_bigon",
    "add_kink",
    "bigons",
    "fingers",
    "kinks",
    "remove_bigon",
    "remove_kink",
    "slide_triangle",
    "triangles",
]


def kinks(diagram: Diagram) -> tuple[int, ...]:
    """Darts around faces of one edge: where `remove_kink` can be used."""
    return tuple(face[0] for face in diagram.faces if len(face) == 1 and face[0] >= 0)


def bigons(diagram: Diagram) -> tuple[int, ...]:
    """Upper darts of faces of two edges, one above the other: where `remove_bigon` can be used."""
    return tuple(_upper_darts(diagram, 2))


def triangles(diagram: Diagram) -> tuple[int, ...]:
    """Upper darts of faces of three edges of an upper, a middle and a lower strand: for `slide_triangle`."""
    return tuple(_upper_darts(diagram, 3))


def _upper_darts(diagram: Diagram, n_edges: int) -> Iterator[int]:
    """Darts that are over at both ends, on the faces of so many edges that touch no end."""
    mate = diagram.mate
    for face in diagram.faces:
        if len(face) == n_edges and min(face) >= 0:
            upper = [p for p in face if p & mate[p] & 1]
            # Between two edges of one bigon or triangle lies a crossing, where one is over and one under.
            if len(upper) == 1 and len({p >> 2 for p in face}) == n_edges:
                yield upper[0]


def fingers(diagram: Diagram) -> tuple[tuple[int, int], ...]:
    """Pairs of darts of two edges around one face: where `add_bigon` can be used."""
    return tuple(
        (p, q)
        for face in diagram.faces
        for p in face
        for q in face
        if diagram.edge_at[p] != diagram.edge_at[q]
    )


def add_kink(diagram: Diagram, dart: int, sign: int, left: bool = True) -> Diagram:
    """First move: a loop of one crossing of this sign, on the left or the right of a dart.

    Give `CIRCLE` as the dart to put a kink into the first circle without crossings.

    Raises:
        TorsadeError: another sign than +1 or -1, no such port, or no circle without crossings.

    >>> from torsade.topology.diagram import Diagram
    >>> add_kink(Diagram.circle(), CIRCLE, -1).signs
    (-1,)
    """
    if sign not in (1, -1):
        raise TorsadeError(f"the sign of a kink is {sign!r}; give 1 or -1")
    draft = Draft(diagram)
    x = draft.new_crossing()
    # In at x + a, straight on, around to the left or right, and across what was passed first.
    a = int(left == (sign < 0))  # odd: over first
    into, out = x + a, x + (a ^ 2)
    side = x + (a - 1 & 3 if left else a + 1 & 3)
    if dart == CIRCLE:
        if not diagram.circles:
            raise TorsadeError("the diagram has no circle without crossings; give the dart of an edge")
        draft.starts[draft.starts.index(CIRCLE)] = side ^ 2
        draft.join(into, side ^ 2)
    else:
        _check_port(diagram, dart)
        far = diagram.mate[dart]
        draft.join(dart, into)
        draft.join(side ^ 2, far)
    draft.join(out, side)
    return draft.freeze()


def remove_kink(diagram: Diagram, dart: int) -> Diagram:
    """First move, back: take away the crossing of a loop, given by one of `kinks`.

    Raises:
        TorsadeError: the dart is none of them.
    """
    if dart not in kinks(diagram):
        raise TorsadeError(f"port {dart} is on no face of one edge; give one of {list(kinks(diagram))}")
    draft = Draft(diagram)
    draft.remove([dart >> 2])
    return draft.freeze()


def add_bigon(diagram: Diagram, dart: int, other: int, over: bool = True) -> Diagram:
    """Second move: push the edge of a dart through their common face, over or under that of another.

    Args:
        diagram: what to change.
        dart: whose edge is pushed.
        other: whose edge it comes to pass; around the same face, of another edge.
        over: whether it passes above.

    Raises:
        TorsadeError: the darts are no pair of `fingers`.
    """
    at = diagram.edge_at, diagram.face_at
    known = dart in diagram.ports and other in diagram.ports
    if not known or at[0][dart] == at[0][other] or at[1][dart] != at[1][other]:
        raise TorsadeError(
            f"darts {dart} and {other} are not of two edges around one face; "
            "give one of the pairs of `fingers`"
        )
    draft = Draft(diagram)
    far = diagram.mate[dart]
    there = draft.cross(dart, other, over)
    back = draft.cross(there, draft.mate[other], over)
    draft.join(back, far)
    return draft.freeze()


def remove_bigon(diagram: Diagram, dart: int) -> Diagram:
    """Second move, back: part two strands, one above the other twice, given by one of `bigons`.

    Raises:
        TorsadeError: the dart is none of them.
    """
    if dart not in bigons(diagram):
        raise TorsadeError(f"port {dart} is no upper dart of a bigon; give one of {list(bigons(diagram))}")
    draft = Draft(diagram)
    draft.remove([dart >> 2, diagram.mate[dart] >> 2])
    return draft.freeze()


def slide_triangle(diagram: Diagram, dart: int) -> Diagram:
    """Third move: slide the upper strand over the crossing of the other two, given by one of `triangles`.

    Raises:
        TorsadeError: the dart is none of them.
    """
    if dart not in triangles(diagram):
        raise TorsadeError(
            f"port {dart} is no upper dart of a triangle; give one of {list(triangles(diagram))}"
        )
    draft = Draft(diagram)
    mate = diagram.mate
    second = diagram.corner(dart)  # from the end of the upper edge to the crossing opposite
    third = diagram.corner(second)  # and from there to its beginning
    arc = [dart ^ 2, dart, mate[dart], mate[dart] ^ 2]
    beyond = [mate[second] ^ 2, third ^ 2]
    draft.reroute(arc, beyond, over=True)
    # The faces around the lower crossing now lie beyond what the strand crosses there.
    at, (s, t) = diagram.face_at, beyond
    behind = {s: draft.mate[s] ^ 2, t: draft.mate[t] ^ 2, mate[second]: draft.mate[draft.mate[t] ^ 2]}
    draft.outer = [behind.get(p, p) for p in draft.outer]
    # Faces with corners at the crossings that went, and nowhere else, have others now.
    moved = {at[mate[dart]]: third, at[dart ^ 2]: s, at[second ^ 2]: draft.mate[t]}
    gone = {c >> 2 for c in arc}
    lost = {at[p] for p in diagram.outer if all(q >> 2 in gone for q in diagram.faces[at[p]])}
    draft.outer += [moved[face] for face in lost]
    return draft.freeze()


def _check_port(diagram: Diagram, dart: int) -> None:
    if dart not in diagram.ports:
        raise TorsadeError(
            f"there is no port {dart}; give one from {diagram.ports[0]} to {diagram.ports[-1]}"
        )
