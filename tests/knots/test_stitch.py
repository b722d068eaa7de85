"""Sutures tied around two cylinders: clear, smooth, symmetric, and the knot that was asked for."""

from __future__ import annotations

import numpy as np
import pytest

from torsade import curve
from torsade.errors import TorsadeError
from torsade.knots.stitch import stitch
from torsade.knots.sutures import suture_diagram
from torsade.topology.counting import state
from torsade.topology.projection import project

H, H_S, GAP = 1e-3, 12e-3, 4e-3

PAIRS = [(3, -3), (3, 3), (5, -3), (5, 3), (3, -5), (5, -5), (-3, 5), (7, -3), (1, 1), (1, -3), (15, -15)]


@pytest.mark.parametrize("throws", PAIRS)
def test_clear_smooth_and_as_fine_as_asked(throws):
    x, axes, _ = stitch(*throws, H, H_S, GAP)
    assert curve.clearance([x], [False], np.pi * H).distance > 2.1 * H
    assert curve.curvature(x).max() * H < 0.5
    assert curve.edge_lengths(x).max() <= 0.5 * H * (1 + 1e-9)
    assert axes[1, 0] - axes[0, 0] == pytest.approx(2 * H_S + GAP, rel=1e-12)
    apart = np.linalg.norm((x[:, None] - axes)[..., :2], axis=2)
    assert apart.min() > H_S + 1.1 * H


@pytest.mark.parametrize("throws", PAIRS)
def test_the_throws_are_those_of_the_diagram(throws):
    """Cut at the sides of the loop it is the tangle: crossings and writhe are those of (b, t)."""
    x, _, (first, last) = stitch(*throws, H, H_S, GAP)
    read = project([x[: first + 1][::-1], x[last:]], [False, False]).diagram
    assert (read.n_crossings, read.writhe) == (abs(throws[0]) + abs(throws[1]), sum(throws))
    assert read.writhe == suture_diagram(*throws).writhe


def test_tau_is_what_counting_says():
    from torsade.protocols.suture import SIX, tau_of, turns_of

    for throws in SIX:
        b, t = turns_of(throws)
        counted = state(suture_diagram(b, t))
        assert (counted.crossings, counted.writhe) == (abs(b) + abs(t), b + t)
        assert counted.tau == pytest.approx(tau_of(b, t), abs=1e-15)
    assert tau_of(5, -3) == 0.9375


def test_the_loop_lies_around_both_cylinders():
    """Closed far below, it winds once around either axis."""
    x, axes, _ = stitch(5, -3, H, H_S, GAP)
    far = np.array([[200 * H, x[-1, 1], 0.0], [0.0, 400 * H, 0.0], [-200 * H, x[0, 1], 0.0]])
    closed = np.concatenate([x, far])
    for axis in axes:
        z = (closed - axis) @ [1, 1j, 0]
        turns = np.angle(np.roll(z, -1) / z).sum() / (2 * np.pi)
        assert abs(turns) == pytest.approx(1.0)


def test_symmetric_to_the_bit():
    """Turned about y it is itself; the mirror image of a suture is the mirror image of its shape."""
    x = stitch(5, -3, H, H_S, GAP).strand
    assert np.array_equal(x, x[::-1] * (-1, 1, -1))
    assert np.array_equal(x * (1, 1, -1), stitch(-5, 3, H, H_S, GAP).strand)


def test_no_suture():
    with pytest.raises(TorsadeError, match="two odd numbers"):
        stitch(4, -3, H, H_S, GAP)
