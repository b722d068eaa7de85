"""Free ends swing: the last stretch of a strand is lifted, led over (or under) all else, and out elsewhere.

A Reidemeister move keeps the ends of a tangle in place. The tail of a rope is not kept: what lies above
everything from some crossing to the end can be laid anew, as long as it stays above.
"""

from __future__ import annotations

from collections.abc import Iterator

from torsade.topology._ports import around, faces
from torsade.topology.diagram import Diagram
from torsade.topology.draft import Draft

__all__ = ["swings"]


def swings(diagram: Diagram, most: int) -> Iterator[Diagram]:
    """Drawings in which one end has swung to a gap between others, with at most so many crossings.

    Each end is lifted from none, one, or more of its last crossings, as long as it is above (or below) at
    all of them, and led by a shortest way to each gap between the other ends.

    >>> from torsade.topology.tangle import integer
    >>> sorted({d.n_crossings for d in swings(integer(2), 3)})
    [1, 2, 3]
    """
    for end in range(-len(diagram.ends), 0):
        for over in (True, False):
            for lifted in range(_run(diagram, end, over) + 1):
                if lifted or over:  # what crosses nothing lies neither above nor below
                    room = most - diagram.n_crossings + lifted
                    yield from _led_elsewhere(
                        diagram, end, lifted, (over,) if lifted else (True, False), room
                    )


def _run(diagram: Diagram, end: int, over: bool) -> int:
    """How many crossings in a row, from an end on, its strand passes above (or below)."""
    count, p = 0, diagram.mate[end]
    seen: set[int] = set()
    # Where the strand meets its own last stretch again, that would have to be lifted from itself.
    while p >= 0 and p & 1 == over and p >> 2 not in seen:
        seen.add(p >> 2)
        count, p = count + 1, diagram.mate[p ^ 2]
    return count


def _led_elsewhere(
    diagram: Diagram, end: int, lifted: int, sides: tuple[bool, ...], room: int
) -> Iterator[Diagram]:
    """Drawings with the end lifted from its last crossings and led out over at most `room` edges."""
    lifted_off = Draft(diagram)
    p, gone = diagram.mate[end], []
    for _ in range(lifted):
        gone.append(p >> 2)
        p = diagram.mate[p ^ 2]
    lifted_off.remove(gone)
    for gap, path in _ways_out(lifted_off.mate, len(diagram.ends), end):
        if len(path) > room or (not lifted and not path):
            continue
        for over in sides:
            draft = Draft(diagram)
            draft.remove(gone)
            p = draft.mate[end]
            for dart in path:
                p = draft.cross(p, dart, over)
            draft.join(p, end)
            yield draft.freeze(_before(end, gap, len(draft.ends)))


def _ways_out(mate: list[int], m: int, end: int) -> Iterator[tuple[int, tuple[int, ...]]]:
    """For each gap between ends other than `end`: the end after it, counterclockwise, and a shortest way.

    A way is the darts that it crosses from left to right. `end` is taken off the circle: its face goes around
    its tip and back.
    """
    others = [p for p in range(-m, 0) if p != end]
    sides, at = faces(mate, {end: end} | around(others))
    ways: dict[int, tuple[int, ...]] = {at[end]: ()}
    layer = [at[end]]
    while layer:
        following = []
        for f in layer:
            for p in sides[f]:
                if p != end and mate[p] != end and (g := at[mate[p]]) not in ways:
                    ways[g] = (*ways[f], p)
                    following.append(g)
        layer = following
    for p in others:
        if at[p] in ways:
            yield p, ways[at[p]]


def _before(end: int, gap: int, m: int) -> list[int]:
    """The ends in order, with one moved to just before another."""
    order = [p for p in range(-m, 0) if p != end]
    order.insert(order.index(gap), end)
    return order
