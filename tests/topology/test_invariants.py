"""Invariants of knots against published values, closed forms, skein relations, and moves that keep them."""

from __future__ import annotations

import cmath
import random
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hanging import no_hang
from topology.drawing import (
    PD,
    braid,
    closed_bend,
    connected_sum,
    crossings_changed,
    knot_codes,
    mirrored,
    relabelled,
    shared,
    turned_round,
    with_bigon,
    with_kink,
)
from topology.drawings import closed_knots
from torsade.errors import TorsadeError
from torsade.topology.invariants import Laurent, alexander, determinant, jones, oriented, signature

KNOTS = knot_codes()
TREFOIL = KNOTS["3_1"]
Z = Laurent.of(-0.5, [-1, 1])  # t^(1/2) - t^(-1/2)

words = st.integers(2, 5).flatmap(
    lambda n: st.tuples(
        st.lists(st.integers(1, n - 1).flatmap(lambda i: st.sampled_from([i, -i])), min_size=1, max_size=12),
        st.just(n),
    )
)


def everything(pd: Sequence[Sequence[int]], circles: int = 0) -> tuple[Laurent, Laurent, int, int]:
    code = oriented(pd, circles)
    return alexander(code), jones(code), signature(code), determinant(code)


def parsed(text: str) -> Laurent:
    """A Jones polynomial as the shared codes write it: "+1t^-5 -2t^(-4/2)"."""
    total = Laurent.of(0, [])
    for term in text.split():
        c, exponent = term.split("t^")
        halves = exponent.strip("()").split("/")
        total += Laurent.of(int(halves[0]) / (2 if len(halves) > 1 else 1), [int(c)])
    return total


# --- conventions


def test_the_right_handed_trefoil() -> None:
    """Positive crossings, signature -2, V = t + t^3 - t^4; it is the 3_1 of the table."""
    assert oriented(TREFOIL).signs == (1, 1, 1)
    assert signature(TREFOIL) == -2
    assert str(jones(TREFOIL)) == "t + t^3 - t^4"
    assert str(alexander(TREFOIL)) == "t^-1 - 1 + t"
    assert everything(TREFOIL) == everything(*braid([1, 1, 1]))


def test_the_positive_hopf_link() -> None:
    pd, _ = braid([1, 1])
    assert oriented(pd).linking == ((0, 1), (1, 0))
    assert [str(p) for p in (alexander(pd), jones(pd))] == ["-t^(-1/2) + t^(1/2)", "-t^(1/2) - t^(5/2)"]
    assert (signature(pd), determinant(pd)) == (-1, 2)


@pytest.mark.parametrize("circles", [1, 2, 3])
def test_circles(circles: int) -> None:
    loop = Laurent.of(-0.5, [-1, -1])
    one = Laurent.of(0, [1])
    unlink = [one, loop, loop * loop][circles - 1]
    assert everything([], circles) == (one if circles == 1 else Laurent.of(0, []), unlink, 0, circles == 1)


# --- published values and closed forms


def test_signatures_are_the_published_ones() -> None:
    """KnotInfo's, whose sign is the one here."""
    published = {name: row["signature"] for name, row in closed_knots().items()}
    assert {name: signature(pd) for name, pd in KNOTS.items()} == published


def test_braids_and_pd_codes_are_the_same_knots() -> None:
    """Of each of the 249, mirror image included."""
    for name, row in closed_knots().items():
        for word in row["braids"]:
            assert everything(*braid(word)) == everything(KNOTS[name]), name


def test_closures_of_bends_have_the_published_jones_polynomials() -> None:
    """Knots and links of up to 12 crossings."""
    count = 0
    for bend in shared("bends.json").values():
        for closure in bend["closures"]:
            rows = closed_bend(bend["pd"], closure["joins"])
            assert jones(rows) == parsed(closure["jones"]), closure
            count += 1
    assert count > 20


