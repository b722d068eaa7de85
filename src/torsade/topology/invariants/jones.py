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

from collections.abc import Sequence

from torsade.errors import TorsadeError
from torsade.topology.invariants.code import Code, Crossing, oriented
from torsade.topology.invariants.laurent import ZERO, Laurent

__all__ = ["jones"]

_WIDEST = 20
"""The greatest number of loose edges: 16,796 planar ways to join them, a minute for 250 crossings."""

_ALL_STARTS = 40  # with more crossings, only as many of them are tried as a start

Joins = tuple[tuple[int, int], ...]  # each loose edge and the one it is joined to, sorted


def jones(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> Laurent:
    """The Jones polynomial V(t), exactly.

    V(unknot) = 1 and t^-1 V(L+) - t V(L-) = (t^(1/2) - t^(-1/2)) V(L0): that of the right-handed trefoil
    is t + t^3 - t^4. Links with an even number of components have half-integer exponents.

    Raises:
        TorsadeError: a diagram so wide that this would take minutes.
    """
    code = oriented(pd, circles)
    n = len(code.crossings)
    if not n + code.circles:
        return ZERO
    # With x = A^2, every crossing brings x^3 or x^2, of which x^2 A is taken back below, and keeps powers
    # of x positive, since a crossing closes at most two loops, each -(x + 1/x). With one loop for 1, a
    # piece's bracket is a sum of one power of A for each spanning tree of its checkerboard graph
    # (M. B. Thistlethwaite, Topology 26 (1987) 297), of which there are fewer than 2^crossings.
    bits = n + len(code.pieces) + 2
    bracket = Laurent.unpacked(_bracket(code, bits), bits)
    return _normalised(bracket, n, code)


def _normalised(packed: Laurent, n: int, code: Code) -> Laurent:
    """V from the bracket as a polynomial in x = A^2, times x^(2n) A^n and the value of one loop."""
    loop = Laurent.of(-1, [-1, 0, -1])
    for _ in range(code.circles):
        packed = packed * loop
    quotient = packed.quotient(loop)
    assert quotient is not None
    # x^(k - 2n) A^-n (-A^-3)^writhe = (-1)^writhe A^(2k - 5n - 3 writhe); t = A^-4.
    w = code.writhe
    sign = -1 if w % 2 else 1
    found = ZERO
    for i, c in enumerate(quotient.coefficients):
        if c:
            power_of_a = 2 * (int(quotient.lowest) + i) - 5 * n - 3 * w
            found = found + Laurent.of(-power_of_a / 4, [sign * c])
    return found


def _bracket(code: Code, bits: int) -> int:
    """The sum over states, as a polynomial in x = A^2 at 2^bits: every loop counts, no division by one."""
    states: dict[Joins, int] = {(): 1}
    for c in _order(code.crossings):
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


def _order(crossings: tuple[Crossing, ...]) -> list[int]:
    """The crossings in an order that keeps the sum of 2^width small, found greedily from several starts."""
    n = len(crossings)
    at: dict[int, list[int]] = {}
    for c, edges in enumerate(crossings):
        for edge in edges:
            at.setdefault(edge, []).append(c)
    found = (_greedy(crossings, at, start) for start in range(0, n, 1 + n // _ALL_STARTS))
    _, widest, order = min(found, default=(0, 0, []))
    if widest > _WIDEST:
        raise TorsadeError(
            f"a diagram of {n} crossings is {widest} strands wide, more than the {_WIDEST} that the Jones "
            "polynomial is computed for; simplify it first"
        )
    return order


def _greedy(
    crossings: tuple[Crossing, ...], at: dict[int, list[int]], start: int
) -> tuple[int, int, list[int]]:
    """Sum of 2^width, greatest width, and the order that always adds the crossing held most already."""
    loose_at = [0] * len(crossings)
    loose: set[int] = set()
    left = set(range(len(crossings)))
    order: list[int] = []
    cost, widest, c = 0, 0, start
    while True:
        order.append(c)
        left.discard(c)
        for edge in crossings[c]:
            loose ^= {edge}
            for other in at[edge]:
                loose_at[other] += 1
        cost += 1 << len(loose)
        widest = max(widest, len(loose))
        if not left:
            return cost, widest, order
        c = max(left, key=loose_at.__getitem__)
