"""Which knot of the table a prime diagram of a knot can be."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from torsade.topology.factor import summands
from torsade.topology.invariants import (
    QUANDLES,
    Code,
    Laurent,
    alexander,
    colouring_polynomial,
    jones,
    signature,
)
from torsade.topology.invariants.laurent import ONE
from torsade.topology.names import UNKNOT, sum_name
from torsade.topology.table import TABLE_CROSSINGS, TIE_BREAKERS, KnotEntry, Polynomial, entries

__all__ = ["UNKNOT_CROSSINGS", "Match", "knot_name", "match_knot"]

UNKNOT_CROSSINGS = 24
"""Through this number of crossings only the unknot has Jones polynomial 1 (R. E. Tuzun, A. S. Sikora,
Verification of the Jones unknot conjecture up to 24 crossings, J. Knot Theory Ramifications 30 (2021))."""


@dataclass(frozen=True, slots=True)
class Match:
    """The names that a diagram can have, whether it is certainly the one named, and why not."""

    names: tuple[str, ...]
    certain: bool
    reason: str = ""


def match_knot(code: Code) -> Match:
    """The knots of the table, and the sums of them, with all the invariants of this diagram of a knot.

    Sums are formed of knots with no more crossings in all than the diagram has. With more crossings than
    the table goes to, colouring polynomials are compared even where one candidate is left without them.
    """
    n = len(code.crossings)
    v = jones(code)
    if v == ONE and n <= UNKNOT_CROSSINGS:
        return Match((UNKNOT,), True)
    candidates = list(_products(alexander(code), v, signature(code), n))
    if len(candidates) > 1 or n > TABLE_CROSSINGS:
        candidates = _with_colourings(code, candidates)
    names = tuple(sum_name(entry.name for entry in factors) for factors in candidates)
    if n <= TABLE_CROSSINGS and len(names) == 1:
        is_sum = len(candidates[0]) > 1
        hidden = f"{names[0]} is known by its invariants, the diagram does not show the sum"
        return Match(names, True, hidden if is_sum else "")
    return Match(names, False, _doubt(names, n))


def knot_name(code: Code) -> str | None:
    """The one name that a diagram of a knot can have, if there is one."""
    (piece,) = summands(code)
    names = [match_knot(part).names for part in piece]
    return sum_name(one for (one,) in names) if all(len(found) == 1 for found in names) else None


def _doubt(names: Sequence[str], n: int) -> str:
    """Why there is no certain name."""
    known = f"prime knots through {TABLE_CROSSINGS} crossings and their sums"
    if not names:
        return f"none of the {known} has the invariants of this diagram of {n} crossings"
    if len(names) > 1:
        return f"{' and '.join(names)} share the invariants compared"
    return (
        f"the invariants are those of {names[0]} alone among {known}, but the diagram has {n} crossings, "
        "and a knot beyond the table may share them"
    )


def _products(
    delta: Laurent, v: Laurent, sigma: int, crossings: int, first: int = 0
) -> Iterator[tuple[KnotEntry, ...]]:
    """Knots of the table, in order, whose sum has these invariants and at most so many crossings.

    Polynomials of a sum are products, so each factor's divides them, and what is left is looked up again.
    No knot of the table has Delta = 1, so this comes to an end.
    """
    if delta == ONE:
        if v == ONE and sigma == 0:
            yield ()
        return
    determinant = delta.alternating_sum
    for k, entry in enumerate(entries()[first:], first):
        if entry.crossings > crossings:
            return
        if determinant % entry.determinant:
            continue
        rest = delta.quotient(entry.alexander)
        rest_v = v.quotient(entry.jones) if rest else None
        if rest and rest_v:
            for others in _products(rest, rest_v, sigma - entry.signature, crossings - entry.crossings, k):
                yield (entry, *others)


def _with_colourings(code: Code, candidates: list[tuple[KnotEntry, ...]]) -> list[tuple[KnotEntry, ...]]:
    """The candidates that also have the diagram's colouring polynomials."""
    for name in TIE_BREAKERS if candidates else ():
        found = colouring_polynomial(code, QUANDLES[name])
        candidates = [
            factors
            for factors in candidates
            if _convolved([entry.colourings[name] for entry in factors], len(found)) == found
        ]
    return candidates


def _convolved(rows: Sequence[Polynomial], n: int) -> Polynomial:
    """The product of elements of the group ring of the cyclic group of order n."""
    total = [1] + [0] * (n - 1)
    for row in rows:
        total = [sum(total[i] * row[k - i] for i in range(n)) for k in range(n)]
    return tuple(total)
