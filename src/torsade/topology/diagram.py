"""Planar diagrams of knots, links and tangles: immutable values on which walking is easy.

A `Diagram` is a graph on the sphere (see `torsade.topology.planar` for ports, darts and how to walk) whose
strands are oriented. Port 4c is where the lower strand comes into crossing c, so even ports are under and
odd ports are over; the upper strand comes in at port 4c + 3 if the crossing is right-handed, and at 4c + 1
if it is left-handed.

>>> from torsade.topology.codes import from_pd
>>> trefoil = from_pd([(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 2)])
>>> trefoil.n_crossings, trefoil.writhe, len(trefoil.faces), len(trefoil.seifert_circles)
(3, 3, 5, 2)
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, listed, quoted
from torsade.topology._ports import CIRCLE, oriented
from torsade.topology.planar import PlanarMap

__all__ = ["CIRCLE", "Diagram", "strand_name"]


@dataclass(frozen=True, repr=False)
class Diagram(PlanarMap):
    """A diagram of oriented strands, open or closed, on the sphere or in a disc.

    Make one with `torsade.topology.project`, from a code (`torsade.topology.codes`), or from the ports
    of a graph with `assemble`; the constructor trusts its arguments.

    Attributes:
        mate: as in `PlanarMap`.
        ends: as in `PlanarMap`.
        starts: for each strand the port that its first edge leaves: an end, or a port where the strand
            comes out of a crossing; `CIRCLE` for a circle without crossings.
        outer: darts with the unbounded face on their left, at most one for each closed piece. Pieces
            that are not named have their longest face outside, the first of several.

    Pieces that are not connected count as drawn side by side: each has its own outer face.
    """

    starts: tuple[int, ...]
    outer: tuple[int, ...] = field(default=(), compare=False)

    # --- making

    @staticmethod
    def assemble(
        mate: Sequence[int],
        starts: Iterable[int] = (),
        ends: Sequence[str] | None = None,
        n_ends: int = 0,
        outer: Iterable[int] = (),
    ) -> Diagram:
        """The diagram of a graph whose strands are not oriented yet: even ports under, odd ports over.

        Args:
            mate: as in `Diagram`, but port 4c may be either of the two lower ports.
            starts: where strands begin, in order and direction; the port of any edge will do for an open
                strand. Strands not named follow in the order of their first port, from end to end, or
                into a crossing by that port.
            ends: names of the ends; by default A0 and A1 on strand A, and so on.
            n_ends: how many ends there are, where they have no names.
            outer: as in `Diagram`.
        """
        m = n_ends if ends is None else len(ends)
        begun, last, entry = oriented(mate, starts, m)
        turn = [0 if entry[p] else 2 for p in range(0, len(mate) - m, 4)]

        def turned(p: int) -> int:
            return p if p < 0 or p == CIRCLE else p ^ turn[p >> 2]

        new = [0] * len(mate)
        for p in range(-m, len(mate) - m):
            new[turned(p)] = turned(mate[p])
        names = list(ends) if ends is not None else [""] * m
        if ends is None:
            for k, s in enumerate(begun):
                if s < 0:
                    names[s], names[last[s]] = strand_name(k) + "0", strand_name(k) + "1"
        return Diagram(tuple(new), tuple(names), tuple(map(turned, begun)), tuple(map(turned, outer)))

    @staticmethod
    def circle() -> Diagram:
        """The unknot without crossings."""
        return Diagram((), (), (CIRCLE,))

    # --- counts, strands and edges

    @property
    def n_strands(self) -> int:
        """Number of strands, closed ones and circles without crossings among them."""
        return len(self.starts)

    @property
    def circles(self) -> int:
        """Number of circles without crossings."""
        return self.starts.count(CIRCLE)

    @cached_property
    def strands(self) -> tuple[tuple[int, ...], ...]:
        """For each strand the ports by which it enters crossings, in order: odd where it passes over.

        >>> from torsade.topology.codes import from_gauss
        >>> hopf = from_gauss("O1+ U2+ | U1+ O2+")
        >>> [[(p >> 2, "UO"[p & 1]) for p in strand] for strand in hopf.strands]
        [[(0, 'O'), (1, 'U')], [(0, 'U'), (1, 'O')]]
        """
        return tuple(self._passages(s) for s in self.starts)

    def _passages(self, start: int) -> tuple[int, ...]:
        if start == CIRCLE:
            return ()
        mate, passages, p = self.mate, [], start
        while True:
            q = mate[p]
            if q < 0:
                break
            passages.append(q)
            p = q ^ 2
            if p == start:
                break
        return tuple(passages)

    def is_open(self, strand: int) -> bool:
        """Whether a strand has two ends."""
        return self.starts[strand] < 0

    @cached_property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """(tail, head) of each edge, strand after strand: a strand's edge 0 is its first.

        An open strand with k passages has k + 1 edges, a closed one k, a circle none.
        """
        edges = []
        for start, passages in zip(self.starts, self.strands, strict=True):
            tails = [start, *(q ^ 2 for q in passages)]
            heads = list(passages)
            if start < 0:
                heads.append(self.mate[tails[-1]])
            edges += list(zip(tails, heads, strict=False))
        return tuple(edges)

    @cached_property
    def edge_at(self) -> tuple[int, ...]:
        """The edge at each port, indexed like `mate`."""
        at = [0] * len(self.mate)
        for e, (tail, head) in enumerate(self.edges):
            at[tail] = at[head] = e
        return tuple(at)

    @cached_property
    def edge_strand(self) -> tuple[int, ...]:
        """The strand of each edge."""
        counts = (len(q) + (s < 0) for s, q in zip(self.starts, self.strands, strict=True))
        return tuple(k for k, count in enumerate(counts) for _ in range(count))

    def edge_name(self, edge: int) -> str:
        """A0, A1 ... along strand A, then B0 ...: edge Ak comes after k passages."""
        strand = self.edge_strand[edge]
        return f"{strand_name(strand)}{edge - self.edge_strand.index(strand)}"

    def is_tail(self, p: int) -> bool:
        """Whether dart p runs along its edge, not against it."""
        return self.edges[self.edge_at[p]][0] == p

    # --- signs

    @cached_property
    def signs(self) -> tuple[int, ...]:
        """+1 for a right-handed crossing, -1 for a left-handed one."""
        signs = [0] * self.n_crossings
        for q in (q for strand in self.strands for q in strand if q & 1):
            signs[q >> 2] = 1 if q & 3 == 3 else -1
        return tuple(signs)

    @property
    def writhe(self) -> int:
        """Sum of all signs."""
        return sum(self.signs)

    @cached_property
    def strands_at(self) -> tuple[tuple[int, int], ...]:
        """(upper, lower) strand at each crossing."""
        at = [[0, 0] for _ in range(self.n_crossings)]
        for k, strand in enumerate(self.strands):
            for q in strand:
                at[q >> 2][1 - (q & 1)] = k
        return tuple((over, under) for over, under in at)

    @property
    def linking(self) -> NDArray[np.float64]:
        """Half the sum of the signs between each two strands, shape (n_strands, n_strands).

        The linking number where both are closed; the diagonal is zero.
        """
        linking = np.zeros((self.n_strands, self.n_strands))
        for sign, (i, j) in zip(self.signs, self.strands_at, strict=True):
            if i != j:
                linking[i, j] += sign / 2
                linking[j, i] += sign / 2
        return linking

    @property
    def is_alternating(self) -> bool:
        """Whether every edge between two crossings leads from over to under or from under to over."""
        return all(tail < 0 or head < 0 or (tail ^ head) & 1 for tail, head in self.edges)

    # --- faces

    @cached_property
    def outer_faces(self) -> frozenset[int]:
        """The unbounded faces: those that touch the circle of ends, and one of each closed piece."""
        outer = {f for f, face in enumerate(self.faces) if any(p < 0 for p in face)}
        named = {self.piece_at[p]: self.face_at[p] for p in reversed(self.outer)}
        for k, piece in enumerate(self.pieces):
            if piece[0] >= 0:  # a piece with ends has its outer faces around them
                faces = {named[k]} if k in named else {self.face_at[p] for p in piece}
                outer.add(max(faces, key=lambda f: (len(self.faces[f]), -f)))
        return frozenset(outer)

    def is_bounded(self, face: int) -> bool:
        """Whether a face is neither outside nor touches the circle of ends."""
        return face not in self.outer_faces

    def circulation(self, face: int) -> int:
        """Edges that run counterclockwise around a face, less those that run clockwise."""
        return sum(1 if self.is_tail(p) else -1 for p in self.faces[face])

    @property
    def seifert_circles(self) -> tuple[tuple[int, ...], ...]:
        """The closed curves left when every crossing is smoothed, as edges; () for a circle."""
        return self._smoothed[0]

    @property
    def seifert_arcs(self) -> tuple[tuple[int, ...], ...]:
        """The curves from end to end left when every crossing is smoothed, as edges."""
        return self._smoothed[1]

    @cached_property
    def _smoothed(self) -> tuple[tuple[tuple[int, ...], ...], tuple[tuple[int, ...], ...]]:
        """Closed curves and arcs left when every crossing is smoothed."""

        def step(tail: int) -> int:
            """From the tail of an edge to that of the next: turn to the side where the strand goes out."""
            q = self.mate[tail]
            if q < 0:
                return tail
            return self.cw(q) if (q & 1) ^ (self.signs[q >> 2] < 0) else self.ccw(q)

        seen: set[int] = set()
        loops: list[tuple[int, ...]] = [()] * self.circles
        arcs: list[tuple[int, ...]] = []
        # Ends come first, so that a curve begun elsewhere closes.
        for tail in sorted(tail for tail, _ in self.edges):
            if tail not in seen:
                curve = [tail]
                while (p := step(curve[-1])) not in (tail, curve[-1]):
                    curve.append(p)
                seen.update(curve)
                (arcs if tail < 0 else loops).append(tuple(self.edge_at[p] for p in curve))
        return tuple(loops), tuple(arcs)

    @property
    def is_connected(self) -> bool:
        """Whether all hangs together, the circle of ends included."""
        return len(self.pieces) + self.circles <= 1

    # --- new diagrams from old

    def mirror(self) -> Diagram:
        """The mirror image in the plane of the drawing: every crossing is changed."""

        def shifted(p: int) -> int:
            return p if p < 0 or p == CIRCLE else p & ~3 | p + 1 & 3

        mate = [0] * len(self.mate)
        for p in self.ports:
            mate[shifted(p)] = shifted(self.mate[p])
        return Diagram.assemble(mate, map(shifted, self.starts), self.ends, outer=map(shifted, self.outer))

    def reflected(self) -> Diagram:
        """The mirror image in a line of the drawing: ends come clockwise, upper strands stay above."""

        def over(p: int) -> int:
            return -1 - len(self.ends) - p if p < 0 else p if p == CIRCLE else p & ~3 | -p & 3

        mate = [0] * len(self.mate)
        for p in self.ports:
            mate[over(p)] = over(self.mate[p])
        outer = (over(self.mate[p]) for p in self.outer)
        return Diagram.assemble(mate, map(over, self.starts), self.ends[::-1], outer=outer)

    def reverse(self, strands: Iterable[int] | None = None) -> Diagram:
        """The same drawing with all strands, or those given, running the other way; ends keep names.

        Raises:
            TorsadeError: there is no such strand.
        """
        chosen = set(range(self.n_strands) if strands is None else strands)
        if not chosen <= set(range(self.n_strands)):
            raise TorsadeError(
                f"strands {sorted(chosen)} are to be reversed; give numbers from 0 to {self.n_strands - 1}"
            )
        starts = [self._last_port(k) if k in chosen else s for k, s in enumerate(self.starts)]
        return Diagram.assemble(self.mate, starts, self.ends, outer=self.outer)

    def _last_port(self, strand: int) -> int:
        """The port at the end of the edge before the first, or of the last one of an open strand."""
        start, passages = self.starts[strand], self.strands[strand]
        if start == CIRCLE:
            return CIRCLE
        if start >= 0:
            return self.mate[start]
        return self.mate[passages[-1] ^ 2] if passages else self.mate[start]

    def pulled(self, ends: str | Iterable[str]) -> Diagram:
        """The same drawing with every open strand running towards its pulled end.

        Args:
            ends: names of the pulled ends, one for each open strand: "A1B1" or ["A1", "B1"].

        Raises:
            TorsadeError: names that are not one end of each open strand.
        """
        given = re.findall(r"[^\W\d_]+\d+", ends) if isinstance(ends, str) else list(ends)
        wanted = set(given)
        finish = {k: self._last_port(k) for k in range(self.n_strands) if self.is_open(k)}
        tips = {k: (self.ends[self.starts[k]], self.ends[q]) for k, q in finish.items()}
        if len(wanted) != len(tips) or any(len(wanted & set(two)) != 1 for two in tips.values()):
            choices = (
                listed([" or ".join(sorted(two)) for two in tips.values()], " and ") or "none: all are closed"
            )
            raise TorsadeError(f"pulled ends are {quoted(ends)}; give one of each open strand, {choices}")
        return self.reverse(k for k, two in tips.items() if two[0] in wanted)

    def without_circles(self) -> Diagram:
        """The same diagram without its circles that cross nothing."""
        return replace(self, starts=tuple(s for s in self.starts if s != CIRCLE))

    def renamed(self, ends: Iterable[str]) -> Diagram:
        """The same diagram with other names of its ends, counterclockwise.

        Raises:
            TorsadeError: fewer names or more than there are ends, or one of them twice.
        """
        names = tuple(ends)
        if len(names) != len(self.ends) or len(set(names)) != len(names):
            raise TorsadeError(f"{len(self.ends)} ends are named {list(names)}; give each a name of its own")
        return replace(self, ends=names)

    def __repr__(self) -> str:
        count = f"{self.n_crossings} crossing{'s' * (self.n_crossings != 1)}"
        strands = f"{self.n_strands} strand{'s' * (self.n_strands != 1)}"
        return f"<Diagram: {count}, {strands}{', ends ' + ' '.join(self.ends) if self.ends else ''}>"

    # --- operators; what they do is written in `torsade.topology.tangle`

    def __add__(self, other: Diagram) -> Diagram:
        from torsade.topology import tangle

        return tangle.add(self, other)

    def __mul__(self, other: Diagram) -> Diagram:
        from torsade.topology import tangle

        return tangle.multiply(self, other)

    def __neg__(self) -> Diagram:
        return self.mirror()

    def __or__(self, other: Diagram) -> Diagram:
        from torsade.topology import tangle

        return tangle.union(self, other)

    def __matmul__(self, other: Diagram) -> Diagram:
        from torsade.topology import tangle

        return tangle.connected_sum(self, other)


def strand_name(k: int) -> str:
    """A, B ... Z, AA, AB ...

    >>> [strand_name(k) for k in (0, 25, 26, 701, 702)]
    ['A', 'Z', 'AA', 'ZZ', 'AAA']
    """
    name = ""
    k += 1
    while k:
        k, letter = divmod(k - 1, 26)
        name = chr(ord("A") + letter) + name
    return name
