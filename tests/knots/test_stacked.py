"""Reef, thief, granny and grief, held against the catalogue's diagrams by a projection of their own."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from knots.diagram import crossings, gauss_code
from torsade.errors import TorsadeError
from torsade.knots.stacked import BENDS, PULLS, BuiltBend, bend

H = 0.2e-3

# Gauss codes (strand A | strand B, each from end 0 to end 1) of the reef ("two interlocked bights") and the
# granny ("alternating", all crossings positive), the two tangles that A1 and B1 are the standing ends of.
GAUSS = {
    "reef": "O1+ U2+ O3+ O4- U5- O6- | U3+ O2+ U1+ U6- O5- U4-",
    "granny": "O1+ U2+ O3+ U4+ O5+ U6+ | U3+ O2+ U1+ O6+ U5+ O4+",
}
TANGLE = {"reef": "reef", "thief": "reef", "granny": "granny", "grief": "granny"}
CASES = [(name, pulled) for name in BENDS for pulled in PULLS]


def ends(built: BuiltBend) -> dict[str, NDArray[np.float64]]:
    return {f"{s}{k}": x[-k] for s, x in zip("AB", built.strands, strict=True) for k in (0, 1)}


def lengths(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.norm(np.diff(x, axis=0), axis=1))


def leaving(x: NDArray[np.float64], end: int) -> NDArray[np.float64]:
    """Unit direction in which the strand runs out at its end 0 or 1."""
    d = x[-1] - x[-2] if end else x[0] - x[1]
    return np.asarray(d / np.linalg.norm(d))


def gap(strands: tuple[NDArray[np.float64], ...], h: float) -> float:
    """Smallest distance between nodes of different strands or more than pi h apart along one."""
    smallest = float(cdist(strands[0], strands[1]).min())
    for x in strands:
        s = np.concatenate([[0], np.cumsum(lengths(x))])
        apart = np.abs(s[:, None] - s) > math.pi * h
        smallest = min(smallest, float(cdist(x, x)[apart].min()))
    return smallest


def h_kappa(x: NDArray[np.float64], h: float) -> float:
    """Greatest h kappa, from the circle through three successive nodes."""
    a, b = x[1:-1] - x[:-2], x[2:] - x[1:-1]
    area = np.linalg.norm(np.cross(a, b), axis=1)
    sides = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1) * np.linalg.norm(a + b, axis=1)
    return float((2 * h * area / sides).max())


def test_projection_reads_a_clasp() -> None:
    """The oracle itself, on two hooks whose code is seen at a glance.

    A runs along +x at y = 0 over the side x = 0 of B, which runs along -y, turns and comes back
    along -x at y = -1 under it. B crosses A's path from left to right: O1 is negative.
    """
    a = np.array([(-2, 0, 1), (1, 0, 1), (1, -1, -1), (-2, -1, -1)], dtype=float)
    b = np.array([(2.1, 0.5, 0), (0.1, 0.5, 0), (0.1, -2, 0), (2.1, -2, 0)], dtype=float)
    assert gauss_code((a, b)) == "O1- U2- | U1- O2-"
    assert gauss_code((a * (1, 1, -1), b)) == "U1+ O2+ | O1+ U2+"
    assert gauss_code((a, b[::-1])) == "O1+ U2+ | O2+ U1+"


@pytest.mark.parametrize(("name", "pulled"), CASES)
def test_diagram_is_the_catalogues(name: str, pulled: str) -> None:
    """Whichever ends are pulled, the tangle is the reef or the granny, with all its signs."""
    assert gauss_code(bend(name, pulled=pulled).strands) == GAUSS[TANGLE[name]]


@pytest.mark.parametrize("spacing", [0.1, 0.37, 1.0])
@pytest.mark.parametrize("name", BENDS)
def test_diagram_holds_at_every_resolution(name: str, spacing: float) -> None:
    assert gauss_code(bend(name, spacing=spacing * H).strands) == GAUSS[TANGLE[name]]


@pytest.mark.parametrize(("name", "writhe"), [("reef", 0), ("granny", 6)])
def test_two_throws_of_opposite_or_same_hand(name: str, writhe: int) -> None:
    strands = bend(name).strands
    found = crossings(strands)
    assert len(found) == 6
    assert sum(sign for *_, sign in found) == writhe
    for throw in (-1, 1):  # at y < 0 and at y > 0
        hands = [s for place, _, s in found if np.sign(_y(strands, place)) == throw]
        assert hands in ([1, 1, 1], [-1, -1, -1])


def _y(strands: tuple[NDArray[np.float64], ...], place: float) -> float:
    return float(np.concatenate([s[:-1] for s in strands])[int(place), 1])


@pytest.mark.parametrize(("name", "pulled"), CASES)
def test_ends_leave_in_the_catalogues_order(name: str, pulled: str) -> None:
    """Anticlockwise B0, B1, A1, A0; with the code this fixes the tangle in the plane."""
    angle = {k: math.atan2(x[1], x[0]) for k, x in ends(bend(name, pulled=pulled)).items()}
    start = angle["B0"] - 1e-9
    assert sorted(angle, key=lambda k: (angle[k] - start) % math.tau) == ["B0", "B1", "A1", "A0"]


@pytest.mark.parametrize(("name", "pulled"), CASES)
def test_strands_are_unknotted_and_do_not_cross_themselves(name: str, pulled: str) -> None:
    a, b = bend(name, pulled=pulled).strands
    first_of_b = len(a) - 1
    assert all((o < first_of_b) != (u < first_of_b) for o, u, _ in crossings((a, b)))


@pytest.mark.parametrize(("thief", "reef"), [("thief", "reef"), ("grief", "granny")])
def test_thief_and_grief_are_other_pulls_of_the_same_tangle(thief: str, reef: str) -> None:
    """The knot itself is the same curve: the strands differ only beyond its legs."""
    assert bend(thief).pulled == "A1B0"
    assert bend(reef).pulled == "A1B1"
    assert gauss_code(bend(thief).strands) == gauss_code(bend(reef).strands)
    for other, own in zip(bend(reef, pulled="A1B0").strands, bend(thief).strands, strict=True):
        np.testing.assert_array_equal(own, other)
    np.testing.assert_array_equal(bend(thief).strands[0], bend(reef).strands[0])  # A1 is pulled in both
    own, other = (bend(n, spacing=0.05 * H).strands[1] for n in (thief, reef))
    knot = own[np.abs(own[:, 0]) < 2 * H]
    assert cdist(knot, other).min(axis=1).max() < 0.05 * H


@pytest.mark.parametrize(("name", "pulled"), CASES)
def test_clear_smooth_and_even(name: str, pulled: str) -> None:
    fine = bend(name, spacing=0.1 * H, pulled=pulled).strands
    assert 2 * 1.02 * H < gap(fine, H) < 2.2 * H
    assert max(h_kappa(x, H) for x in fine) < 0.5
    for x in bend(name, pulled=pulled).strands:
        l = lengths(x)
        assert 0.49 * H < l.mean() <= 0.5 * H
        assert np.ptp(l) < 0.005 * l.mean()
        assert h_kappa(x, H) < 0.5


@pytest.mark.parametrize("name", BENDS)
def test_coarsest_spacing_does_not_touch_either(name: str) -> None:
    strands = bend(name, spacing=H).strands
    assert gap(strands, H) > 2 * 1.02 * H
    assert max(h_kappa(x, H) for x in strands) < 0.5


@pytest.mark.parametrize(("name", "pulled"), CASES)
def test_pulled_along_one_line(name: str, pulled: str) -> None:
    built = bend(name, pulled=pulled)
    assert (built.name, built.pulled) == (name, pulled)
    at = ends(built)
    clamped, drawn = pulled[:2], pulled[2:]
    np.testing.assert_allclose([at[clamped][1:], at[drawn][1:]], 0, atol=1e-12 * H)
    assert at[clamped][0] < -15 * H
    assert at[drawn][0] > 15 * H
    a, b = built.strands
    np.testing.assert_allclose(leaving(a, int(pulled[1])), (-1, 0, 0), atol=1e-9)
    np.testing.assert_allclose(leaving(b, int(pulled[3])), (1, 0, 0), atol=1e-9)


@pytest.mark.parametrize(("name", "pulled"), CASES)
def test_tails_point_away(name: str, pulled: str) -> None:
    built = bend(name, pulled=pulled)
    at = ends(built)
    for x, letter, end in zip(built.strands, "AB", (1 - int(pulled[1]), 1 - int(pulled[3])), strict=True):
        tip = at.pop(f"{letter}{end}")
        assert leaving(x, end) @ tip > 0.8 * np.linalg.norm(tip)
        assert min(np.linalg.norm(tip - other) for other in at.values()) > 20 * H


@pytest.mark.parametrize("name", BENDS)
def test_snug_and_long_enough(name: str) -> None:
    """As far from end to end as the published ones (7.6-9.8 mm); tails for a second's pull at 15 N."""
    built = bend(name)
    for x in built.strands:
        assert 14e-3 < lengths(x).sum() < 20e-3
    at = ends(built)
    assert 7e-3 < at[built.pulled[2:]][0] - at[built.pulled[:2]][0] < 10.5e-3