@pytest.mark.parametrize(("p", "q"), [(2, 3), (2, 9), (3, 4), (3, 5), (3, 8), (4, 5), (4, 9), (5, 6)])
def test_torus_knots(p: int, q: int) -> None:
    """V. F. R. Jones, Ann. of Math. 126 (1987) 335, for V; Delta = (t^pq - 1)(t - 1)/((t^p - 1)(t^q - 1))."""

    def less_one(n: int) -> Laurent:
        return Laurent.of(0, [-1, *[0] * (n - 1), 1])

    pd, _ = braid(list(range(1, p)) * q)
    numerator = Laurent.of(0, [1]) + Laurent.of(p + q, [1]) - Laurent.of(p + 1, [1]) - Laurent.of(q + 1, [1])
    v = (-numerator).quotient(less_one(2))
    assert v is not None
    assert jones(pd) == v.shifted((p - 1) * (q - 1) / 2)
    delta = (less_one(p * q) * less_one(1)).quotient(less_one(p) * less_one(q))
    assert delta is not None
    assert alexander(pd) == delta.centred()


@pytest.mark.parametrize("name", KNOTS)
def test_special_values(name: str) -> None:
    """V(1) = 1, V'(1) = 0, |V(-1)| = determinant, V(e^(2 pi i/3)) = 1, V(i) = +-1; Delta(1) = 1, symmetric.

    V. F. R. Jones, Bull. Amer. Math. Soc. 12 (1985) 103; W. B. R. Lickorish, K. C. Millett (1986).
    """
    delta, v, sigma, det = everything(KNOTS[name])
    assert delta(1) == 1
    assert delta == delta.mirrored()
    assert delta.alternating_sum == det
    assert v(1) == 1
    assert sum(c * (v.halves + 2 * k) for k, c in enumerate(v.coefficients)) == 0
    assert v.alternating_sum == det
    assert cmath.isclose(v(cmath.exp(1j * cmath.pi / 3)), 1, rel_tol=1e-9)
    assert cmath.isclose(abs(v(cmath.exp(1j * cmath.pi / 4))), 1, rel_tol=1e-9)
    assert sigma % 4 == det % 4 - 1  # K. Murasugi: det = 1 or 3 mod 4 with sigma = 0 or 2 mod 4


# --- what changes, and what does not


@pytest.mark.parametrize("name", KNOTS)
def test_moves_change_nothing(name: str) -> None:
    rng = random.Random(name)
    pd = KNOTS[name]
    expected = everything(pd)
    assert everything(turned_round(pd)) == expected
    assert everything(relabelled(pd, rng)) == expected
    assert everything(with_kink(pd, rng)) == expected
    assert everything(with_bigon(pd, rng)) == expected


@pytest.mark.parametrize("name", KNOTS)
def test_mirror_images(name: str) -> None:
    delta, v, sigma, det = everything(KNOTS[name])
    expected = delta, v.mirrored(), -sigma, det
    assert everything(mirrored(KNOTS[name])) == expected
    assert everything(crossings_changed(KNOTS[name])) == expected


@settings(deadline=None, max_examples=50)
@given(st.sampled_from(list(KNOTS)), st.sampled_from(list(KNOTS)))
def test_connected_sums(one: str, two: str) -> None:
    delta, v, sigma, det = everything(KNOTS[one])
    delta_2, v_2, sigma_2, det_2 = everything(KNOTS[two])
    joined = connected_sum(KNOTS[one], KNOTS[two])
    assert everything(joined) == (delta * delta_2, v * v_2, sigma + sigma_2, det * det_2)


@settings(deadline=None, max_examples=150)
@given(words, st.integers(0, 11))
def test_skein_relations(drawn: tuple[list[int], int], at: int) -> None:
    """Delta+ - Delta- = z Delta0 and V+/t - t V- = z V0, for links too."""
    word, n = drawn
    at %= len(word)
    plus, minus, smoothed = (
        braid(word[:at] + middle + word[at + 1 :], n) for middle in ([abs(word[at])], [-abs(word[at])], [])
    )
    assert alexander(*plus) - alexander(*minus) == Z * alexander(*smoothed)
    assert jones(*plus).shifted(-1) - jones(*minus).shifted(1) == Z * jones(*smoothed)
    assert alexander(*plus).alternating_sum == determinant(*plus) == jones(*plus).alternating_sum


