"""Drawing a knot, link or tangle with fewer crossings.

The step that does the work is the **pass move**. An arc that lies above everything else it meets can be
lifted off and laid down again anywhere, with the same ends; so can one that lies below. An arc may
cross itself if it is above where it comes first, for then it is not knotted. The new place is a
shortest path from face to face, in which edges of the arc itself do not count. Loops, bigons and what
triangles let slip are special cases.

Where no pass move takes crossings away, moves that leave their number are made at random for a while,
by a generator with a fixed seed: the result is always the same.
"""

from __future__ import annotations

import random

from torsade.topology.diagram import Diagram
from torsade.topology.draft import Draft

__all__ = ["reduced_by_passes", "simplify", "untwisted"]

Faces = tuple[list[list[int]], list[int]]


def simplify(diagram: Diagram, patience: int = 100, seed: int = 0) -> Diagram:
    """A diagram of the same knot, link or tangle with as few crossings as were found.

    Closed pieces may pass over their outer face, as on the sphere; ends stay where they are. A connected
    alternating diagram without crossings that fall apart has as few as possible, and is left alone.

    Args:
        diagram: the diagram.
        patience: how many times in a row a move that leaves the number of crossings is followed by no
            reduction before the search ends.
        seed: of the choice of those moves.

    >>> from torsade.topology.codes import from_braid
    >>> simplify(from_braid([1, 1, 2, 1, -2, -1, 1, -2]))
    <Diagram: 0 crossings, 1 strand>
    """
    draft = Draft(diagram)
    chance = random.Random(seed)
    _reduce(draft)
    best = draft.freeze()
    left = 0 if _is_minimal(best) else patience
    while left:
        _shuffle(draft, chance)
        _reduce(draft)
        left -= 1
        if draft.n_crossings < best.n_crossings:
            best = draft.freeze()
            left = 0 if _is_minimal(best) else patience
    return best


def reduced_by_passes(diagram: Diagram) -> Diagram:
    """The diagram after pass moves that take crossings away, until there are none, and nothing else."""
    draft = Draft(diagram)
    _reduce(draft)
    return draft.freeze()


def untwisted(diagram: Diagram) -> Diagram:
    """The diagram without crossings that touch a face twice: what hangs on one of them is turned over.

    Crossings go in the order in which strands come to them, so that mirror images stay mirror images.
    """
    while True:
        at = diagram.face_at
        twice = (p for two in diagram.edges for p in two if p >= 0 and at[p] == at[p ^ 2])
        sides = [(part, p) for p in twice if (part := _hanging(Draft(diagram), p)) is not None]
        if not sides:
            return diagram
        first = [(part, p) for part, p in sides if p >> 2 == sides[0][1] >> 2]
        part, p = min(first, key=lambda side: len(side[0]))
        draft = Draft(diagram)
        _turn_over(draft, part)
        draft.remove([p >> 2])
        diagram = draft.freeze()


def _is_minimal(diagram: Diagram) -> bool:
    """Whether a diagram is alternating, piece by piece, and no crossing touches a face twice."""
    at = diagram.face_at
    return diagram.is_alternating and all(
        at[4 * c] != at[4 * c + 2] and at[4 * c + 1] != at[4 * c + 3] for c in range(diagram.n_crossings)
    )


def _reduce(draft: Draft) -> None:
    """Make pass moves, and turn over what hangs on one crossing, as long as crossings go."""
    faces = draft.faces()
    found = True
    while found:
        found = False
        for start in draft.ports:
            if draft.mate[start] == start:
                continue  # gone since
            for over in (True, False):
                arc = _arc(draft, start, over)
                # Even a crossing that the arc makes with itself goes, so the new arc has one less at least.
                path = _shortest(draft, arc, faces, len({p >> 2 for p in arc}) - 1) if arc else None
                if path is not None:
                    draft.reroute(arc, path, over)
                    faces = draft.faces()
                    found = True
                    if draft.mate[start] == start:
                        break
        if not found and _untwist(draft, faces):
            faces = draft.faces()
            found = True


