"""Measured centerlines: noise goes, the knot stays, or the smoothing is refused."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from torsade import curve
from torsade.centerline import Centerline, check
from torsade.errors import TorsadeError
from torsade.files import read_csv
from torsade.knots import bend, clean, strand
from torsade.topology import braid_curves, identify, identify_curves, identify_open, project
from torsade.topology.tangle import closures

FloatArray = NDArray[np.float64]

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[3] / "shared"))
REFERENCE = SHARED / "data" / "bends"
H = 2e-4


def noisy(x: FloatArray, amplitude: float, seed: int = 0) -> FloatArray:
    """Nodes displaced by normal noise, of this standard deviation along each axis."""
    return x + amplitude * np.random.default_rng(seed).normal(size=x.shape)


def ring(n: int, radius: float = 1.0, uneven: float = 0.0) -> FloatArray:
    a = 2 * np.pi * (np.arange(n) + uneven * np.random.default_rng(1).uniform(-0.5, 0.5, n)) / n
    return radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def tangle(c: Centerline) -> list[list[str]]:
    """What a bend becomes when its ends are joined, in both ways."""
    drawn = project(c.strands, c.closed).diagram
    return [list(identify(closed).names) for _, closed in closures(drawn)]


# --- smoothing


@pytest.mark.parametrize("n", [60, 200])
def test_a_ring_shrinks_as_it_should(n: int) -> None:
    """Of radius R it becomes r = R/(1 + (scale/r)^4), nodes even or not, in one plane or not."""
    for uneven in (0.0, 0.8):
        (x,) = clean(Centerline((ring(n, 1.0, uneven),), (True,)), 0.4, 0.05).strands
        r = np.linalg.norm(x, axis=1)
        np.testing.assert_allclose(r * (1 + (0.4 / r) ** 4), 1.0, atol=3e-3)


def test_noise_that_makes_edges_longer_is_smoothed_all_the_same() -> None:
    """Noise of 0.7 edge lengths makes the polyline half as long again; the scale stays a length in space."""
    x = noisy(ring(300), 0.7 * 2 * np.pi / 300)
    assert curve.length(x, True) > 1.5 * 2 * np.pi
    (y,) = clean(Centerline((x,), (True,)), 0.2, 0.05).strands
    assert curve.length(y, True) == pytest.approx(2 * np.pi, rel=0.01)
    assert np.abs(np.linalg.norm(y, axis=1) - 1).max() < 0.02


def test_a_straight_strand_stays_and_so_do_ends() -> None:
    x = np.outer(np.linspace(0, 1, 30), [1.0, 2.0, 3.0])
    (y,) = clean(Centerline((x,)), 0.1, 0.05).strands
    np.testing.assert_allclose(np.cross(y, [1.0, 2.0, 3.0]), 0, atol=1e-14)
    shaken = noisy(x, 0.01)
    (y,) = clean(Centerline((shaken,)), 0.1).strands
    np.testing.assert_array_equal(y[[0, -1]], shaken[[0, -1]])
    assert len(y) == len(clean(Centerline((x,)), 0.0).strands[0]) == 30


def test_nodes_are_spread_evenly_and_near_enough() -> None:
    (y,) = clean(Centerline((noisy(ring(200), 0.005),), (True,)), 0.1, 0.05).strands
    l = curve.edge_lengths(y, True)
    assert l.max() <= 0.05
    assert l.max() / l.min() < 1.01


def test_lengths_in_text() -> None:
    c = clean(Centerline((noisy(ring(200, 0.01), 1e-5),), (True,)), "1 mm", "0.5 mm")
    assert c.scale == 1e-3
    assert curve.edge_lengths(c.strands[0], True).max() <= 0.5e-3


def test_the_same_to_the_bit_every_time() -> None:
    x = Centerline((noisy(braid_curves([1, 1, 1])[0], 0.1),), (True,))
    first, second = (clean(x, 0.3, 0.2).strands[0] for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_far_from_the_origin() -> None:
    x = noisy(braid_curves([1, 1, 1])[0], 0.05)
    near, far = (clean(Centerline((x + s,), (True,)), 0.3, 0.2).strands[0] - s for s in (0.0, 1e5))
    np.testing.assert_allclose(near, far, atol=1e-6)


# --- the knot stays


CLOSED = {"3_1": [1, 1, 1], "m3_1": [-1, -1, -1], "4_1": [1, -2, 1, -2], "8_19": [1, 2] * 4}


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("share", [0.05, 0.15, 0.2])
def test_noise_below_the_clearance(name: str, share: float) -> None:
    """Strands are 1 apart: the knot is found, smooth, at the scale that is asked for."""
    (x,) = braid_curves(CLOSED[name])
    for seed in range(3):
        given = Centerline((noisy(x, share / np.sqrt(3), seed),), (True,))
        smooth = clean(given, 0.5, 0.25)
        assert smooth.scale == 0.5
        assert str(identify_curves(smooth.strands)) == name
        assert curve.curvature(smooth.strands[0], True).max() < 2.0
        assert curve.clearance(smooth.strands, (True,), 2.0).distance > 0.4


def test_noise_that_ties_knots_of_its_own() -> None:
    """Noise of 1.7 edges ties small trefoils here and there: refused where it does, and only there."""
    (x,) = braid_curves([1, 1, 1])
    said = {True: 0, False: 0}
    for seed in range(12):
        given = Centerline((noisy(x, 0.3 / np.sqrt(3), seed),), (True,))
        plain = str(identify_curves(given.strands)) == "3_1"
        said[plain] += 1
        if plain:
            assert str(identify_curves(clean(given, 0.5, 0.25).strands)) == "3_1"
            continue
        with pytest.raises(TorsadeError, match="where noise is larger than the distance of nodes, every few"):
            clean(given, 0.5, 0.25)
        assert str(identify_curves(clean(given, 0.5, 0.25, every=4).strands)) == "3_1"
    assert min(said.values()) >= 3


@pytest.mark.parametrize("name", CLOSED)
def test_noise_above_the_clearance(name: str) -> None:
    """The knot of the nodes as given stays, whatever it is, or it is said that it would not."""
    (x,) = braid_curves(CLOSED[name])
    refused = 0
    for seed in range(6):
        given = Centerline((noisy(x, 0.75, seed),), (True,))
        try:
            smooth = clean(given, 0.5, 0.25)
        except TorsadeError as error:
            refused += "may pull strands through each other" in str(error)
            continue
        assert identify_curves(smooth.strands).names == identify_curves(given.strands).names
    assert refused > 0


@pytest.mark.parametrize("scale", [1.0, 2.0, 4.0, 8.0])
def test_too_much_smoothing_is_done_by_less(scale: float) -> None:
    """A trefoil smoothed over more than its own size would shrink to a ring run twice, or worse."""
    given = Centerline(tuple(braid_curves([1, 1, 1])), (True,))
    used = 0.0
    try:
        smooth = clean(given, scale, 0.05)
        used = smooth.scale
        assert str(identify_curves(smooth.strands)) == "3_1"
    except TorsadeError as error:
        assert "may pull strands through each other" in str(error)  # noqa: PT017 - either will do
    assert used in (0.0, scale, scale / 2, scale / 4, scale / 8)
    assert used < 4.0


def test_a_link_stays_linked() -> None:
    for word, name in (([1, 1], "L2a1"), ([1, -2, 1, -2, 1], "L5a1")):
        strands = tuple(noisy(x, 0.15, k) for k, x in enumerate(braid_curves(word)))
        smooth = clean(Centerline(strands, (True,) * len(strands)), 0.5, 0.25)
        assert [identify_curves(c.strands).names for c in (smooth,)] == [
            identify_curves(braid_curves(word)).names
        ]
        assert name in str(identify_curves(smooth.strands))


@pytest.mark.parametrize("name", ["reef", "thief", "granny", "grief"])
def test_bends_with_noise(name: str) -> None:
    """Noise of a tenth of the diameter, that no fiber could follow, goes; the tangle is the same."""
    built = bend(name, H)
    given = Centerline(tuple(noisy(x, 0.2 * H, k) for k, x in enumerate(built.strands)))
    with pytest.raises(TorsadeError):
        check(given, H)
    smooth = clean(given, "0.2 mm", H / 2)
    check(smooth, H)
    assert smooth.scale == H
    assert tangle(smooth) == tangle(built)


def test_an_open_trefoil_with_noise() -> None:
    (x,) = strand("overhand", H).strands
    (y,) = clean(Centerline((noisy(x, 0.2 * H),)), H, H / 2).strands
    assert identify_open(y, 30).name == identify_open(x, 30).name == "3_1"


@pytest.mark.skipif(not REFERENCE.is_dir(), reason="the reference bends are not here")
@pytest.mark.parametrize("name", ["reef", "granny", "zeppelin14", "carrick14", "alpine24", "trefoil"])
@pytest.mark.parametrize("amplitude", [0.01e-3, 0.03e-3, 0.06e-3])
def test_reference_bends_with_noise(name: str, amplitude: float) -> None:
    """Published tight knots, 0.2 to 0.4 mm between axes, come back to within three times the noise."""
    given = read_csv(REFERENCE / f"{name}.csv")
    measured = Centerline(tuple(noisy(x, amplitude, k) for k, x in enumerate(given.strands)))
    smooth = clean(measured, "0.15 mm", "0.1 mm")
    assert smooth.scale == 1.5e-4
    check(smooth, H)
    for x, y in zip(given.strands, smooth.strands, strict=True):
        fine = curve.resample(x, n=5000)
        inner = y[5:-5]  # ends keep their noise
        off = np.linalg.norm(fine[None] - inner[:, None], axis=-1).min(axis=1)
        assert off.max() < 3 * amplitude + 0.02e-3
    if len(given.strands) == 2:
        assert tangle(smooth) == tangle(given)


# --- refusals


@pytest.mark.parametrize(
    ("strands", "closed", "more", "says"),
    [
        ((ring(20),), True, {"scale": -1.0}, "the smoothing length is -1 m; give a length of at least 0"),
        ((ring(20),), True, {"scale": np.nan}, "the smoothing length is nan m"),
        ((ring(20),), True, {"scale": "1 kg"}, "is a mass, not a length"),
        ((ring(20),), True, {"scale": 1e-9}, "more than 100000; give fewer, or a larger"),
        ((ring(20),), True, {"every": 0}, "every is 0; give a whole number from 1"),
        ((ring(20),), True, {"every": 10}, "strand 0 has 2 different nodes left; give at least 3"),
        ((ring(20),), True, {"spacing": 0.0}, "spacing of nodes cannot be 0"),
        ((ring(20),), True, {"spacing": 1e-6}, "more than 100000; give fewer, or a larger"),
        ((np.vstack([ring(20), [[np.nan, 0, 0]]]),), True, {}, "node 20 of strand 0 is not finite"),
        ((np.zeros((5, 3)),), False, {}, "strand 0 has 1 different nodes left; give at least 2"),
        ((ring(20), ring(20)), True, {}, "strands 0 and 1 meet at edges"),
        ((np.array([[-1.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, -1, 0]]),), False, {}, "strand 0 meets itself"),
    ],
)
def test_refusals(strands: tuple[FloatArray, ...], closed: bool, more: dict[str, Any], says: str) -> None:
    with pytest.raises(TorsadeError) as caught:
        clean(Centerline(strands, (closed,) * len(strands)), **({"scale": 0.1} | more))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_too_few_nodes_for_the_knot_are_refused() -> None:
    given = Centerline(tuple(braid_curves([1, 1, 1])), (True,))
    with pytest.raises(TorsadeError, match="with nodes so far apart strands would pass through each other"):
        clean(given, 0.2, 6.0)


@pytest.mark.parametrize(("n", "every", "left"), [(10, 3, 4), (11, 3, 5), (10, 1, 10), (10, 99, 2)])
def test_ends_are_among_every_few_nodes(n: int, every: int, left: int) -> None:
    x = np.stack([np.arange(n), np.arange(n) ** 2, np.zeros(n)], axis=1)
    (y,) = clean(Centerline((x,)), 0.0, every=every).strands
    assert len(y) == left
    np.testing.assert_array_equal(y[[0, -1]], x[[0, -1]])


def test_repeated_nodes_are_left_out() -> None:
    x = ring(50)
    again = np.concatenate([np.repeat(x, 2, axis=0), x[:1]])
    one, two = (clean(Centerline((nodes,), (True,)), 0.2, 0.1).strands[0] for nodes in (x, again))
    np.testing.assert_array_equal(one, two)
