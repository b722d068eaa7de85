"""Linear systems of nodes in a row or a ring, each coupled with two neighbours on either side: kernels."""

from __future__ import annotations

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index


def solve_band(
    first: Index,
    last: Index,
    diagonal: Floats,
    next1: Floats,
    next2: Floats,
    w1: Floats,
    w2: Floats,
    y: Floats,
) -> None:
    """Solve in place for nodes from first to before last: symmetric, two neighbours on each side, cyclic.

    next1, next2 (n,) couple a node with the next and the one after; those of the last nodes go round to the
    first. y (n, 3) holds the right side, then the solution. Eliminates from the first node on; the last two
    nodes see all others through w1, w2 (n,), which are scratch. At least 5 nodes.
    """
    p = last - 2
    q = last - 1
    for i in range(first, last):
        w1[i] = 0.0
        w2[i] = 0.0
    # Couplings of the last two nodes to the first ones; those to their own neighbours are next1, next2.
    w1[first] += next2[p]
    w2[first] += next1[q]
    w2[first + 1] += next2[q]
    corner = next1[p]
    w1[p - 2] += next2[p - 2]
    w1[p - 1] += next1[p - 1]
    w2[p - 1] += next2[p - 1]
    for i in range(first, p):
        d = 1.0 / diagonal[i]
        a = next1[i] if i + 1 < p else 0.0
        b = next2[i] if i + 2 < p else 0.0
        u = w1[i]
        v = w2[i]
        if i + 1 < p:
            diagonal[i + 1] -= a * a * d
            w1[i + 1] -= a * u * d
            w2[i + 1] -= a * v * d
            for c in range(3):
                y[i + 1, c] -= a * d * y[i, c]
        if i + 2 < p:
            next1[i + 1] -= a * b * d
            diagonal[i + 2] -= b * b * d
            w1[i + 2] -= b * u * d
            w2[i + 2] -= b * v * d
            for c in range(3):
                y[i + 2, c] -= b * d * y[i, c]
        diagonal[p] -= u * u * d
        diagonal[q] -= v * v * d
        corner -= u * v * d
        for c in range(3):
            y[p, c] -= u * d * y[i, c]
            y[q, c] -= v * d * y[i, c]
    d = 1.0 / diagonal[p]
    diagonal[q] -= corner * corner * d
    for c in range(3):
        y[q, c] = (y[q, c] - corner * d * y[p, c]) / diagonal[q]
        y[p, c] = (y[p, c] - corner * y[q, c]) * d
    for i in range(p - 1, first - 1, -1):
        a = next1[i] if i + 1 < p else 0.0
        b = next2[i] if i + 2 < p else 0.0
        d = 1.0 / diagonal[i]
        for c in range(3):
            total = y[i, c] - w1[i] * y[p, c] - w2[i] * y[q, c]
            if i + 1 < p:
                total -= a * y[i + 1, c]
            if i + 2 < p:
                total -= b * y[i + 2, c]
            y[i, c] = total * d


compile_kernels(__name__)
