"""Conway notation: knots and links from tangles put together.

- `3 1 2`, `312`: the rational tangle; its numerator is the knot, here and below. Each digit is a number,
  unless a space behind a number, before another or before the semicolon, shows that numbers are set apart:
  `12 3` and `12 ;3;2` begin with twelve, `123` and `12;3;2` with one.
- `21;3;2` (or with commas): each summand turned by a final 0, then added; `2+` and `2++` at the end add 1
  and 2 to the sum, `2-` adds -1.
- `(3;2)(21;2)`: a product of tangles; a minus before one changes all its crossings.
- `8*2:.20`: a basic polyhedron, here 8*, with tangles for its vertices; a colon stands for two points,
  and what is left out is 1. 6* need not be written; `.2.20` begins with a point and is 6**, the same
  polyhedron with its vertices in another order. Known are 6*, 6**, 8*, two vertices of 9*, and 10* bare.
  A minus before the polyhedron's name gives the mirror image of all.

A positive number twists so that the upper strand rises to the right, as `torsade.topology.tangle.integer`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from types import MappingProxyType
from typing import NamedTuple

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes._limits import limited
from torsade.topology.codes.braid import from_braid
from torsade.topology.diagram import CIRCLE, Diagram
from torsade.topology.tangle import integer, numerator, rational, rotated

__all__ = ["from_conway", "numbers_are_apart"]

DEEPEST = 50
"""How many parentheses may lie within each other."""


class _Polyhedron(NamedTuple):
    """A basic polyhedron as a closed alternating braid.

    Attributes:
        word: the braid; its letters are the vertices.
        order: the vertices in the order of the notation, as far as knots through ten crossings show it.
        turned: which vertices take their tangle turned, so that 2 stands there for 2 0.
    """

    word: tuple[int, ...]
    order: tuple[int, ...]
    turned: frozenset[int]


POLYHEDRA = MappingProxyType(
    {
        "6*": _Polyhedron((1, -2) * 3, (0, 1, 2, 3, 4, 5), frozenset((0, 2, 4))),
        # Written with a leading point: from pole to pole, and around the equator between.
        "6**": _Polyhedron((1, -2) * 3, (0, 1, 2, 4, 5), frozenset((2, 5))),
        "8*": _Polyhedron((1, -2) * 4, tuple(range(8)), frozenset((0, 2, 4, 6))),
        "9*": _Polyhedron((1, -2, 1, 3, -2, 1, 3, -2, 3), (0, 1), frozenset((0,))),
        "10*": _Polyhedron((1, -2) * 5, (), frozenset()),
    }
)


def from_conway(code: str) -> Diagram:
    """The diagram of a knot or link in Conway notation, with or without brackets around it.

    >>> from_conway("[22]").n_crossings, from_conway("3;3;2-").n_crossings, from_conway(".2.20").n_crossings
    (4, 8, 8)

    Raises:
        TorsadeError: what is not Conway notation, or a polyhedron that is not known; more than 500
            crossings; numbers of which is not clear whether they have two digits.
    """
    text = code.strip().removeprefix("[").removesuffix("]").replace(",", ";").strip()
    if not text:
        raise TorsadeError("the Conway code is empty; give tangles such as '2 1 2' or '3;21;2'")
    _check_numbers(text, code)
    plain = _plain(text)
    if re.search(r"[*.:]", plain):
        return _polyhedron(plain, code)
    return numerator(_tangle(plain, code))


def numbers_are_apart(text: str) -> bool:
    """Whether a code has a space between two numbers, or behind one, so that they may have two digits.

    >>> numbers_are_apart("12 ;3;2"), numbers_are_apart("12; 3; 2"), numbers_are_apart("3;3;2+ ")
    (True, False, False)
    """
    return re.search(r"\d\s+[\d;,]", text) is not None


def _check_numbers(text: str, code: str) -> None:
    """Refuse a code that is too large, or where 12 could be one number or two."""
    strange = re.search(r"(?![0-9])\d", text)
    if strange:
        raise TorsadeError(
            f"the Conway code {quoted(code)} has {strange[0]!r}, which is not understood; give numbers such "
            "as '2 1 2'"
        )
    apart = numbers_are_apart(text)
    long = re.search(r"\d\d+(?![\d*])", text)
    if long and not apart and re.search(r"[;)]\s+[\d(]", text):
        raise TorsadeError(
            f"the Conway code {quoted(code)} has {quoted(long[0])}, which may be one number or several; "
            "leave out the spaces or write as in '2 1;3;2' for several, as in '21 ;3 ;2' for one"
        )
    numbers = re.findall(r"\d+" if apart else r"\d", text)
    signs = text.count("+") + text.count("-")
    limited(len(numbers), "numbers", "Conway code")
    limited(sum(int(number.lstrip("0")[:9] or 0) for number in numbers) + signs, "crossings", "Conway code")
    depth = 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        if depth > DEEPEST:
            raise TorsadeError(
                f"the Conway code has more than {DEEPEST} parentheses within each other; give fewer"
            )


def _plain(text: str) -> str:
    """The code with spaces only between numbers, and numbers of several digits only where one is."""
    if not numbers_are_apart(text):
        text = re.sub(r"(?<=\d)(?=\d)(?!\d*\*)", " ", text)
    return re.sub(r"\s*([+\-;.:*()])\s*", r"\1", text)


def _tangle(text: str, code: str) -> Diagram:
    """The tangle of an algebraic code, as far as such are in use through ten crossings."""
    parser = _Parser(text, code)
    tangle = parser.sum()
    parser.expect_end()
    return tangle


class _Parser:
    """Reads `sum = product (; product)* signs`, `product = (-? factor)+`, `factor = number | ( sum )`."""

    def __init__(self, text: str, code: str) -> None:
        # Zeros before a number say nothing, and Python reads no number of 5000 digits.
        self.words: list[str] = re.findall(r"\d+|\S", re.sub(r"(?<!\d)0+(?=\d)", "", text))
        self.code = code
        self.place = 0

    @property
    def word(self) -> str:
        return self.words[self.place] if self.place < len(self.words) else ""

    def take(self) -> str:
        self.place += 1
        return self.words[self.place - 1]

    def sum(self) -> Diagram:
        first = self.place
        terms = [self.product()]
        while self.word == ";":
            self.take()
            first = self.place
            terms.append(self.product())
        last = self.words[first : self.place]
        extra = 0
        while self.word in ("+", "-"):
            extra += 1 if self.take() == "+" else -1
        if len(terms) == 1 and not extra:
            return terms[0]
        if extra < 0 and all(word.isdecimal() for word in last) and last[-1] != "0":
            terms[-1] = _less_one([int(word) for word in last])
            extra += 1
        total = terms[0] * integer(0)
        for term in terms[1:]:
            total = total + term * integer(0)
        return total + integer(extra) if extra else total

    def product(self) -> Diagram:
        total = self.factor()
        while self.word.isdecimal() or self.word == "(" or (self.word == "-" and self.after_minus()):
            total = total * self.factor()
        return total

    def after_minus(self) -> bool:
        """Whether a minus has a factor behind it, and is not the -1 at the end of a sum."""
        following = self.words[self.place + 1 : self.place + 2]
        return bool(following) and (following[0].isdecimal() or following[0] == "(")

    def factor(self) -> Diagram:
        sign = 1
        while self.word == "-":
            self.take()
            sign = -sign
        tangle = self.unsigned()
        return tangle if sign > 0 else -tangle

    def unsigned(self) -> Diagram:
        if self.word.isdecimal():
            return integer(int(self.take()))
        if self.word != "(":
            raise TorsadeError(
                f"the Conway code {quoted(self.code)} has {quoted(self.word) if self.word else 'its end'} "
                "where a tangle is due; give numbers, sums such as '3;2' and products such as '(3;2)21'"
            )
        self.take()
        inside = self.sum()
        if self.word != ")":
            raise TorsadeError(f"the Conway code {quoted(self.code)} has a '(' that is not closed; close it")
        self.take()
        return inside

    def expect_end(self) -> None:
        if self.word:
            raise TorsadeError(
                f"the Conway code {quoted(self.code)} has {quoted(self.word)} where it should end; "
                "give tangles such as '2 1 2', '3;21;2-' or '(3;2)(21;2)'"
            )


def _less_one(twists: list[int]) -> Diagram:
    """The tangle x with x 0 = t 0 - 1, where t is rational, without the crossings that cancel.

    A fraction F makes 1/F - 1 = -1/G with G = 1 + 1/(F - 1); so 2 gives -2, 2 1 gives -3 and 3 gives -(2 1).
    """
    *before, n = twists
    if n > 1:
        return -rational(*before, n - 1, 1)
    return -rational(*before[:-1], before[-1] + 1) if before else rotated(integer(0))


def _polyhedron(text: str, code: str) -> Diagram:
    """A basic polyhedron with tangles for its vertices."""
    if re.match(r"-\d+\*", text):
        return _polyhedron(text[1:], code).mirror()
    found = re.fullmatch(r"(\d+\*+)?([^*]*)", text)
    name = found[1] or ("6**" if text.startswith((".", ":")) else "6*") if found else ""
    if not found or name not in POLYHEDRA:
        raise TorsadeError(
            f"the basic polyhedron of the Conway code {quoted(code)} is not known; "
            f"use one of {', '.join(POLYHEDRA)}"
        )
    word, order, turned = POLYHEDRA[name]
    parts = found[2].replace(":", "..").split(".") if found[2] else []
    if len(parts) > len(order):
        raise TorsadeError(
            f"the Conway code {quoted(code)} has {len(parts)} tangles, and only {len(order)} vertices of "
            f"{name} are numbered here; give a PD or DT code instead"
        )
    tangles = [integer(1)] * len(word)
    for v, part in zip(order, parts, strict=False):
        tangle = _vertex(part, code)
        tangles[v] = -rotated(tangle) if v in turned else tangle
    return _substituted(from_braid(word), tangles)


def _vertex(part: str, code: str) -> Diagram:
    """The tangle of a vertex; a minus before it changes all of it."""
    plain = part.lstrip("-")
    tangle = _tangle(plain, code) if plain else integer(1)
    return -tangle if (len(part) - len(plain)) % 2 else tangle


def _substituted(base: Diagram, tangles: Sequence[Diagram]) -> Diagram:
    """Crossing k of the base replaced by tangle k, such that the tangle 1 leaves it as it is."""
    offsets, n = [], 0
    for t in tangles:
        offsets.append(n)
        n += 4 * t.n_crossings
    # Corner k (SW, SE, NE, NW) of a tangle takes the place of port k + 3, as in `integer(1)`.
    mate = [
        p + offset for t, offset in zip(tangles, offsets, strict=True) for p in t.mate[: 4 * t.n_crossings]
    ]
    inside: dict[
        int, int
    ] = {}  # port of the base → where its strand goes on within: a port, or a port of the base
    for c, t in enumerate(tangles):
        for k in range(4):
            p, q = 4 * c + (k + 3 & 3), t.mate[k - 4]
            inside[p] = q + offsets[c] if q >= 0 else ~(4 * c + (q + 4 + 3 & 3))
    passed: set[int] = set()
    for p, q in inside.items():
        if q >= 0:
            far = base.mate[p]
            # Tangles such as 0 lead straight to another port of the base, and on from there.
            while (r := inside[far]) < 0:
                passed |= {far, ~r}
                far = base.mate[~r]
            mate[q] = r
    circles = _circles({p: base.mate[~q] for p, q in inside.items() if q < 0 and p not in passed})
    return Diagram.assemble(mate, [CIRCLE] * circles)


def _circles(onwards: dict[int, int]) -> int:
    """How many circles strands run in that meet no crossing, each in both directions, by where they go on."""
    found = 0
    while onwards:
        p, _ = next(iter(onwards.items()))
        found += 1
        while p in onwards:
            p = onwards.pop(p)
    return found // 2
