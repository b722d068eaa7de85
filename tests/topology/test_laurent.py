"""Laurent polynomials against arithmetic on their values."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from torsade.errors import TorsadeError
from torsade.topology.invariants import Laurent
from torsade.topology.invariants.laurent import ONE, ZERO

polynomials = st.builds(Laurent.of, st.integers(-5, 5), st.lists(st.integers(-9, 9), max_size=6))


@given(polynomials, polynomials)
def test_arithmetic_is_that_of_values(p: Laurent, q: Laurent) -> None:
    t = Fraction(3, 2)

    def value(r: Laurent) -> Fraction:
        return sum((c * t ** (int(r.lowest) + k) for k, c in enumerate(r.coefficients)), Fraction(0))

    assert value(p + q) == value(p) + value(q)
    assert value(p - q) == value(p) - value(q)
    assert value(p * q) == value(p) * value(q)
    assert p.mirrored().mirrored() == p
    assert p.mirrored() * q.mirrored() == (p * q).mirrored()
    if q:
        assert (p * q).quotient(q) == p


@given(polynomials)
def test_a_packed_polynomial_unpacks(p: Laurent) -> None:
    packed = sum(c << 5 * k for k, c in enumerate(p.coefficients))
    assert Laurent.unpacked(packed, 5) == p.shifted(-p.lowest)


def test_a_quotient_that_is_no_polynomial() -> None:
    assert Laurent.of(0, [1, 1]).quotient(Laurent.of(0, [1, -1])) is None
    assert Laurent.of(0, [1, 1]).quotient(Laurent.of(0, [2])) is None
    assert ZERO.quotient(ONE) == ZERO


@pytest.mark.parametrize(
    ("polynomial", "text"),
    [
        (ZERO, "0"),
        (ONE, "1"),
        (Laurent.of(-4, [1, -1, 0, 2, -3]), "t^-4 - t^-3 + 2t^-1 - 3"),
        (Laurent.of(-0.5, [-1, -1]), "-t^(-1/2) - t^(1/2)"),
        (Laurent.of(0, [0, 0, 5, 0]), "5t^2"),
    ],
)
def test_how_it_prints(polynomial: Laurent, text: str) -> None:
    assert str(polynomial) == text


def test_parts_and_values() -> None:
    p = Laurent.of(Fraction(-3, 2), [0, 1, 0, -2])
    assert (p.lowest, p.coefficients, p.span) == (Fraction(-1, 2), (1, 0, -2), 2)
    assert p(2.0) == 4 ** (-0.5) - 2 * 4**1.5
    assert p.alternating_sum == 1
    assert p.centred() == Laurent.of(-1, [1, 0, -2])


def test_bad_exponents_and_division() -> None:
    with pytest.raises(TorsadeError, match="give an integer or half of one"):
        Laurent.of(0.25, [1])
    with pytest.raises(TorsadeError, match="exponents that differ by integers"):
        ONE + Laurent.of(0.5, [1])
    with pytest.raises(TorsadeError, match="divided by zero"):
        ONE.quotient(ZERO)
