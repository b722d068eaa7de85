"""A planar diagram as an oriented PD code: who enters each crossing where, and what follows from it.

A crossing is four edge labels (a, b, c, d), a the incoming under edge, then counterclockwise. So the
under strand runs a → c, and the over strand d → b at a positive crossing, b → d at a negative one: the
sign of `docs/notation.md`, right-handed crossings positive. (This is the planar diagram code of KnotTheory
and KnotInfo.) Components that cross nothing are counted apart, as circles.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from torsade.errors import TorsadeError
from torsade.topology._ports import connected, faces

__all__ = ["Code", "Crossing", "oriented"]

Crossing = tuple[int, int, int, int]
Dart = tuple[int, int]  # a crossing, and the slot 0 to 3 by which it is left


@dataclass(frozen=True)
class Code:
    """A checked PD code, its edges numbered from 0 along one component after the other.

    Attributes:
        crossings: edges (a, b, c, d) at each crossing.
        signs: +1 or -1 of each crossing.
        components: the edges of each component in the order they are travelled.
        circles: components without crossings, over and above those.
    """

    crossings: tuple[Crossing, ...]
    signs: tuple[int, ...]
    components: tuple[tuple[int, ...], ...]
    circles: int = 0

    @property
    def n_components(self) -> int:
        """Number of components, circles among them."""
        return len(self.components) + self.circles

    @property
    def writhe(self) -> int:
        """Sum of all signs."""
        return sum(self.signs)

    @cached_property
    def ends(self) -> dict[int, tuple[Dart, Dart]]:
        """Of each edge, the crossing and slot where it begins, and those where it ends."""
        begin: dict[int, Dart] = {}
        end: dict[int, Dart] = {}
        for c, (edges, sign) in enumerate(zip(self.crossings, self.signs, strict=True)):
            over_in = 3 if sign > 0 else 1
            for slot, edge in enumerate(edges):
                (end if slot in (0, over_in) else begin)[edge] = (c, slot)
        return {edge: (begin[edge], end[edge]) for edge in begin}

    @cached_property
    def mate(self) -> tuple[int, ...]:
        """The place at the other end of the edge at each, slot s of crossing c being place 4c + s."""
        mate = [0] * (4 * len(self.crossings))
        for (c, slot), (d, arrival) in self.ends.values():
            mate[4 * c + slot], mate[4 * d + arrival] = 4 * d + arrival, 4 * c + slot
        return tuple(mate)

    @cached_property
    def corners(self) -> list[list[int]]:
        """Faces: corners[c][s] is the one between slots s and s + 1 of crossing c.

        An edge that leaves crossing c by slot s has corner s on its left, and corner s - 1 on its right.
        """
        _, at = faces(self.mate, {})
        return [at[p : p + 4] for p in range(0, len(at), 4)]

    @cached_property
    def pieces(self) -> list[list[int]]:
        """The crossings of each connected piece of the drawing."""
        return [[p >> 2 for p in piece[::4]] for piece in connected(self.mate, 0)]

    @cached_property
    def linking(self) -> tuple[tuple[int, ...], ...]:
        """Linking numbers of the components: half the sum of the signs of their crossings, 0 of circles."""
        owner = {edge: k for k, edges in enumerate(self.components) for edge in edges}
        table = [[0] * self.n_components for _ in range(self.n_components)]
        for (a, b, _, _), sign in zip(self.crossings, self.signs, strict=True):
            i, k = owner[a], owner[b]
            if i != k:
                table[i][k] += sign
                table[k][i] += sign
        return tuple(tuple(twice // 2 for twice in row) for row in table)

    def mirrored(self) -> Code:
        """The drawing seen in a mirror behind it, over and under as they are."""
        return oriented([(a, d, c, b) for a, b, c, d in self.crossings], self.circles)

    def sublink(self, kept: Iterable[int]) -> Code:
        """The link of these components alone, counted in the order of `components`, then circles."""
        chosen = set(kept)
        owner = {edge: k for k, edges in enumerate(self.components) for edge in edges}
        left = [c for c, (a, b, _, _) in enumerate(self.crossings) if {owner[a], owner[b]} <= chosen]
        label: dict[Dart, int] = {}
        circles = sum(k >= len(self.components) for k in chosen)
        for k, edges in enumerate(self.components):
            arrivals = [end for edge in edges if (end := self.ends[edge][1])[0] in left]
            if k not in chosen:
                continue
            circles += not arrivals
            base = len(label) // 2
            for i, (c, slot) in enumerate(arrivals):
                label[c, slot] = base + i
                label[c, (slot + 2) % 4] = base + (i + 1) % len(arrivals)
        return oriented([[label[c, slot] for slot in range(4)] for c in left], circles)


def oriented(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> Code:
    """The checked code of a PD code, or of a code itself.

    The under strands say which way components run; labels that rise along it say so for a component that
    is always over. Of one with two edges, always over, nothing does, and nothing depends on it: it lies
    above the rest, and is split from it.

    Raises:
        TorsadeError: labels that do not come in pairs, strands that meet head-on, or a drawing that
            needs handles.
    """
    if isinstance(pd, Code):
        return pd
    rows = _checked_rows(pd, circles)
    places: dict[int, list[Dart]] = {}
    for c, row in enumerate(rows):
        for slot, label in enumerate(row):
            places.setdefault(label, []).append((c, slot))
    odd = sorted(label for label, found in places.items() if len(found) != 2)
    if odd:
        raise TorsadeError(f"edge {odd[0]} of the PD code is at {len(places[odd[0]])} places, expected 2")
    number: dict[int, int] = {}
    components = []
    over_enters: dict[int, int] = {}
    for first in sorted(places):
        if first in number:
            continue
        walk = _directed(_walk(rows, places, first), places)
        start = len(number)
        for label, (c, slot) in walk:
            number[label] = len(number)
            if slot % 2:
                over_enters[c] = slot
        components.append(tuple(range(start, len(number))))
    crossings = tuple((number[a], number[b], number[c], number[d]) for a, b, c, d in rows)
    signs = tuple(1 if over_enters[c] == 3 else -1 for c in range(len(rows)))
    code = Code(crossings, signs, tuple(components), circles)
    n_faces = 1 + max((face for row in code.corners for face in row), default=-1)
    if n_faces != len(rows) + 2 * len(code.pieces):
        raise TorsadeError("the PD code cannot be drawn in the plane; check the order around its crossings")
    return code


def _checked_rows(pd: Sequence[Sequence[int]], circles: int) -> list[Crossing]:
    """The crossings as tuples of four integers."""
    if circles < 0:
        raise TorsadeError(f"circles is {circles}; give the number of components without crossings")
    rows: list[Crossing] = []
    for row in pd:
        if len(row) != 4:
            raise TorsadeError(f"a crossing of the PD code has {len(row)} edges, expected 4")
        a, b, c, d = (int(label) for label in row)
        rows.append((a, b, c, d))
    return rows


def _walk(rows: list[Crossing], places: dict[int, list[Dart]], first: int) -> list[tuple[int, Dart]]:
    """A component from edge `first`: each edge, and the crossing and slot where this walk ends it."""
    walk = []
    arrival = places[first][0]
    label = first
    while True:
        walk.append((label, arrival))
        c, leaving = arrival[0], (arrival[1] + 2) % 4
        label = rows[c][leaving]
        if label == first:
            return walk
        one, two = places[label]
        arrival = two if one == (c, leaving) else one


def _directed(walk: list[tuple[int, Dart]], places: dict[int, list[Dart]]) -> list[tuple[int, Dart]]:
    """The walk, turned round where it goes against the component's orientation."""
    slots = {slot for _, (_, slot) in walk}
    if slots >= {0, 2}:
        raise TorsadeError(f"the strand through edge {walk[0][0]} of the PD code is entered from both ends")
    labels = [label for label, _ in walk]
    rises = sum(b == a + 1 for a, b in pairwise(labels))
    falls = sum(b == a - 1 for a, b in pairwise([*labels[1:], labels[0]]))
    if 0 in slots or (2 not in slots and rises >= falls):
        return walk
    turned = []
    for label, arrival in [walk[0], *walk[:0:-1]]:
        one, two = places[label]
        turned.append((label, two if arrival == one else one))
    return turned
