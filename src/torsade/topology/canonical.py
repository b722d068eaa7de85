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


def canonical_form(diagram: Diagram, plane: bool = False, unoriented: bool = False) -> Form:
    """A value equal for two diagrams exactly if they are the same drawing, whatever the numbering.

    Strands are not told apart by order; the ends of a tangle are, by name.

    Args:
        diagram: of a knot, a link or a tangle.
        plane: whether the outer faces of closed pieces count; by default they are drawn on a sphere.
        unoriented: whether directions of strands are left out.
    """
    closed: list[Form] = []
    tangle: Form = ()
    for piece in diagram.pieces:
        if piece[0] < 0:
            first = min(diagram.ends)
            root = diagram.ends.index(first) - len(diagram.ends)
            tangle = (_written(diagram, root, (), unoriented), _turned(diagram.ends, first))
        else:
            closed.append(_smallest(diagram, piece, plane, unoriented))
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
    return canonical_form(one, plane, unoriented) == canonical_form(other, plane, unoriented)


def _turned(names: tuple[str, ...], first: str) -> tuple[str, ...]:
    k = names.index(first)
    return names[k:] + names[:k]


def _smallest(
    diagram: Diagram, piece: Iterable[int], plane: bool, unoriented: bool
) -> tuple[tuple[int, ...], ...]:
    """The smallest writing of a closed piece."""
    outer: set[int] = set()
    if plane:
        outer = {p for f in diagram.outer_faces for p in diagram.faces[f]}
    below = 1 if unoriented else 3
    return min(_written(diagram, p, outer, unoriented) for p in piece if not p & below)


def _written(
    diagram: Diagram, root: int, outer: Iterable[int], unoriented: bool
) -> tuple[tuple[int, ...], ...]:
    """A piece written from the lower entry of a crossing, or from an end.

    For each crossing come its sign and the ports it faces. Crossings are numbered as they are met;
    ends count from the root, as -1, -2 ... clockwise. Without directions there are no signs, and the lower
    port that is met, or follows clockwise on what is met, is the first.
    """
    mate, m = diagram.mate, len(diagram.ends)
    number: dict[int, int] = {}
    order: list[int] = []  # the first port of each crossing

    def named(p: int) -> int:
        if p < 0:
            return (p - root) % m - m
        if p not in number:
            first = p & ~1 if unoriented else p & ~3
            for i in range(4):
                number[first ^ i] = 4 * len(order) + i
            order.append(first)
        return number[p]

    rows: list[tuple[int, ...]] = []
    if root < 0:
        rows.append(tuple(named(mate[(root + k) % m - m]) for k in range(m)))
    else:
        named(root)
    for first in order:  # grows as it is read
        sign = 0 if unoriented else diagram.signs[first >> 2]
        rows.append((sign, *(named(mate[first ^ i]) for i in range(4))))
    if outer:
        rows.append(tuple(sorted(number[p] for p in outer if p in number)))
    return tuple(rows)
