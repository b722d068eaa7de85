"""The Alexander polynomial from the relations of the knot group, by one integer determinant.

The rows u - t v - (1 - t) over present the Alexander module (see `wirtinger`). With arcs numbered by the
crossing where they begin, a diagonal minor is the polynomial up to a power of t, sign included
(R. Hartley, The Conway potential function for links, Comment. Math. Helv. 58 (1983) 365). Rows that say
what an arc is in terms of others are solved first; a small determinant over the seeds is left.

Polynomials are integers here, their values at t = 2^bits (`Laurent.unpacked`). On |t| = 1 a row has norm
at most sqrt(|1 - t|^2 + 2) <= sqrt(6), so by Hadamard no coefficient of the minor exceeds 6^(n/2) for n
crossings, which says how many bits are enough.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from torsade.topology.invariants.code import Code, oriented
from torsade.topology.invariants.laurent import ONE, ZERO, Laurent
from torsade.topology.invariants.wirtinger import Plan, Relation, plan, relations

__all__ = ["alexander"]

Form = tuple[int, list[int]]  # shift and row: sum of row[k] seed_k, over t^shift


def alexander(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> Laurent:
    """The Alexander polynomial Delta in Conway's normalisation, exactly.

    Delta(unknot) = 1 and Delta(L+) - Delta(L-) = (t^(1/2) - t^(-1/2)) Delta(L0). For a knot Delta is
    symmetric in t and 1/t and Delta(1) = 1; for a link of m components, the one-variable polynomial, all
    meridians going to t, Delta(1/t) = (-1)^(m-1) Delta(t). A split link has Delta = 0.
    """
    code = oriented(pd, circles)
    if not code.crossings:
        return ONE if code.circles == 1 else ZERO
    rows = relations(code) if len(code.pieces) + code.circles == 1 else None
    if rows is None:
        return ZERO
    bits = math.ceil(len(rows) * math.log2(6) / 2) + 3
    order = plan(rows)
    forms = _solved(rows, order, bits)
    steps = [step for stage in order.steps for step in stage]
    unused = sorted(set(range(len(rows))) - {step.row for step in steps})
    minor = _determinant([_residual(rows[k], forms, bits)[1:] for k in unused[1:]])
    columns = dict(zip(unused, order.seeds, strict=True)) | {step.row: step.target for step in steps}
    # On the diagonal is the arc that begins at the crossing: u of a negative one, or v, entering as -t.
    sign = _parity(columns) * math.prod(-code.signs[k] for k in range(len(rows)) if k != unused[0])
    sign *= math.prod(1 if step.forwards else -1 for step in steps)
    return Laurent.unpacked(sign * minor, bits).centred()


def _solved(rows: list[Relation], order: Plan, bits: int) -> list[Form]:
    """Every arc in terms of the seeds."""
    n = len(order.seeds)
    forms: list[Form] = [(0, [])] * len(rows)
    for k, (seed, stage) in enumerate(zip(order.seeds, order.steps, strict=True)):
        forms[seed] = 0, [int(i == k) for i in range(n)]
        for step in stage:
            row = rows[step.row]
            known = row.v if step.forwards else row.u
            shift, (x, y) = _aligned([forms[known], forms[row.over]], bits)
            if step.forwards:  # u = t v + (1 - t) over
                forms[step.target] = shift, [((a - b) << bits) + b for a, b in zip(x, y, strict=True)]
            else:  # v = (u - (1 - t) over)/t
                forms[step.target] = shift + 1, [a - b + (b << bits) for a, b in zip(x, y, strict=True)]
    return forms


def _residual(row: Relation, forms: list[Form], bits: int) -> list[int]:
    """u - t v - (1 - t) over in terms of the seeds, times a power of t."""
    _, (u, v, over) = _aligned([forms[arc] for arc in (row.u, row.v, row.over)], bits)
    return [a - c + ((c - b) << bits) for a, b, c in zip(u, v, over, strict=True)]


def _aligned(forms: list[Form], bits: int) -> tuple[int, list[list[int]]]:
    """The rows of these forms over one power of t, the largest."""
    most = max(shift for shift, _ in forms)
    return most, [[x << bits * (most - shift) for x in row] for shift, row in forms]


def _parity(columns: dict[int, int]) -> int:
    """The sign of a permutation."""
    sign, seen = 1, set()
    for start in columns:
        k, length = start, 0
        while k not in seen:
            seen.add(k)
            k = columns[k]
            length += 1
        sign *= -1 if length and length % 2 == 0 else 1
    return sign


def _determinant(matrix: list[list[int]]) -> int:
    """The determinant of an integer matrix, without fractions (Bareiss)."""
    rows, previous, sign = [list(row) for row in matrix], 1, 1
    while rows:
        k = next((k for k, row in enumerate(rows) if row[0]), None)
        if k is None:
            return 0
        pivot, *up = rows.pop(k)
        sign *= -1 if k % 2 else 1
        rows = [
            [(pivot * a - left * b) // previous for a, b in zip(row, up, strict=True)] for left, *row in rows
        ]
        previous = pivot
    return sign * previous