def _shuffle(draft: Draft, chance: random.Random) -> None:
    """Lay a few arcs elsewhere with as many crossings as before."""
    for _ in range(3):
        starts = [p for p in draft.ports if p >= 0]
        if not starts:
            return
        start, over = chance.choice(starts), chance.random() < 0.5
        arc = _arc(draft, start, over)
        if arc:
            faces = draft.faces()
            path = _shortest(draft, arc, faces, len({p >> 2 for p in arc}), chance)
            if path is not None:
                draft.reroute(arc, path, over)


def _arc(draft: Draft, start: int, over: bool) -> list[int]:
    """The longest arc from a port on which no other strand lies above (or below): entry, exit, entry ...

    Empty where the strand, followed backwards, would make the arc longer: it is then found from there.
    """
    mate = draft.mate
    level = 1 if over else 0
    if start >= 0 and start & 1 == level and not _keeps_level(mate, start, level):
        return []
    arc: list[int] = []
    met: set[int] = set()
    p = start
    while True:
        q = mate[p]
        if q < 0 or not (q & 1 == level or q >> 2 in met):
            break
        met.add(q >> 2)
        p = q ^ 2
        arc += (q, p)
        if p == start:
            break
    return arc


def _keeps_level(mate: list[int], start: int, level: int) -> bool:
    """Whether the strand through a port is closed and never leaves its level."""
    p = start
    while True:
        q = mate[p]
        if q < 0 or q & 1 != level:
            return False
        p = q ^ 2
        if p == start:
            return True


def _shortest(
    draft: Draft, arc: list[int], faces: Faces, limit: int, chance: random.Random | None = None
) -> list[int] | None:
    """The darts that a shortest path between the ends of an arc crosses, if there are at most so many.

    Edges of the arc are crossed for nothing. With a generator the choice among paths that may be
    somewhat longer than the shortest is left to chance.
    """
    mate = draft.mate
    around, at = faces
    a, b = mate[arc[0]], mate[arc[-1]]
    free = {a, b, *arc}
    goal = at[b]
    came: dict[int, tuple[int, int | None]] = {at[a]: (-1, None)}
    layer = [at[a]]
    for _ in range(limit + 1):
        for f in layer:  # grows as it is read: what is reached for nothing
            if f == goal:
                return _traced(came, goal)
            for p in around[f]:
                if p in free and (g := at[mate[p]]) not in came:
                    came[g] = f, None
                    layer.append(g)
        if chance:
            chance.shuffle(layer)
        following = []
        for f in layer:
            for p in around[f]:
                if (g := at[mate[p]]) not in came:
                    came[g] = f, p
                    following.append(g)
        layer = following
    return None


def _traced(came: dict[int, tuple[int, int | None]], goal: int) -> list[int]:
    path = []
    f = goal
    while f >= 0:
        f, dart = came[f]
        if dart is not None:
            path.append(dart)
    return path[::-1]


def _untwist(draft: Draft, faces: Faces) -> bool:
    """Turn over a part that hangs on one crossing only, and so take that crossing away."""
    at = faces[1]
    for p in draft.ports:
        if p >= 0 and at[p] == at[p ^ 2]:
            # The face on the left of p lies on both sides: what hangs on p and the port before it is a part.
            part = _hanging(draft, p)
            if part is None:
                continue
            _turn_over(draft, part)
            draft.remove([p >> 2])
            return True
    return False


def _hanging(draft: Draft, p: int) -> set[int] | None:
    """The crossings beyond port p of a crossing, without it; None if there are ends among them."""
    todo = [draft.mate[p] >> 2]
    part: set[int] = set()
    while todo:
        c = todo.pop()
        if c < 0:
            return None
        if c not in part and c != p >> 2:
            part.add(c)
            todo += [draft.mate[4 * c + i] >> 2 for i in range(4)]
    return part


def _turn_over(draft: Draft, part: set[int]) -> None:
    """Turn a part by half a turn about an axis in the plane: what was above comes below, left comes right."""

    def turned(p: int) -> int:
        return p & ~3 | 1 - p & 3 if p >> 2 in part else p

    mate = draft.mate
    ports = {p for c in part for p in range(4 * c, 4 * c + 4)}
    ports |= {mate[p] for p in ports}
    new = {turned(p): turned(mate[p]) for p in ports}
    for p, q in new.items():
        mate[p] = q
    draft.starts = [turned(s) if s >= 0 else s for s in draft.starts]
    draft.outer = [p for p in draft.outer if p >> 2 not in part]