@settings(deadline=None, max_examples=100)
@given(words, st.integers(0, 11), st.sampled_from([1, -1]))
def test_moves_of_braids(drawn: tuple[list[int], int], at: int, sign: int) -> None:
    """Conjugation, a generator and its inverse, the braid relation, and Markov's stabilisation."""
    word, n = drawn
    at %= len(word)
    expected = everything(*braid(word, n))
    assert everything(*braid(word[at:] + word[:at], n)) == expected
    assert everything(*braid([*word[:at], sign, -sign, *word[at:]], n)) == expected
    assert everything(*braid([*word, sign * n], n + 1)) == expected
    if n > 2:
        ones = everything(*braid([*word[:at], 1, 2, 1, *word[at:]], n))
        assert everything(*braid([*word[:at], 2, 1, 2, *word[at:]], n)) == ones


@settings(deadline=None, max_examples=60)
@given(words)
def test_components_on_their_own(drawn: tuple[list[int], int]) -> None:
    """Linking numbers add up to the crossings between components; each keeps its crossings with itself."""
    code = oriented(*braid(*drawn))
    own = [code.sublink([k]) for k in range(code.n_components)]
    assert all(one.n_components == 1 for one in own)
    between = code.writhe - sum(one.writhe for one in own)
    assert sum(map(sum, code.linking)) == between
    assert jones(code.sublink(range(code.n_components))) == jones(code)


def test_many_crossings() -> None:
    """Polynomials agree at -1 for long braids, where arithmetic that is not exact would fail."""
    rng = random.Random(0)
    for n, length in ((3, 60), (5, 60), (8, 100)):
        word = [rng.choice([-1, 1]) * rng.randint(1, n - 1) for _ in range(length)]
        pd = braid(word, n)
        assert alexander(*pd).alternating_sum == jones(*pd).alternating_sum == determinant(*pd)


# --- large diagrams


def test_polynomials_of_large_diagrams_come_at_once_or_not() -> None:
    """T(2, n) has V = t^((n-1)/2) (1 + t^2 - t^3 + t^4 ... - t^n); nine generators 21 times are too wide."""
    n = 1501
    with no_hang():
        assert jones(*braid([1] * n, 2)) == Laurent.of((n - 1) // 2, [1, 0] + [1, -1] * ((n - 1) // 2))
    wide = oriented(*braid([*range(1, 10)] * 21, 10))
    long = oriented(*braid([1, -2, 2, -1, -1, 2] * 300 + [1, -2, 3] * 100, 4))
    for code in (wide, long):
        says = f"diagram of {len(code.crossings)} crossings, .* simplify"
        with no_hang(), pytest.raises(TorsadeError, match=says):
            jones(code)


def test_the_jones_polynomial_of_a_diagram_is_computed_once() -> None:
    code, again = (oriented(*braid([1, 2, 3, 4, 5, 6] * 13, 7)) for _ in range(2))
    first = jones(code)
    assert jones(again) is first  # looked up, not equal by a second computation


# --- what is refused


@pytest.mark.parametrize(
    ("pd", "message"),
    [
        ([(1, 2, 3)], "has 3 edges, expected 4"),
        ([(1, 5, 2, 4), (3, 1, 4, 6), (5, 3, 6, 7)], "is at 1 places, expected 2"),
        ([(1, 5, 2, 4), (3, 1, 4, 6), (6, 2, 5, 3)], "entered from both ends"),
        ([(1, 2, 1, 2)], "cannot be drawn in the plane"),
    ],
)
def test_codes_that_are_none(pd: PD, message: str) -> None:
    with pytest.raises(TorsadeError, match=message):
        oriented(pd)


def test_a_negative_number_of_circles() -> None:
    with pytest.raises(TorsadeError, match="circles is -1"):
        jones(TREFOIL, -1)
