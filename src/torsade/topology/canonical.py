"""When two drawings are the same: a code that does not depend on numbering, and isomorphism.

A homeomorphism of the sphere that keeps orientations takes crossings to crossings and ports to ports.
So a connected drawing is fixed by where one port goes: it is written down from there, crossing by
crossing in the order in which they are met, and the smallest of these writings is the code.
"""

from __future__ import annotations

from collections.abc import Iterable

from torsade.topology.diagram import Diagram

__all__ = ["canonical_form", "is_isomorphic"]

Form = tuple[object, ...]


def canonical_form(diagram: Diagram, plane: bool = False) -> Form:
    """A value equal for two diagrams exactly if they are the same drawing, whatever the numbering.

    Strands are oriented but not told apart by order; the ends of a tangle are, by name.

    Args:
        diagram: of a knot, a link or a tangle.
        plane: whether the outer faces of closed pieces count; by default they are drawn on a sphere.
    """
    closed: list[Form] = []
    tangle: Form = ()
    for piece in diagram.pieces:
        if piece[0] < 0:
            first = min(diagram.ends)
            tangle = (
                _written(diagram, diagram.ends.index(first) - len(diagram.ends)),
                _turned(diagram.ends, first),
            )
        else:
            closed.append(_smallest(diagram, piece, plane))
    return (diagram.circles, tangle, *sorted(closed))


def is_isomorphic(one: Diagram, other: Diagram, plane: bool = False, unoriented: bool = False) -> bool:
    """Whether two diagrams are the same drawing, on the sphere or in the plane.

    Args:
        one: a diagram.
        other: a diagram.
        plane: whether the outer faces of closed pieces count.
        unoriented: whether strands may be reversed to make them agree.
    """
    if one.n_crossings != other.n_crossings or sorted(one.ends) != sorted(other.ends):
        return False
    form = canonical_form(one, plane)
    if not unoriented:
        return form == canonical_form(other, plane)
    choices: list[list[int]] = [[]]
    for k in range(other.n_strands):
        choices += [[*chosen, k] for chosen in choices]
    return any(form == canonical_form(other.reverse(chosen), plane) for chosen in choices)


def _turned(names: tuple[str, ...], first: str) -> tuple[str, ...]:
    k = names.index(first)
    return names[k:] + names[:k]


def _smallest(diagram: Diagram, piece: Iterable[int], plane: bool) -> tuple[tuple[int, ...], ...]:
    """The smallest writing of a closed piece."""
    outer: set[int] = set()
    if plane:
        outer = {p for f in diagram.outer_faces for p in diagram.faces[f]}
    return min(_written(diagram, p, outer) for p in piece if not p & 3)


def _written(diagram: Diagram, root: int, outer: Iterable[int] = ()) -> tuple[tuple[int, ...], ...]:
    """A piece written from the lower entry of a crossing, or from an end.

    For each crossing come its sign and the ports it faces. Crossings are numbered as they are met;
    ends count from the root, as -1, -2 ... clockwise.
    """
    mate, m = diagram.mate, len(diagram.ends)
    number: dict[int, int] = {}
    order: list[int] = []

    def named(p: int) -> int:
        if p < 0:
            return (p - root) % m - m
        if p >> 2 not in number:
            number[p >> 2] = len(order)
            order.append(p >> 2)
        return 4 * number[p >> 2] + (p & 3)

    rows: list[tuple[int, ...]] = []
    if root < 0:
        rows.append(tuple(named(mate[(root + k) % m - m]) for k in range(m)))
    else:
        named(root)
    for c in order:  # grows as it is read
        rows.append((diagram.signs[c], *(named(mate[4 * c + i]) for i in range(4))))
    if outer:
        rows.append(tuple(sorted(named(p) for p in outer if p >> 2 in number)))
    return tuple(rows)
