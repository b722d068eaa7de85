"""Centerlines: the value, and the check before a run."""

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

FloatArray = NDArray[np.float64]

H = 2e-4
"""Radius of the reference fibers [m]."""

SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[2] / "shared"))
BENDS = SHARED / "data" / "bends"
needs_bends = pytest.mark.skipif(not BENDS.is_dir(), reason="the reference bends are not here")


def line(n: int = 40, spacing: float = H, start: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> FloatArray:
    return np.array(start) + np.outer(np.arange(n) * spacing, [1.0, 0.0, 0.0])


def ring(n: int = 40, radius: float = 20 * H) -> FloatArray:
    a = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)


def refusal(x: Any, *more: Any, closed: tuple[bool, ...] = (), radius: float = H) -> str:
    with pytest.raises(TorsadeError) as caught:
        check(Centerline((x, *more), closed), radius)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 320
    return message


# --- the value


def test_nodes_are_copied_and_read_only() -> None:
    x = line()
    c = Centerline((x,))
    x[0] = 1.0
    assert c.strands[0][0, 0] == 0.0
    assert c.closed == (False,)
    with pytest.raises(ValueError, match="read-only"):
        c.strands[0][0] = 1.0


@pytest.mark.parametrize(
    ("strands", "closed", "says"),
    [
        ((), (), "no strand"),
        ((np.zeros((4, 2)),), (), r"strand 0 has nodes of shape \(4, 2\)"),
        ((line(), np.zeros(3)), (), r"strand 1 has nodes of shape \(3,\)"),
        ((line(),), (True, False), "1 strands have 2 closed flags"),
    ],
)
def test_malformed_values_are_refused(strands: Any, closed: tuple[bool, ...], says: str) -> None:
    with pytest.raises(TorsadeError, match=says):
        Centerline(strands, closed)


# --- the check before a run


def test_sound_centerlines_pass() -> None:
    side_by_side = Centerline((line(), line(start=(0.0, 2 * H, 0.0))))
    coarse = Centerline((line(41, 2 * H),))  # edges as long as the diameter
    for sound in (Centerline((line(),)), Centerline((ring(100),), (True,)), side_by_side, coarse):
        assert check(sound, H) is None


@pytest.mark.parametrize("radius", [0.0, -H, np.nan, np.inf])
def test_impossible_radius_is_refused(radius: float) -> None:
    assert "radius is" in refusal(line(), radius=radius)


def test_nodes_that_are_not_finite_are_refused() -> None:
    x = line()
    x[7, 1] = np.nan
    assert "node 7 of strand 1 is (0.0014, nan, 0) m; give finite coordinates" in refusal(
        line(start=(0, 1, 0)), x
    )


def test_too_few_nodes_are_refused() -> None:
    assert "strand 0 has only one node; give at least 2" in refusal(line(1))
    assert "strand 0 has 0 nodes" in refusal(np.zeros((0, 3)))
    assert "strand 0 has 2 nodes; give at least 3" in refusal(line(2), closed=(True,))


@pytest.mark.parametrize("gap", [0.0, 1e-12 * H])
def test_repeated_nodes_are_refused(gap: float) -> None:
    x = line()
    x[8] = x[7] + gap
    assert "nodes 7 and 8 of strand 0 are the same point, (0.0014, 0, 0) m; remove one" in refusal(x)


def test_repeated_first_node_of_a_closed_fiber_is_refused() -> None:
    x = ring(100)
    message = refusal(np.concatenate([x, x[:1]]), closed=(True,))
    assert "nodes 100 and 0 of strand 0 are the same point" in message


@pytest.mark.parametrize("size", [1e3, 1e300])
def test_long_edges_are_refused(size: float) -> None:
    message = refusal(line() * size)
    assert "more than the fiber's diameter 0.4 mm" in message
    assert "resample it, or give the unit that x, y, z have" in message
    x = line()
    x[20:] += [1.5 * H, 0, 0]
    assert "edge 19 of strand 0 is 0.5 mm long" in refusal(x)


def test_short_fiber_is_refused() -> None:
    assert "strand 0 is 1.8 mm long; give at least 5 diameters, 2 mm" in refusal(line(10))
    check(Centerline((line(12),)), H)


def test_a_fold_is_refused() -> None:
    x = line()
    x[20:] = x[20] + np.outer(np.arange(20), [-H, H / 4, 0])
    message = refusal(x)
    assert "strand 0 turns by 166 degrees at node 20" in message
    assert "smooth or resample" in message


def test_crossing_strands_are_refused() -> None:
    other = line()[:, [1, 0, 2]] + [20 * H, -20 * H, 0]
    message = refusal(line(), other)
    assert "strands 0 and 1 interpenetrate: the axes are 0 mm apart" in message
    assert "a fiber 0.4 mm thick needs at least 0.1333 mm" in message


@pytest.mark.parametrize(("apart", "passes"), [(0.30, False), (0.36, True)])
def test_parallel_strands_may_overlap_only_so_far(apart: float, passes: bool) -> None:
    """The limit is a third of the diameter."""
    other = line(start=(0.0, 0.0, apart * 2 * H))
    if passes:
        check(Centerline((line(), other)), H)
    else:
        assert "interpenetrate" in refusal(line(), other)


def test_a_fiber_that_passes_through_itself_is_refused() -> None:
    """A figure of eight in the plane, and the same lifted apart."""
    a = 2 * np.pi * np.arange(200) / 200
    flat = 20 * H * np.stack([np.sin(a), np.sin(2 * a) / 2, 0 * a], axis=1)
    assert "strand 0 passes through itself: the axes are 0 mm apart" in refusal(flat, closed=(True,))
    flat[:, 2] = H * np.cos(a)
    check(Centerline((flat,), (True,)), H)


# --- the reference bends

CLEARANCES = {
    "alpine24": 0.518,
    "carrick14": 0.807,
    "granny": 0.631,
    "grief": 0.683,
    "reef": 0.651,
    "thief": 0.639,
    "trefoil": 0.929,
    "zeppelin14": 0.746,
}
"""Measured on the published centerlines [2h], with the exclusion pi h of `check`."""


@needs_bends
@pytest.mark.parametrize("name", sorted(CLEARANCES))
def test_reference_bends_are_accepted(name: str) -> None:
    """They overlap by up to half a diameter, which is what sets the limit of `check`."""
    c = read_csv(BENDS / f"{name}.csv")
    check(c, H)
    near = curve.clearance(c.strands, c.closed, np.pi * H)
    assert near.distance / (2 * H) == pytest.approx(CLEARANCES[name], abs=5e-4)


@needs_bends
def test_a_reference_bend_pushed_into_itself_is_refused() -> None:
    c = read_csv(BENDS / "reef.csv")
    moved = Centerline((c.strands[0], c.strands[1] + [0.75e-3, 0, 0]))
    with pytest.raises(TorsadeError, match="strands 0 and 1 interpenetrate"):
        check(moved, H)
    with pytest.raises(TorsadeError, match="the axes are"):
        check(c, 2.5 * H)
