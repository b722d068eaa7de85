"""The Jones polynomial, by contracting the Kauffman bracket crossing after crossing.

    <crossing> = A <swept smoothing> + A^-1 <other smoothing>,   <D and a loop> = -(A^2 + A^-2) <D>,
    V(t) = (-A^3)^(-writhe) <D>  at  t = A^-4,  with <one loop> = 1

(L. H. Kauffman, State models and the Jones polynomial, Topology 26 (1987) 395). The swept smoothing opens
the two corners that the over strand sweeps when it turns counterclockwise.

A part of the diagram is a sum over the planar ways in which its loose edges can be joined, each with a
polynomial. Its width, the number of loose edges, decides the cost: a width of 2w has at most Catalan(w)
terms. The order of crossings is chosen to keep it narrow (as D. Bar-Natan does for Khovanov homology,
J. Knot Theory Ramifications 16 (2007) 243).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from functools import lru_cache

from torsade.errors import TorsadeError
from torsade.topology.invariants.code import Code, Crossing, oriented
from torsade.topology.invariants.goeritz import checkerboard
from torsade.topology.invariants.laurent import ZERO, Laurent

__all__ = ["jones"]

_MOST_WORK = 6_000_000
"""The greatest sum of 2^width over all steps, about two seconds: a width of 16 to 20."""

_LONG = 10_000  # bits of a polynomial after which its length counts as much as the number of them

_ALL_STARTS = 40  # with more crossings, about as many of them are tried as a start

Joins = tuple[tuple[int, int], ...]  # each loose edge and the one it is joined to, sorted


def jones(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> Laurent:
    """The Jones polynomial V(t), exactly.

    V(unknot) = 1 and t^-1 V(L+) - t V(L-) = (t^(1/2) - t^(-1/2)) V(L0): that of the right-handed trefoil
    is t + t^3 - t^4. Links with an even number of components have half-integer exponents.

    Raises:
        TorsadeError: a diagram so wide that this would take more than a few seconds.
    """
    code = oriented(pd, circles)
    return _of_code(code) if code.n_components else ZERO


@lru_cache(maxsize=512)
def _of_code(code: Code) -> Laurent:
    """V of a diagram that is not empty."""
    # With x = A^2, every crossing brings x^3 or x^2, of which x^2 A is taken back below, and keeps powers
    # of x positive, since a crossing closes at most two loops, each -(x + 1/x). With one loop for 1, a
    # piece's bracket is a sum of one power of A for each spanning tree of its checkerboard graph
    # (M. B. Thistlethwaite, Topology 26 (1987) 297); further pieces bring a loop each.
    bits = sum(_log_trees(code, piece) + 1 for piece in code.pieces) + 2
    return _normalised(Laurent.unpacked(_bracket(code, bits), bits), code)


def _log_trees(code: Code, piece: Sequence[int]) -> int:
    """A bound on log2 of the number of spanning trees of a checkerboard graph of a piece.

    A tree is a choice of one edge at each face of one colour but the largest, towards that.
    """
    dark = checkerboard(code, piece)
    size = Counter(face for c in piece for face in code.corners[c])
    halves = ([size[face] for face in dark if dark[face] == colour] for colour in (False, True))
    return min(math.prod(half) // max(half) for half in halves).bit_length()


def _normalised(packed: Laurent, code: Code) -> Laurent:
    """V from the bracket as a polynomial in x = A^2, times x^(2n) A^n and the value of one loop."""
    loop = Laurent.of(-1, [-1, 0, -1])
    for _ in range(code.circles):
        packed = packed * loop
    quotient = packed.quotient(loop)
    assert quotient is not None
    # x^(k - 2n) A^-n (-A^-3)^writhe = (-1)^writhe A^(2k - 5n - 3 writhe); t = A^-4 is x^-2.
    n, w = len(code.crossings), code.writhe
    lowest = -(2 * (quotient.lowest + quotient.span) - 5 * n - 3 * w) / 4
    return Laurent.of(lowest, [-c if w % 2 else c for c in quotient.coefficients[::-2]])


def _bracket(code: Code, bits: int) -> int:
    """The sum over states, as a polynomial in x = A^2 at 2^bits: every loop counts, no division by one."""
    states: dict[Joins, int] = {(): 1}
    for c in _order(code.crossings, bits):
        p, q, r, s = code.crossings[c]
        grown: dict[Joins, int] = {}
        for joins, value in states.items():
            for one, two, power in (((p, q), (r, s), 3), ((p, s), (q, r), 2)):
                mate = dict(joins)
                term = value << power * bits
                for _ in range(_join(mate, *one) + _join(mate, *two)):
                    term = -(term << bits) - (term >> bits)
                key = tuple(sorted(mate.items()))
                grown[key] = grown.get(key, 0) + term
        states = grown
    return states[()]


def _join(mate: dict[int, int], p: int, q: int) -> bool:
    """Add a strand from edge p to edge q to the joins; does that close a loop?"""
    if p == q or mate.get(p) == q:
        mate.pop(p, None)
        mate.pop(q, None)
        return True
    end_p, end_q = mate.pop(p, p), mate.pop(q, q)
    mate[end_p], mate[end_q] = end_q, end_p
    return False


def _order(crossings: tuple[Crossing, ...], bits: int) -> list[int]:
    """The crossings in an order that keeps the work small, found greedily from several starts."""
    n = len(crossings)
    at: dict[int, list[int]] = {}
    for c, edges in enumerate(crossings):
        for edge in edges:
            at.setdefault(edge, []).append(c)
    found = (_greedy(crossings, at, start, bits) for start in range(0, n, 1 + n // _ALL_STARTS))
    work, widest, order = min(found, default=(0, 0, []))
    if work > _MOST_WORK:
        raise TorsadeError(
            f"a diagram of {n} crossings, {widest} strands wide, is more than the Jones polynomial is "
            "computed for; simplify it first"
        )
    return order


def _greedy(
    crossings: tuple[Crossing, ...], at: dict[int, list[int]], start: int, bits: int
) -> tuple[int, int, list[int]]:
    """Work, greatest width, and the order that always adds the crossing held most already."""
    loose_at = [0] * len(crossings)
    loose: set[int] = set()
    left = set(range(len(crossings)))
    touched: set[int] = set()
    order: list[int] = []
    work, widest, c = 0, 0, start
    while True:
        order.append(c)
        left.discard(c)
        for edge in crossings[c]:
            loose ^= {edge}
            touched.update(at[edge])
            for other in at[edge]:
                loose_at[other] += 1
        touched &= left
        work += (_LONG + bits * len(order) << len(loose)) // _LONG
        widest = max(widest, len(loose))
        if not left:
            return work, widest, order
        c = max(touched or left, key=loose_at.__getitem__)
