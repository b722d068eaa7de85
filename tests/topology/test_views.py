"""What is seen from one direction: crossings, turning numbers, total curvature."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from topology.curves import around, hopf_link, random_directions, random_polygon, ring, torus_knot
from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.topology.views import (
    directional_crossing_number,
    directional_writhe,
    total_curvature,
    turning_number,
)

ABOVE = (0.0, 0.0, 1.0)
ASIDE = (0.02, 0.03, 1.0)


def figure_eight(n: int = 50) -> Floats:
    """A plane curve of one crossing, which turns as much one way as the other."""
    t = around(n) + 0.1
    return np.stack([np.sin(t), np.sin(2 * t), 0 * t], axis=1)


def test_one_crossing() -> None:
    """The upper strand runs along x, the lower one along y: right-handed, from above and from below."""
    over, under = [[-1, 0, 1], [2, 0, 1]], [[0, -1, 0], [0, 2, 0]]
    for direction in (ABOVE, np.negative(ABOVE)):
        assert directional_writhe([over, under], False, direction) == 1
        assert directional_writhe([over[::-1], under], False, direction) == -1
        assert directional_crossing_number([over[::-1], under], False, direction) == 1
    assert directional_writhe([over, under], False, (0.0, 1.0, 0.3)) == 0


def test_diagrams_of_torus_knots_and_links() -> None:
    """From above T(2, q) has its q crossings, all left-handed; a Hopf link has two, each counted."""
    for q in (3, 5, 7):
        x = torus_knot(2, q, 40 * q)
        assert directional_writhe(x, True, ASIDE) == -q
        assert directional_crossing_number(x, True, ASIDE) == q
    assert directional_writhe(hopf_link(), True, (0.1, 0.7, 0.9)) == -2


@pytest.mark.parametrize("times", [1, 2, 3])
def test_turning_number_of_a_curve_that_goes_round_often(times: int) -> None:
    t = around(90)
    r = 2 + np.cos(t)
    x = np.stack([r * np.cos(times * t), r * np.sin(times * t), np.sin(t)], axis=1)
    assert turning_number(x, True) == pytest.approx(times, abs=1e-13)
    assert turning_number(x[::-1], True) == pytest.approx(-times, abs=1e-13)
    assert turning_number(x, True, np.negative(ABOVE)) == pytest.approx(-times, abs=1e-13)


def test_turning_number_of_an_eight_and_of_arcs() -> None:
    """A figure eight has none; half a ring of 41 corners turns 39 of its 40 equal parts of half a turn."""
    assert turning_number(figure_eight(), True) == pytest.approx(0, abs=1e-13)
    t = np.linspace(0, np.pi, 41)
    arc = np.stack([np.cos(t), np.sin(t), t], axis=1)
    assert turning_number(arc, False) == pytest.approx(39 / 40 / 2, abs=1e-13)
    assert turning_number(arc[:2], False) == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_turning_numbers_are_whole_and_odd_with_an_even_number_of_crossings(seed: int) -> None:
    """Whitney 1937: crossings and turning number of a closed plane curve differ by an odd number."""
    x = random_polygon(seed, 9)
    for direction in random_directions(seed, 20):
        turns = turning_number(x, True, direction)
        assert turns == pytest.approx(round(turns), abs=1e-12)
        assert (round(turns) + directional_crossing_number(x, True, direction)) % 2 == 1


def test_total_curvature_is_the_mean_over_projections() -> None:
    """A ring has 2 pi (Fenchel); any polygon as much as its projections have in the mean (Fáry 1949)."""
    assert total_curvature(ring(), True) == pytest.approx(2 * np.pi)
    assert total_curvature(ring(), True, ASIDE) == pytest.approx(2 * np.pi)
    assert total_curvature(figure_eight(), True, ABOVE) > 2 * np.pi
    x = random_polygon(3, 10)
    for closed in (True, False):
        seen = np.array([total_curvature(x, closed, v) for v in random_directions(7, 2000)])
        error = seen.std(ddof=1) / np.sqrt(len(seen))
        assert abs(seen.mean() - total_curvature(x, closed)) < 3 * error
    assert total_curvature(torus_knot(2, 3, 400), True) > 4 * np.pi  # Fáry and Milnor, of a knot


def refused(call: Any, *arguments: Any) -> str:
    with pytest.raises(TorsadeError) as caught:
        call(*arguments)
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_views_in_which_nothing_can_be_told_are_refused() -> None:
    through = [[-1, 0, 1], [1, 0, 1], [1, 1, 0.4], [0, 1, 0], [0, 0, 0]]
    assert "seen along [0. 0. 1.], edge 0 of curve 0 and edge 3 of curve 0 touch" in refused(
        directional_writhe, through, False, ABOVE
    )
    flat = [[-1, 0, 0], [1, 0, 0], [1, 1, 0.4], [0, 1, 0], [0, -1, 0]]
    assert "edge 3 of curve 0 meet in space" in refused(directional_writhe, flat, False, ABOVE)
    assert "edge 1 is seen as a point" in refused(
        turning_number, [[0, 0, 0], [1, 0, 0], [1, 0, 1], [2, 2, 2]], False
    )
    folded = [[0, 0, 0], [1, 0, 0], [0.5, 0, 1], [0, 1, 0]]
    assert "fold straight back at node 1 along" in refused(turning_number, folded, False)
    assert "fold straight back at node 1 along" in refused(turning_number, folded, True)
    for none in ((0, 0, 0), (np.nan, 0, 1), (1, 0)):
        assert "is no direction" in refused(directional_writhe, ring(), True, none)
