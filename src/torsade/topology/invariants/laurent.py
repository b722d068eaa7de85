"""Laurent polynomials with integer coefficients, exact, in t or in its square root.

Exponents go up in steps of one from a lowest exponent that is an integer or half of one: the Jones
polynomial of a link with an even number of components has half-integer exponents throughout.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

from torsade.errors import TorsadeError

__all__ = ["ONE", "ZERO", "Laurent"]


@dataclass(frozen=True, slots=True)
class Laurent:
    """sum_k coefficients[k] t^(halves/2 + k), with neither end of `coefficients` zero.

    Make one with `Laurent.of`, which trims zeros; two are equal when they are the same polynomial.

    >>> trefoil = Laurent.of(1, [1, 0, 1, -1])
    >>> print(trefoil)
    t + t^3 - t^4
    >>> print(trefoil.mirrored() * trefoil.mirrored())
    t^-8 - 2t^-7 + t^-6 - 2t^-5 + 2t^-4 + t^-2
    """

    halves: int
    coefficients: tuple[int, ...]

    @classmethod
    def of(cls, lowest: Fraction | float, coefficients: Iterable[int]) -> Laurent:
        """The polynomial with these coefficients from exponent `lowest` up, an integer or half of one."""
        halves = int(2 * lowest)
        if halves != 2 * lowest:
            raise TorsadeError(f"the lowest exponent is {lowest}; give an integer or half of one")
        row = list(coefficients)
        while row and row[-1] == 0:
            row.pop()
        zeros = next((k for k, c in enumerate(row) if c), 0)
        return cls(halves + 2 * zeros, tuple(row[zeros:])) if row else cls(0, ())

    @classmethod
    def unpacked(cls, packed: int, bits: int) -> Laurent:
        """The polynomial whose value at t = 2^bits is `packed`: every |coefficient| < 2^(bits - 1).

        Kronecker's substitution: with room for its coefficients side by side, a polynomial is one integer,
        and integer arithmetic is polynomial arithmetic.
        """
        row = []
        base, half = 1 << bits, 1 << (bits - 1)
        while packed:
            low = packed & (base - 1)
            if low >= half:
                low -= base
            row.append(low)
            packed = (packed - low) >> bits
        return cls.of(0, row)

    @property
    def lowest(self) -> Fraction:
        """The lowest exponent, 0 for the zero polynomial."""
        return Fraction(self.halves, 2)

    @property
    def span(self) -> int:
        """Highest exponent minus lowest."""
        return max(len(self.coefficients) - 1, 0)

    @property
    def alternating_sum(self) -> int:
        """|p(-1)|: of an Alexander polynomial, the determinant."""
        return abs(sum(self.coefficients[::2]) - sum(self.coefficients[1::2]))

    def shifted(self, by: Fraction | float) -> Laurent:
        """The polynomial times t^by."""
        return Laurent.of(self.lowest + Fraction(by), self.coefficients)

    def centred(self) -> Laurent:
        """The polynomial times the power of t that gives exponents symmetric about 0."""
        return Laurent.of(Fraction(-self.span, 2), self.coefficients)

    def mirrored(self) -> Laurent:
        """The polynomial with 1/t for t."""
        return Laurent.of(-self.lowest - self.span, self.coefficients[::-1])

    def quotient(self, divisor: Laurent) -> Laurent | None:
        """This over `divisor` where that is a Laurent polynomial with integer coefficients, else None."""
        rest, by = list(self.coefficients), divisor.coefficients
        if not by:
            raise TorsadeError("a polynomial is divided by zero; give a divisor that is not zero")
        found = []
        for k in range(len(rest) - len(by) + 1):
            digit, remainder = divmod(rest[k], by[0])
            if remainder:
                return None
            found.append(digit)
            for i, c in enumerate(by):
                rest[k + i] -= digit * c
        return None if any(rest) else Laurent.of(self.lowest - divisor.lowest, found)

    def __call__(self, root: complex) -> complex:
        """The value at t = root^2: the argument is the square root, whose branch half-integers need."""
        t = root * root
        value: complex = 0
        for c in reversed(self.coefficients):
            value = value * t + c
        return value * root**self.halves

    def __bool__(self) -> bool:
        return bool(self.coefficients)

    def __neg__(self) -> Laurent:
        return Laurent(self.halves, tuple(-c for c in self.coefficients))

    def __add__(self, other: Laurent) -> Laurent:
        if not self or not other:
            return self or other
        if (self.halves - other.halves) % 2:
            raise TorsadeError(f"{self} and {other} are added; give exponents that differ by integers")
        low, high = sorted((self, other), key=lambda p: p.halves)
        gap = (high.halves - low.halves) // 2
        row = list(low.coefficients) + [0] * (gap + len(high.coefficients) - len(low.coefficients))
        for k, c in enumerate(high.coefficients):
            row[gap + k] += c
        return Laurent.of(low.lowest, row)

    def __sub__(self, other: Laurent) -> Laurent:
        return self + (-other)

    def __mul__(self, other: Laurent) -> Laurent:
        if not self or not other:
            return ZERO
        row = [0] * (self.span + other.span + 1)
        for i, a in enumerate(self.coefficients):
            for k, b in enumerate(other.coefficients):
                row[i + k] += a * b
        return Laurent.of(self.lowest + other.lowest, row)

    def __str__(self) -> str:
        text = ""
        for k, c in enumerate(self.coefficients):
            if c:
                text += (" - " if c < 0 else " + ") + _term(abs(c), self.lowest + k)
        return text.replace(" - ", "-", 1) if text.startswith(" - ") else text[3:] or "0"


def _term(size: int, exponent: Fraction) -> str:
    """`size` t^`exponent`, as one writes it."""
    if exponent == 0:
        return str(size)
    number = "" if size == 1 else str(size)
    if exponent == 1:
        return f"{number}t"
    return f"{number}t^{exponent}" if exponent.denominator == 1 else f"{number}t^({exponent})"


ZERO = Laurent.of(0, [])
ONE = Laurent.of(0, [1])