@pytest.mark.parametrize("lead", [14.0, 30.0])
@pytest.mark.parametrize("name", BENDS)
def test_lead_is_what_it_says(name: str, lead: float) -> None:
    """A strand is a lead, a tail of two and a half times its length, and the same knot whatever the lead."""
    knot = [lengths(x).sum() / H - 3.5 * lead for x in bend(name, lead=lead * H, spacing=0.1 * H).strands]
    assert knot[0] == pytest.approx(knot[1], abs=1e-9)
    assert 15 < knot[0] < 24


@pytest.mark.parametrize("name", BENDS)
def test_strands_are_alike(name: str) -> None:
    """The tangle's own symmetry: half a turn about y makes A into B, if the same ends are pulled."""
    pulled = "A1B1"
    a, b = bend(name, pulled=pulled).strands
    np.testing.assert_allclose(a * (-1, 1, -1), b, atol=1e-12 * H)


@pytest.mark.parametrize("name", BENDS)
def test_same_input_same_bits(name: str) -> None:
    for first, second in zip(bend(name).strands, bend(name).strands, strict=True):
        np.testing.assert_array_equal(first, second)
        assert first.dtype == np.float64


@pytest.mark.parametrize("name", BENDS)
def test_scales_with_the_radius(name: str) -> None:
    for small, large in zip(bend(name, radius=1e-6).strands, bend(name, radius=0.5).strands, strict=True):
        np.testing.assert_allclose(small / 1e-6, large / 0.5, rtol=0, atol=1e-12)


