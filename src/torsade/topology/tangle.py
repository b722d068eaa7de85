"""Cutting, gluing and closing diagrams: the arithmetic of tangles.

A tangle with four ends is held by its corners SW, SE, NE, NW, which are its ends in their order,
counterclockwise. As the strands that meet may run against each other, gluing keeps the direction of
those of the first summand that it meets.

- `a + b` sets b on the right of a and joins NE to NW and SE to SW;
- `a * b` is Conway's product: a reflected in its diagonal from NW to SE, and then b added, so that
  `integer(3) * integer(2)` is his tangle 3 2;
- `-a` has all crossings changed; `a | b` sets drawings side by side; `a @ b` is the connected sum.

>>> numerator(integer(3) * integer(2)).n_crossings
5
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from torsade.errors import TorsadeError, listed
from torsade.topology.diagram import CIRCLE, Diagram

__all__ = [
    "add",
    "close",
    "closures",
    "connected_sum",
    "cut",
    "denominator",
    "integer",
    "multiply",
    "numerator",
    "rational",
    "rotated",
    "split",
    "summands",
    "union",
]


def integer(n: int) -> Diagram:
    """Two strands twisted n half turns around a horizontal axis; the upper one rises to the right if n > 0.

    >>> [integer(n).n_crossings for n in (0, 1, -4)]
    [0, 1, 4]
    """
    if n < 0:
        return integer(-n).mirror()
    # Corners SW, SE, NE, NW of crossing c are its ports 3, 0, 1, 2: odd ones lie on the rising strand.
    mate = [0] * (4 * n + 4)
    loose = [-4, -1]  # south and north, on the left
    for c in range(n):
        for p, q in zip(loose, (4 * c + 3, 4 * c + 2), strict=True):
            mate[p], mate[q] = q, p
        loose = [4 * c, 4 * c + 1]
    for p, q in zip(loose, (-3, -2), strict=True):
        mate[p], mate[q] = q, p
    return Diagram.assemble(mate, n_ends=4)


def rational(*twists: int) -> Diagram:
    """Conway's rational tangle: the product of integer tangles, so that `rational(3, 2)` is 3 2.

    Raises:
        TorsadeError: no twists are given.
    """
    if not twists:
        raise TorsadeError("a rational tangle of no twists; give at least one integer")
    tangle = integer(twists[0])
    for n in twists[1:]:
        tangle = tangle * integer(n)
    return tangle


def rotated(tangle: Diagram, quarters: int = 1) -> Diagram:
    """The tangle turned counterclockwise by quarter turns: the end at SW comes to SE.

    Raises:
        TorsadeError: a tangle without exactly four ends.
    """
    m = len(_four(tangle).ends)
    k = -quarters % m
    mate = [p if p >= 0 else (p - k) % m - m for p in tangle.mate]
    ends = mate[len(mate) - m :]
    mate[len(mate) - m :] = ends[k:] + ends[:k]
    starts = [s if s >= 0 else (s - k) % m - m for s in tangle.starts]
    return Diagram.assemble(mate, starts, tangle.ends[k:] + tangle.ends[:k], outer=tangle.outer)


def add(a: Diagram, b: Diagram) -> Diagram:
    """The sum a + b of tangles with four ends each: b stands on the right of a.

    Raises:
        TorsadeError: a tangle without exactly four ends.
    """
    sw, se, ne, nw = range(4)
    joins = [(se, 4 + sw), (ne, 4 + nw)]
    return _glued([_four(a), _four(b)], joins, [sw, 4 + se, 4 + ne, nw])


def multiply(a: Diagram, b: Diagram) -> Diagram:
    """Conway's product a b: a is reflected in its diagonal from NW to SE, then b is added.

    Raises:
        TorsadeError: a tangle without exactly four ends.
    """
    # Reflected, the ends come in the order NW, NE, SE, SW; NE and SW have changed places.
    return add(rotated(_four(a).reflected(), 1), b)


def numerator(tangle: Diagram) -> Diagram:
    """The closure of a tangle with four ends that joins NW to NE and SW to SE.

    Raises:
        TorsadeError: a tangle without exactly four ends.
    """
    return _closed(_four(tangle), [(0, 1), (2, 3)])


def denominator(tangle: Diagram) -> Diagram:
    """The closure of a tangle with four ends that joins NW to SW and NE to SE.

    Raises:
        TorsadeError: a tangle without exactly four ends.
    """
    return _closed(_four(tangle), [(1, 2), (0, 3)])


def close(tangle: Diagram, joins: Iterable[tuple[str, str]]) -> Diagram:
    """The closure that joins ends, given by name, outside the circle and without crossings.

    Args:
        tangle: with any number of ends.
        joins: pairs of their names, such as [("A0", "B0"), ("A1", "B1")].

    Raises:
        TorsadeError: joins without each end once, or that cross outside the circle.
    """
    place = {name: k for k, name in enumerate(tangle.ends)}
    pairs = [tuple(two) for two in joins]
    if sorted(name for two in pairs for name in two) != sorted(place):
        raise TorsadeError(
            f"joins {pairs} do not join all ends; give each of {' '.join(place)} once, in pairs"
        )
    known = [(min(place[p], place[q]), max(place[p], place[q])) for p, q in pairs]
    for p, q in known:
        for r, s in known:
            if p < r < q < s:
                raise TorsadeError(
                    f"joins {pairs} cross outside the circle, where the ends are {' '.join(tangle.ends)}; "
                    "choose one of `closures`"
                )
    return _closed(tangle, known)


def _closed(tangle: Diagram, joins: Sequence[tuple[int, int]]) -> Diagram:
    """The closure that joins ends p < q, counted around; outside is what lies open to most gaps of ends."""
    m = len(tangle.ends)
    above = [frozenset(k for k, (p, q) in enumerate(joins) if p <= gap < q) for gap in range(m)]
    gap = max(range(m), key=lambda g: above.count(above[g]))
    # The gap is on the left of the edge that comes in at the next end, and so of the one joined to it.
    end = (gap + 1) % m
    partner = next(q if p == end else p for p, q in joins if end in (p, q))
    dart = tangle.mate[partner - m]
    outer = [dart] if dart >= 0 else []
    opened = replace(tangle, outer=(*outer, *tangle.outer))
    return _glued([opened], joins, [])


def closures(tangle: Diagram) -> Iterator[tuple[tuple[tuple[str, str], ...], Diagram]]:
    """All ways to join the ends outside the circle without crossings: (pairs of names, closed diagram).

    There are two for two strands.
    """

    def pairings(ends: Sequence[str]) -> Iterator[tuple[tuple[str, str], ...]]:
        if not ends:
            yield ()
        for k in range(1, len(ends), 2):
            for inside in pairings(ends[1:k]):
                for outside in pairings(ends[k + 1 :]):
                    yield ((ends[0], ends[k]), *inside, *outside)

    for joins in pairings(tangle.ends):
        yield joins, close(tangle, joins)


def union(a: Diagram, b: Diagram) -> Diagram:
    """Two drawings side by side; the ends of a come first."""
    m, k = len(a.ends), len(b.ends)
    return _glued([a, b], [], range(m + k))


def cut(diagram: Diagram, edge: int = 0) -> Diagram:
    """A closed diagram cut open at an edge: a tangle of one strand, with ends A0 and A1, beside the rest.

    Raises:
        TorsadeError: the diagram has ends, or no such edge.
    """
    if diagram.ends:
        raise TorsadeError(f"the diagram has ends {listed(diagram.ends)}; give a closed one to cut")
    if not diagram.edges and diagram.circles and edge == 0:
        starts = list(diagram.starts)
        starts[starts.index(CIRCLE)] = -2
        return Diagram.assemble([-1, -2], starts, n_ends=2)
    if not 0 <= edge < len(diagram.edges):
        raise TorsadeError(f"there is no edge {edge}; give one from 0 to {len(diagram.edges) - 1}")
    tail, head = diagram.edges[edge]
    mate = [*diagram.mate, head, tail]
    mate[head], mate[tail] = -2, -1
    starts = list(diagram.starts)
    starts[diagram.edge_strand[edge]] = -2
    return Diagram.assemble(mate, starts, n_ends=2)


def connected_sum(a: Diagram, b: Diagram, edges: tuple[int, int] = (0, 0)) -> Diagram:
    """The connected sum of two closed diagrams at one edge of each, by default the first of strand A.

    Raises:
        TorsadeError: as `cut` does.

    >>> from torsade.topology.codes import from_braid
    >>> trefoil = from_braid([1, 1, 1])
    >>> (trefoil @ trefoil).n_crossings, len(summands(trefoil @ trefoil))
    (6, 2)
    """
    halves = [cut(d, e) for d, e in zip((a, b), edges, strict=True)]
    # The end of each half is joined to the beginning of the other.
    return _glued(halves, [(1, 2), (3, 0)], [])


def split(diagram: Diagram) -> tuple[Diagram, ...]:
    """The split components of a closed diagram that show: its connected pieces, then its circles.

    Raises:
        TorsadeError: the diagram has ends.
    """
    if diagram.ends:
        raise TorsadeError(f"the diagram has ends {listed(diagram.ends)}; close it first")
    pieces = [_part(diagram, piece) for piece in diagram.pieces]
    return (*pieces, *[Diagram.circle()] * diagram.circles)


def summands(diagram: Diagram) -> tuple[Diagram, ...]:
    """The parts of a closed diagram: its split components, cut into what connected sums show in the drawing.

    Circles that cross two edges only are cut along, so each part has no such circle. The parts of a
    drawing of a composite knot need not show: `simplify` first, for what is prime is then seldom hidden.

    Raises:
        TorsadeError: the diagram has ends.
    """
    parts: list[Diagram] = []
    todo = list(split(diagram))
    while todo:
        d = todo.pop()
        shared: dict[frozenset[int], tuple[int, int]] = {}
        for tail, head in d.edges:
            sides = frozenset((d.face_at[tail], d.face_at[head]))
            if sides in shared:
                first, end = shared[sides]
                mate = list(d.mate)
                mate[first], mate[head], mate[tail], mate[end] = head, first, end, tail
                both = Diagram.assemble(mate, [first, tail, *d.starts])
                todo += [_part(both, piece) for piece in both.pieces]
                break
            shared[sides] = tail, head
        else:
            parts.append(d)
    return tuple(sorted(parts, key=lambda d: -d.n_crossings))


def _part(diagram: Diagram, piece: Sequence[int]) -> Diagram:
    """A closed piece by itself."""
    new = {p: k for k, p in enumerate(piece)}
    starts = [new[s] for s in diagram.starts if s in new]
    return Diagram.assemble(
        [new[diagram.mate[p]] for p in piece], starts, outer=[new[p] for p in diagram.outer if p in new]
    )


def _four(tangle: Diagram) -> Diagram:
    if len(tangle.ends) != 4:
        raise TorsadeError(f"the tangle has {len(tangle.ends)} ends; give one with four")
    return tangle


def _glued(tangles: Sequence[Diagram], joins: Iterable[tuple[int, int]], left: Sequence[int]) -> Diagram:
    """Tangles in a row with some ends joined.

    Args:
        tangles: their ends are counted through, from the first of the first tangle.
        joins: pairs of ends.
        left: the ends that are left, counterclockwise.
    """
    crossing = end = 0
    new: list[dict[int, int]] = []
    n = 4 * sum(t.n_crossings for t in tangles)
    mate: list[int] = []
    tips: list[int] = []
    for t in tangles:
        m = len(t.ends)
        # For now, end k of all is port n + k.
        name = {p: p + crossing if p >= 0 else n + end + m + p for p in t.ports} | {CIRCLE: CIRCLE}
        new.append(name)
        mate += [name[t.mate[p]] for p in range(4 * t.n_crossings)]
        tips += [name[t.mate[p]] for p in range(-m, 0)]
        crossing, end = crossing + 4 * t.n_crossings, end + m
    mate += tips
    starts = [name[s] for t, name in zip(tangles, new, strict=True) for s in t.starts]
    outer = [name[p] for t, name in zip(tangles, new, strict=True) for p in t.outer if p >= 0]
    for p, q in joins:
        p, q = p + n, q + n
        before, after = mate[p], mate[q]
        # A strand that began at a joined end begins where it now comes from.
        if before == q:
            mine = [k for k, s in enumerate(starts) if s in (p, q)]
            starts[mine[0]] = CIRCLE
            starts = [s for k, s in enumerate(starts) if k not in mine[1:]]
            continue
        starts = [after if s == p else before if s == q else s for s in starts]
        mate[before], mate[after] = after, before
    place = {n + k: i - len(left) for i, k in enumerate(left)}
    final = [mate[p] for p in range(n)] + [mate[n + k] for k in left]
    final = [place.get(p, p) for p in final]
    starts = [place.get(s, s) for s in starts]
    return Diagram.assemble(final, starts, n_ends=len(left), outer=outer)
