"""Drawing a code that does not say to which side strands cross: Gauss codes without signs, and DT.

The graph is known, and at each crossing which edges are opposite; unknown is the sign of each crossing.
The graph lies on a sphere exactly if any two of its cycles cross an even number of times. It is enough
to ask this of the cycles that the edges outside a spanning tree close. Two of those have at most one
path in common, from a crossing u to a crossing v, and whether they change sides along it depends on
the product of the signs of u and v alone. So each pair of cycles says that two signs are equal or that
they are opposite: what is left is to colour a graph with two colours.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

from torsade.errors import TorsadeError
from torsade.topology.codes._planar import drawn
from torsade.topology.diagram import CIRCLE, Diagram

__all__ = ["realized", "rows_of"]

Cycle = dict[int, tuple[int, int]]
"""The crossings that a cycle goes through, and by which two of the ports 0, 1, 2, 3 of each."""


def rows_of(code: Sequence[int] | Sequence[Sequence[int]]) -> list[list[int]]:
    """A list for each strand: a code of a knot may be given as one list."""
    knot = [k for k in code if isinstance(k, int)]
    return [knot] if knot else [list(row) for row in code if not isinstance(row, int)]


def realized(strands: Sequence[Sequence[tuple[int, bool]]], what: str) -> Diagram:
    """The diagram of closed strands given as passages (crossing, over), each crossing once above, once below.

    Where signs are left open, the first crossing of those that hang together is right-handed.
    """
    n = sum(len(strand) for strand in strands) // 2
    mate = [0] * (4 * n)
    starts = []
    for strand in strands:
        entries = [4 * c + (3 if over else 0) for c, over in strand]
        for p, q in zip(
            [entries[-1] ^ 2 if entries else 0, *(q ^ 2 for q in entries)], entries, strict=False
        ):
            mate[p], mate[q] = q, p
        starts.append(mate[entries[0]] if entries else CIRCLE)
    flip = _signs(mate, what)
    # A left-handed crossing has its upper ports exchanged.
    side = [p ^ 2 if p & 1 and flip[p >> 2] else p for p in range(4 * n)]
    new = [0] * (4 * n)
    for p in range(4 * n):
        new[side[p]] = side[mate[p]]
    return drawn(new, [s if s == CIRCLE else side[s] for s in starts], (), None, what)


def _signs(mate: Sequence[int], what: str) -> list[int]:
    """0 for each right-handed crossing, 1 for each left-handed one."""
    n = len(mate) // 4
    parent, parity = list(range(n)), [0] * n

    def root(c: int) -> tuple[int, int]:
        """The first crossing known to be tied to c, and whether their signs differ."""
        odd = 0
        while parent[c] != c:
            odd ^= parity[c]
            c = parent[c]
        return c, odd

    for one, other in combinations(_cycles(mate), 2):
        odd, ends = 1, []
        for c in one.keys() & other.keys():
            a, b = one[c], other[c]
            shared = set(a) & set(b)
            if not shared and (a[0] ^ a[1]) == 2:
                raise TorsadeError(_not_planar(what))
            if len(shared) == 1:
                k = shared.pop()
                x, y = a[a[0] == k], b[b[0] == k]
                ends.append(c)
                odd ^= (x - k) % 4 > (y - k) % 4
        if ends:
            (u, odd_u), (v, odd_v) = root(ends[0]), root(ends[1])
            if u != v:
                u, v = sorted((u, v))
                parent[v], parity[v] = u, odd ^ odd_u ^ odd_v
            elif odd ^ odd_u ^ odd_v:
                raise TorsadeError(_not_planar(what))
    return [root(c)[1] for c in range(n)]


def _cycles(mate: Sequence[int]) -> Iterator[Cycle]:
    """The cycles closed by the edges outside a spanning tree."""
    n = len(mate) // 4
    up: dict[int, int] = {}  # crossing → its port towards the root, or -1
    depth = [0] * n
    for first in range(n):
        if first in up:
            continue
        up[first] = -1
        todo = [first]
        for c in todo:  # grows as it is read
            for q in (mate[4 * c + i] for i in range(4)):
                if q >> 2 not in up:
                    up[q >> 2] = q
                    depth[q >> 2] = depth[c] + 1
                    todo.append(q >> 2)
    tree = set(up.values()) | {mate[q] for q in up.values() if q >= 0}
    for p in range(4 * n):
        if p < mate[p] and p not in tree:
            cycle: Cycle = {}
            p, q = p, mate[p]
            while p >> 2 != q >> 2:
                if depth[p >> 2] < depth[q >> 2]:
                    p, q = q, p
                out = up[p >> 2]
                cycle[p >> 2] = (p & 3, out & 3)
                p = mate[out]
            cycle[p >> 2] = (p & 3, q & 3)
            yield cycle


def _not_planar(what: str) -> str:
    return (
        f"the {what} cannot be drawn in the plane: strands would have to cross elsewhere; check its numbers"
    )
