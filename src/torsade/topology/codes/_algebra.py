"""Algebraic tangles as expressions: fractions, and sums of them, with their symmetries and their notation.

A rational tangle is its fraction p/q. Any other algebraic tangle is a sum of such, side by side, with n
half turns behind it, or the same reflected in the diagonal. Half turns move from before a tangle to behind
it by a flype, which turns what it passes by half a turn about the horizontal axis.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import gcd

__all__ = [
    "ONE",
    "Rational",
    "Sum",
    "Tangle",
    "added",
    "closed_text",
    "negated",
    "numerator",
    "rotated",
    "text",
]


@dataclass(frozen=True)
class Rational:
    """The rational tangle p/q in lowest terms, q >= 0; 1/0 is the tangle of two upright strands."""

    p: int
    q: int

    @staticmethod
    def of(p: int, q: int) -> Rational:
        """The fraction in lowest terms."""
        d = gcd(p, q) * (-1 if q < 0 or (q == 0 and p < 0) else 1)
        return Rational(p // d, q // d)


@dataclass(frozen=True)
class Sum:
    """Tangles side by side and then n half turns; if upright, all that reflected in the diagonal.

    No term is an integer, and no term is a sum side by side.
    """

    terms: tuple[Tangle, ...]
    n: int
    upright: bool = False


Tangle = Rational | Sum
ONE = Rational(1, 1)


# --- sums


def added(*tangles: Tangle) -> Tangle | None:
    """The sum of tangles, each of its rational terms between 0 and 1; None where it falls into two arcs."""
    parts: list[Tangle] = []
    for t in tangles:
        flat = isinstance(t, Sum) and not t.upright
        parts += [*t.terms, Rational(t.n, 1)] if flat and isinstance(t, Sum) else [t]
    terms: list[Tangle] = []
    n = 0
    for part in parts:
        passed = _overturned(part, n)
        if isinstance(passed, Rational):
            if passed.q == 0:
                return None
            n += passed.p // passed.q
            passed = Rational(passed.p % passed.q, passed.q)
        if passed != Rational(0, 1):
            terms.append(passed)
    if not terms:
        return Rational(n, 1)
    if len(terms) == 1 and isinstance(terms[0], Rational):
        return Rational(terms[0].p + n * terms[0].q, terms[0].q)
    return terms[0] if len(terms) == 1 and not n else Sum(tuple(terms), n)


# --- symmetries; upper strands stay above, except in `negated` and `_overturned`


def negated(t: Tangle) -> Tangle:
    """All crossings changed."""
    if isinstance(t, Rational):
        return Rational.of(-t.p, t.q)
    if t.upright:
        return _diagonal(negated(_diagonal(t)))
    return _side_by_side(map(negated, t.terms), -t.n)


def _side_by_side(terms: Iterable[Tangle], n: int) -> Tangle:
    """A sum of what was a sum before a symmetry."""
    total = added(*terms, Rational(n, 1))
    assert total is not None  # a symmetry makes no 1/0 of what is no integer's reflection
    return total


def _diagonal(t: Tangle) -> Tangle:
    """Reflected in the diagonal from NW to SE."""
    return Rational.of(t.q, t.p) if isinstance(t, Rational) else replace(t, upright=not t.upright)


def _upside_down(t: Tangle) -> Tangle:
    """Reflected in the horizontal line."""
    if isinstance(t, Rational):
        return negated(t)
    if t.upright:
        return _diagonal(_left_right(_diagonal(t)))
    return _side_by_side(map(_upside_down, t.terms), -t.n)


def _left_right(t: Tangle) -> Tangle:
    """Reflected in the vertical line."""
    if isinstance(t, Rational):
        return negated(t)
    if t.upright:
        return _diagonal(_upside_down(_diagonal(t)))
    terms = [_left_right(term) for term in reversed(t.terms)]
    return _side_by_side((_overturned(term, t.n) for term in terms), -t.n)


def _overturned(t: Tangle, times: int) -> Tangle:
    """Turned about the horizontal axis by so many half turns."""
    return negated(_upside_down(t)) if times % 2 else t


def rotated(t: Tangle, quarters: int = 1) -> Tangle:
    """Turned counterclockwise in the plane by quarter turns."""
    for _ in range(quarters % 4):
        t = _diagonal(_left_right(t))
    return t


def numerator(t: Tangle) -> Tangle | None:
    """A tangle with the same numerator, as simple as can be seen; None where that is a connected sum.

    N(a + b) is also N of both turned by a quarter, against each other; and N(p/q + r/s) is a rational knot.
    """
    while isinstance(t, Sum):
        if t.upright:
            return None
        first, *rest = t.terms
        if len(rest) > 1 or (rest and t.n and not any(isinstance(term, Rational) for term in t.terms)):
            return t
        if rest and isinstance(first, Rational):
            first, rest = rest[0], [_overturned(first, t.n)]  # a ring can be begun anywhere
        other = added(rest[0], Rational(t.n, 1)) if rest else Rational(t.n, 1)
        if isinstance(first, Rational) and isinstance(other, Rational):
            return _two_bridge(first, other)
        joined = None if other is None else added(rotated(first), rotated(other, -1))
        if joined is None:
            return None
        t = joined
    return t


def _two_bridge(a: Rational, b: Rational) -> Rational:
    """The tangle with the same numerator as a + b."""
    # A change of basis that takes -r/s to 0 takes p/q to (s p + r q)/(x p + y q), where y s - x r = 1.
    r, s = b.p, b.q
    y = pow(s, -1, abs(r)) if r else 1
    x = (y * s - 1) // r if r else 0
    return Rational.of(s * a.p + r * a.q, x * a.p + y * a.q)


# --- notation


def text(t: Tangle) -> str:
    """Conway's notation of a tangle."""
    if isinstance(t, Rational):
        return _fraction_text(t)
    if t.upright:
        return f"({text(_diagonal(t))}) 0"
    first, rest = _diagonal(t.terms[0]), t.terms[1:]
    if not rest:
        return f"({text(first)}) {t.n}"
    if isinstance(first, Sum) and len(rest) > 1:
        return f"({text(first)}) ({text(Sum(rest, t.n))})"
    terms, n = _signed(t)
    parts = [_summand(_diagonal(term)) for term in terms]
    return ";".join(parts) + ("+" if n > 0 else "-") * abs(n)


