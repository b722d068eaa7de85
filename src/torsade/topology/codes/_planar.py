"""From loosely joined ports to a planar diagram: where the ends lie, and a refusal if it cannot be drawn."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from torsade.errors import TorsadeError, listed
from torsade.topology.diagram import CIRCLE, Diagram, strand_name

__all__ = ["drawn", "ends_around", "standing"]


def drawn(
    mate: Sequence[int],
    starts: Iterable[int],
    ends: Sequence[str],
    boundary: Iterable[str] | None,
    what: str,
) -> Diagram:
    """The diagram of ports whose ends may stand in any order, with its ends as they come around it.

    Args:
        mate: as in `Diagram`, with the ends in the order of `ends`.
        starts: as in `Diagram`.
        ends: names of the ends, in any order.
        boundary: these names, counterclockwise; found from the drawing if none are given. Pieces that
            are not connected then follow one another in the order of `ends`.
        what: what the code is, for the error message.
    """
    m = len(ends)
    if boundary is None:
        order = [end for block in ends_around(mate, m) for end in block]
    else:
        order = _named(ends, list(boundary))
    place = {p: k - m for k, p in enumerate(order)}
    new = [place.get(p, p) for p in mate[: len(mate) - m]] + [place.get(mate[p], mate[p]) for p in order]
    diagram = Diagram.assemble(new, [place.get(s, s) for s in starts], [ends[p] for p in order])
    if diagram.genus:
        where = f" with ends {listed(diagram.ends)} around it" if m else ""
        raise TorsadeError(
            f"the {what} cannot be drawn in the plane{where}: its graph needs a surface of genus "
            f"{diagram.genus}; check the order of labels, and the signs"
        )
    return diagram


def standing(diagram: Diagram) -> Diagram:
    """The same drawing with strand A first, running from A0 to A1, and so on, if its ends have such names.

    So codes, which name ends by order and direction, give every end back its name.
    """
    port = {name: p for p, name in enumerate(diagram.ends, -len(diagram.ends))}
    strand = {p: diagram.edge_strand[diagram.edge_at[p]] for p in port.values()}
    closed = iter(s for s in diagram.starts if s >= 0)
    starts, named = [], 0
    for k in range(diagram.n_strands):
        first, last = (port.get(strand_name(k) + digit) for digit in "01")
        if first is not None and last is not None and strand[first] == strand[last]:
            named += 2
            starts.append(first)
        else:
            starts.append(next(closed, CIRCLE))
    if named < len(port) or tuple(starts) == diagram.starts:
        return diagram
    return Diagram.assemble(diagram.mate, starts, diagram.ends, outer=diagram.outer)


def ends_around(mate: Sequence[int], m: int) -> list[list[int]]:
    """The ends of each piece as they lie around it, counterclockwise, wherever they stand in `mate`."""
    seen: set[int] = set()
    blocks = []
    for first in range(-m, 0):
        if first in seen:
            continue
        clockwise, end = [first], first
        while True:
            p = end
            while (q := mate[p]) >= 0:
                p = q & ~3 | q - 1 & 3  # around the face on the left, until it comes to an end
            if q in clockwise:
                break
            clockwise.append(q)
            end = q
        seen.update(clockwise)
        blocks.append([first, *clockwise[:0:-1]])
    return blocks


def _named(ends: Sequence[str], boundary: list[str]) -> list[int]:
    if sorted(boundary) != sorted(ends):
        raise TorsadeError(f"the boundary is {boundary}; give each of the ends {sorted(ends)} once")
    return [list(ends).index(name) - len(ends) for name in boundary]