@pytest.mark.parametrize("radius", [1e-6, 0.7e-3, 3e-3, 0.1])
def test_bounds_themselves_are_accepted(radius: float) -> None:
    for lead, spacing in ((14 * radius, radius), (16 * radius, 0.05 * radius)):
        assert len(bend("reef", radius, lead, spacing).strands[0]) > 50


def test_names() -> None:
    assert BENDS == ("reef", "thief", "granny", "grief")
    assert bend(" Reef ").name == "reef"
    assert bend("reef", pulled="a0b1").pulled == "A0B1"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "reff"}, "'reff'; did you mean 'reef'. choose one of reef, thief, granny, grief"),
        ({"name": "grannie"}, "did you mean 'granny'"),
        ({"name": ""}, "no bend is called ''"),
        ({"name": "reef", "pulled": "A0A1"}, "'A0A1' are unknown; choose one of A1B1, A1B0, A0B1, A0B0"),
        ({"name": "reef", "radius": 0.0}, "radius is 0 m; give a positive length"),
        ({"name": "reef", "radius": -1e-4}, "radius is -0.0001 m"),
        ({"name": "reef", "radius": math.nan}, "radius is nan m"),
        ({"name": "reef", "radius": math.inf}, "radius is inf m"),
        ({"name": "reef", "lead": 1e-3}, "lead is 0.001 m; give 0.0028 to 2 m, which is 14 to 10000 radii"),
        ({"name": "reef", "lead": math.nan}, "lead is nan m"),
        ({"name": "reef", "lead": math.inf}, "lead is inf m"),
        ({"name": "reef", "spacing": 0.0}, "spacing is 0 m; give 1e-05 to 0.0002 m"),
        ({"name": "reef", "spacing": 3e-4}, "spacing is 0.0003 m"),
    ],
)
def test_bad_input_is_said_in_one_sentence(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(TorsadeError, match=message) as caught:
        bend(**arguments)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
