"""A draft: a diagram to cut and paste, not oriented, that becomes a `Diagram` again when it is done.

A draft keeps only what surgery needs: which port faces which, even ports under and odd ports over.
Strands and outer faces are carried along as darts. A crossing that is gone leaves its ports facing
themselves, and its place is used again.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Sequence

from torsade.topology._ports import around, faces
from torsade.topology.diagram import CIRCLE, Diagram

__all__ = ["Draft"]


class Draft:
    """Ports that can be joined anew.

    Attributes:
        mate: as in `Diagram`, with ports that face themselves where a crossing is gone.
        starts: a dart for each strand, as in `Diagram`.
        ends: names of the ends.
        outer: darts with an outer face on their left.
    """

    def __init__(self, diagram: Diagram) -> None:
        self.mate = list(diagram.mate)
        self.starts = list(diagram.starts)
        self.ends = diagram.ends
        self.outer = list(diagram.outer)
        self._free: list[int] = []

    @classmethod
    def of_ports(
        cls, mate: Iterable[int], starts: Iterable[int], ends: Iterable[str], outer: Iterable[int]
    ) -> Draft:
        """A draft of what is not a diagram yet, as for `Diagram.assemble`."""
        return cls(Diagram(tuple(mate), tuple(ends), tuple(starts), tuple(outer)))

    def freeze(self, order: Sequence[int] | None = None) -> Diagram:
        """The diagram as it stands; crossings keep their order.

        Args:
            order: the ends counterclockwise around the drawing, if they are to be moved.
        """
        m = len(self.ends)
        tips = range(-m, 0) if order is None else order
        used = [p for p in range(len(self.mate) - m) if self.mate[p] != p]
        new = {p: k - m for k, p in enumerate(tips)} | {CIRCLE: CIRCLE} | {p: k for k, p in enumerate(used)}
        mate = [new[self.mate[p]] for p in (*used, *tips)]
        starts, outer = [new[p] for p in self.starts], [new[p] for p in self.outer]
        return Diagram.assemble(mate, starts, [self.ends[p] for p in tips], outer=outer)

    # --- looking around

    @property
    def ports(self) -> list[int]:
        """Ports in use, ends first."""
        return [p for p in range(-len(self.ends), len(self.mate) - len(self.ends)) if self.mate[p] != p]

    @property
    def n_crossings(self) -> int:
        """Number of crossings."""
        return (len(self.mate) - len(self.ends)) // 4 - len(self._free)

    def cw(self, p: int) -> int:
        """The next port clockwise, as in `Diagram`."""
        if p >= 0:
            return p & ~3 | p - 1 & 3
        return p + 1 if p < -1 else -len(self.ends)

    def faces(self) -> tuple[list[list[int]], list[int]]:
        """The darts around each face, and the face on the left of each dart."""
        return faces(self.mate, around(range(-len(self.ends), 0)))

    # --- cutting and pasting

    def join(self, p: int, q: int) -> None:
        """Lay an edge from port p to port q."""
        self.mate[p] = q
        self.mate[q] = p

    def new_crossing(self) -> int:
        """Port 0 of a crossing that faces nothing yet."""
        if self._free:
            return self._free.pop()
        p = len(self.mate) - len(self.ends)
        self.mate[p:p] = range(p, p + 4)
        return p

    def cross(self, p: int, dart: int, over: bool) -> int:
        """Lead the loose strand at port p across an edge, from the left of a dart to its right.

        Returns:
            The port where the strand, now beyond the edge, is loose again.
        """
        x = self.new_crossing() + (not over)
        # Seen along the dart the ports are: x behind, its left, ahead and its right.
        behind, right, ahead = x, x & ~3 | x + 1 & 3, x ^ 2
        beyond = self.mate[dart]
        self.join(ahead, beyond)
        self.join(behind, dart)
        self.join(p, right ^ 2)
        return right

    def remove(self, crossings: Collection[int]) -> None:
        """Take crossings away, and join the edges of each strand that went through."""
        self._leave(crossings)
        self._take(crossings, ())

    def _take(self, crossings: Collection[int], lost: Container[int]) -> None:
        """Take crossings away; passages through the ports `lost` are not joined."""
        mate = self.mate
        for c in crossings:
            for p in (4 * c, 4 * c + 1):
                before, after = mate[p], mate[p ^ 2]
                if p not in lost and before != p ^ 2:
                    self.join(before, after)
        for c in crossings:
            mate[4 * c : 4 * c + 4] = range(4 * c, 4 * c + 4)
            self._free.append(4 * c)

    def _leave(self, crossings: Collection[int]) -> None:
        """Move starts and outer darts away from crossings that are to go."""
        self.starts = [self._slid_back(s, crossings) for s in self.starts]
        self.outer = [p for p in (self._on_same_face(p, crossings) for p in self.outer) if p is not None]

    def _slid_back(self, start: int, crossings: Container[int]) -> int:
        """The start of a strand moved back along it to a place that stays; `CIRCLE` if there is none."""
        p = start
        while 0 <= p != CIRCLE and p >> 2 in crossings:
            p = self.mate[p ^ 2]
            if p == start:
                return CIRCLE
        return p

    def _on_same_face(self, dart: int, crossings: Container[int]) -> int | None:
        """A dart of the same face that leaves a crossing which stays, if there is one."""
        p = dart
        while p >> 2 in crossings:
            p = self.cw(self.mate[p])
            if p == dart:
                return None
        return p

    def reroute(self, arc: Sequence[int], path: Sequence[int], over: bool) -> None:
        """Take an arc away, and lay it anew above (or below) everything along a path.

        Args:
            arc: the ports through which it goes, in order: entry, exit, entry, exit ... The crossings of
                these ports go; a closed strand may be an arc as a whole.
            path: darts that the new arc crosses, from their left to their right.
            over: whether the arc passes above.
        """
        a, b = self.mate[arc[0]], self.mate[arc[-1]]
        lost, crossings = set(arc), sorted({p >> 2 for p in arc})
        closed = [k for k, s in enumerate(self.starts) if b == arc[0] and s in lost]
        path = [self._slid_back(p, crossings) for p in path]
        self._leave(crossings)
        z = self.new_crossing()  # z and z + 1 hold what the arc left loose; the new arc is laid from z ^ 2
        if closed:
            self.join(z, z + 1)
        else:
            self.join(a, z)
            self.join(b, z + 1)
        self._take(crossings, lost)
        p = z ^ 2
        for dart in path:
            p = self.cross(p, dart, over)
        self.join(p, z + 1 ^ 2)
        if path and closed:
            self.starts[closed[0]] = p
        self._take([z >> 2], ())
