"""Graphs on a sphere whose vertices are crossings: ports, darts, faces and pieces.

A crossing c has four **ports** 4c, 4c + 1, 4c + 2, 4c + 3, counterclockwise. The ends of open strands lie
on a circle around the drawing; m ends are ports -m ... -1, counterclockwise. `mate[p]` is the port at the
other end of the edge that leaves port p (ends stand last in the tuple, so Python's negative indices find
them). A port is also a **dart**: its edge, run through away from it. Three steps suffice to walk anywhere:

- `mate[p]` goes along the edge,
- `p ^ 2` goes straight on through the crossing,
- `cw(p)` and `ccw(p)` turn to the next port around the crossing.

The face on the left of a dart p is walked counterclockwise by p → cw(mate[p]). The circle acts as one
more vertex, so the faces between neighbouring ends are found by the same rule.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from torsade.topology._ports import around, connected, faces

__all__ = ["PlanarMap"]


@dataclass(frozen=True, repr=False)
class PlanarMap:
    """Crossings joined by edges, on the sphere or in a disc.

    Attributes:
        mate: the port at the other end of each port's edge, 4n ports of crossings and then the ends.
        ends: names of the ends, counterclockwise around the drawing.
    """

    mate: tuple[int, ...]
    ends: tuple[str, ...]

    # --- counts

    @property
    def n_crossings(self) -> int:
        """Number of crossings."""
        return (len(self.mate) - len(self.ends)) // 4

    @property
    def ports(self) -> range:
        """All ports, ends first."""
        return range(-len(self.ends), 4 * self.n_crossings)

    # --- navigators

    def cw(self, p: int) -> int:
        """The next port clockwise around the crossing of p, or around the circle's far side from end p."""
        if p >= 0:
            return p & ~3 | p - 1 & 3
        return p + 1 if p < -1 else -len(self.ends)

    def ccw(self, p: int) -> int:
        """The next port counterclockwise; undoes `cw`."""
        if p >= 0:
            return p & ~3 | p + 1 & 3
        return p - 1 if p > -len(self.ends) else -1

    def corner(self, p: int) -> int:
        """The next dart around the face on the left of dart p."""
        return self.cw(self.mate[p])

    def cycle(self, p: int, step: Callable[[int], int]) -> Iterator[int]:
        """p, step(p), step(step(p)) ... until it comes back."""
        q = p
        while True:
            yield q
            q = step(q)
            if q == p:
                return

    # --- faces

    @cached_property
    def _walked(self) -> tuple[tuple[tuple[int, ...], ...], tuple[int, ...]]:
        """The faces, and the one at each dart."""
        found, at = faces(self.mate, around(range(-len(self.ends), 0)))
        return tuple(map(tuple, found)), tuple(at)

    @cached_property
    def faces(self) -> tuple[tuple[int, ...], ...]:
        """The faces, each as the darts that have it on their left, counterclockwise."""
        return self._walked[0]

    @cached_property
    def face_at(self) -> tuple[int, ...]:
        """The face on the left of each dart, indexed like `mate`."""
        return self._walked[1]

    # --- pieces and planarity

    @cached_property
    def pieces(self) -> tuple[tuple[int, ...], ...]:
        """Ports of each connected piece; the ends make one piece of all they touch."""
        return tuple(map(tuple, connected(self.mate, len(self.ends))))

    @cached_property
    def piece_at(self) -> tuple[int, ...]:
        """The piece of each port, indexed like `mate`."""
        at = [0] * len(self.mate)
        for k, piece in enumerate(self.pieces):
            for p in piece:
                at[p] = k
        return tuple(at)

    @property
    def genus(self) -> int:
        """Genus of the surface on which the graph can be drawn: 0 for a planar diagram.

        Half of 2 - V + E - F for each piece; the circle of ends counts as a vertex.
        """
        vertices = self.n_crossings + bool(self.ends)
        return (2 * len(self.pieces) - vertices + len(self.mate) // 2 - len(self.faces)) // 2
