"""Curves laid on each other: found again after rotation, shift and reversal, not taken for mirror images."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from torsade.errors import TorsadeError
from torsade.knots.likeness import likeness
from torsade.knots.loops import tight_loop


@pytest.mark.parametrize(("first", "step"), [(0, 1), (13, 1), (13, -1)])
def test_a_curve_is_found_again(first: int, step: int) -> None:
    x = tight_loop("5_2").fiber(50.0, 60)
    turned = Rotation.from_rotvec([0.3, -1.1, 0.7]).apply(x) + 5.0
    moved = np.empty_like(x)
    moved[(first + step * np.arange(60)) % 60] = turned
    found = likeness(x, moved)
    assert found.distance < 1e-6
    assert (found.first, found.step) == (first, step)
    assert found.node(7, 60) == (first + 7 * step) % 60


def test_a_chiral_knot_is_not_its_mirror_image_and_the_figure_eight_nearly_is() -> None:
    """Tight shapes, in radii."""
    mirror = np.array([1.0, 1.0, -1.0])
    trefoil, eight = (tight_loop(knot).fiber(50.0, 100) for knot in ("3_1", "4_1"))
    assert likeness(trefoil * mirror, trefoil).distance > 0.5
    assert likeness(eight * mirror, eight).distance < 0.1


def test_as_many_nodes_are_wanted() -> None:
    x = tight_loop("3_1").fiber(50.0, 30)
    with pytest.raises(TorsadeError, match=r"curves of 30 and 20 nodes are compared; give as many nodes"):
        likeness(x, x[:20])
