"""What measures of curves refuse, and what they do not: edges that touch, curves that are none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from topology.curves import hopf_link, random_directions, ring, rotation
from torsade.errors import TorsadeError
from torsade.topology.measures import average_crossing_number, linking, writhe, writhe_density


def refused(x: Any, closed: Any = True, measure: Callable[..., Any] = writhe) -> str:
    with pytest.raises(TorsadeError) as caught:
        measure(x, closed)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 200
    return message


TOUCHING = {
    "across": [[-1, 0, 0], [1, 0, 0], [0, 1, 1], [0, 1, 0], [0, -1, 0]],
    "across, off the middle": [[-1, 0, 0], [1, 0, 0], [0, 1, 1], [0.3, 1, 0], [0.3, -0.1, 0]],
    "node on edge": [[-1, 0, 0], [1, 0, 0], [0, 1, 1], [0.2, 0, 0], [0.2, 0, 2]],
    "end on edge": [[-1, 0, 0], [1, 0, 0], [0, 1, 1], [0, 1, 0.3], [0, 0, 0]],
    "node on node": [[-1, 0, 0], [1, 0, 0], [0, 1, 1], [1, 0, 0], [0, -1, -1]],
    "along each other": [[0, 0, 0], [4, 0, 0], [5, 1, 1], [3, 0, 0], [1, 0, 0]],
    "nearly": [[-1, 0, 0], [1, 0, 0], [0, 1, 1], [0, 1, 1e-10], [0, -1, 1e-10]],
}


@pytest.mark.parametrize("name", TOUCHING)
def test_touching_edges_are_refused(name: str) -> None:
    x = np.array(TOUCHING[name], dtype=float) @ rotation(5).T + 0.7
    assert "touch, so that the sign of their crossing is lost; move them apart" in refused(x, False)
    assert "touch" in refused(x, False, average_crossing_number)
    assert "touch" in refused(x, False, writhe_density)


@settings(max_examples=200, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    places=st.tuples(*[st.sampled_from([0.0, 1.0, 0.5, 1e-4, 0.3])] * 2),
    gap=st.sampled_from([0.0, 1e-15, 1e-12, 9e-10]),
    sizes=st.tuples(*[st.floats(-2, 2)] * 2),
    parallel=st.booleans(),
)
def test_no_touching_edges_are_missed(
    seed: int, places: tuple[float, float], gap: float, sizes: tuple[float, float], parallel: bool
) -> None:
    """Edges of any lengths, across or along each other, that meet anywhere or nearly do."""
    e, f, off = random_directions(seed, 3)
    e, f = e * 10 ** sizes[0], (e if parallel else f) * 10 ** sizes[1]
    p = -places[0] * e
    q = -places[1] * f + gap * (10 ** sizes[0] + 10 ** sizes[1]) * off
    assert "curve 0 and edge 0 of curve 1 touch" in refused([[p, p + e], [q, q + f]], False, linking)


def test_touching_curves_are_refused_where_it_matters() -> None:
    """Linking asks for curves apart; a curve that touches itself can be linked all the same."""
    x, y = hopf_link(8)
    assert refused([x, y - y[4] + x[0]], True, linking).startswith(
        "edge 0 of curve 0 and edge 3 of curve 1 touch"
    )
    crossed = np.array(TOUCHING["across"], dtype=float)
    beside = crossed + np.array([1e-3, 5e-4, 1e-3])
    assert abs(linking([crossed, beside], False)[0, 1]) > 0.1


def test_strands_that_nearly_touch_are_measured() -> None:
    """Two long edges side by side at 1e-5 of their length, and a near miss across, are not refused."""
    beside = [[[0, 0, 0], [1, 0, 0]], [[0, 0, 1e-5], [1, 1e-5, 1e-5]]]
    assert 0 < abs(linking(beside, False)[0, 1]) < 0.5
    gap = 1e-7
    near = [[[-1, 0, gap], [1, 0, gap]], [[0, -1, 0], [0, 1, 0]]]
    assert linking(near, False)[0, 1] == pytest.approx(0.5, abs=1e-6)


def test_curves_that_are_none_are_refused() -> None:
    nan = ring(5)
    nan[3, 1] = np.nan
    assert refused(nan).startswith("node 3 of curve 0 is [")
    assert "give finite coordinates" in refused([ring(), nan])
    assert "curve 1" in refused([ring(), nan])
    assert "curve 0 has 2 nodes; give at least 3" in refused([[0, 0, 0], [1, 0, 0]])
    assert "curve 0 has 1 nodes; give at least 2" in refused([[0, 0, 0]], False)
    assert "give (n, 3)" in refused(np.zeros((4, 2)))
    assert "there is no curve" in refused([])
    assert "there is no curve" in refused(3.0)
    assert "not an array of numbers" in refused([[[0, 0, 0], [1, 0]]])
    assert "1 curves have 2 closed flags" in refused([ring()], [True, False])
    again = np.concatenate([ring(), ring()[:1]])
    assert refused(again) == (
        "nodes 40 and 0 of curve 0 are the same point; remove one; "
        "a closed curve joins its last node to the first by itself"
    )
    with pytest.raises(TorsadeError, match="0 threads cannot work"):
        writhe(ring(), True, threads=0)