def _signed(t: Sum) -> tuple[list[Tangle], int]:
    """The terms of a sum, with half turns of -1 taken into them if there are several."""
    terms, n = list(t.terms), t.n
    for k, term in enumerate(terms if n < -1 else ()):
        if isinstance(term, Rational) and n < 0:
            terms[k], n = Rational(term.p - term.q, term.q), n + 1
    return terms, n


def _summand(t: Tangle) -> str:
    return text(t) if isinstance(t, Rational) else f"({text(t)})"


def _fraction_text(t: Rational) -> str:
    sign = "-" if t.p < 0 else ""
    return " ".join(sign + str(n) if n else "0" for n in twists(abs(t.p), t.q))


def twists(p: int, q: int) -> tuple[int, ...]:
    """The numbers of the rational tangle p/q >= 0, as in 3 1 2.

    >>> twists(11, 4)
    (3, 1, 2)
    """
    if q == 0:
        return (0, 0)
    found = [p // q]
    while p % q:
        p, q = q, p % q
        found.insert(0, p // q)
    if len(found) > 1 and found[0] == 1:
        return (found[1] + 1, *found[2:])
    return tuple(found)


def closed_text(t: Tangle) -> str:
    """Conway's notation of the knot or link that is the numerator of a tangle.

    Of its forms the one with fewest numbers, and the greatest first, is taken: of a rational knot among both
    ways to read it, else among all ways to begin with another summand, either way around.
    """
    if isinstance(t, Rational):
        p = abs(t.p)
        if p < 2:
            return str(p)
        q = (t.q if t.p > 0 else -t.q) % p
        forms = [(p, r) for r in (q, pow(q, -1, p))] + [(-p, p - r) for r in (q, pow(q, -1, p))]
        best = max(forms, key=lambda f: (-len(twists(p, f[1])), twists(p, f[1]), f[0]))
        return _fraction_text(Rational(*best))
    return max((text(one) for one in _turned(t)), key=lambda s: (s.startswith("("), -s.count("("), s))


def _turned(t: Sum) -> Iterator[Sum]:
    """The same ring of tangles begun at each of them, and seen from behind."""
    back = tuple(negated(_left_right(term)) for term in reversed(t.terms))
    for terms in (t.terms, tuple(_overturned(term, t.n) for term in back)):
        for k in range(len(terms)):
            ring = _side_by_side((*terms[k:], *(_overturned(term, t.n) for term in terms[:k])), t.n)
            if isinstance(ring, Sum):
                yield ring
