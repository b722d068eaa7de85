"""Arrows on strands: drawn where the strand is in sight, along the vector as it is seen."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.view.arrows import Arrow, in_sight
from torsade.view.camera import View
from torsade.view.scene import picture

VIEW = View(*np.eye(3), np.zeros(3), 10.0, (640, 480))
"""From +z, x to the right."""


def across(z):
    """Two strands that cross at a right angle, the second at height z."""
    s = np.linspace(-30, 30, 121)[:, None]
    return [s * (1.0, 0, 0), s * (0, 1.0, 0) + np.array([0, 0, z])]


def test_the_lower_strand_is_out_of_sight_at_the_crossing_only():
    for z, seen in ((2.0, (False, True)), (-2.0, (True, False))):
        found = [in_sight(Arrow(k, 60, (1, 0, 0)), VIEW, across(z), 1.0) for k in (0, 1)]
        assert tuple(found) == seen
    assert in_sight(Arrow(0, 70, (1, 0, 0)), VIEW, across(2.0), 1.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_an_arrow_is_widest_near_its_tip(sign):
    """White on a coloured strand, its head on the side where the vector points."""
    strand = [np.linspace(-6, 6, 121)[:, None] * (1.0, 0, 0)]
    options = {"direction": (0, 0, 1), "size": (320, 240)}
    plain = picture(strand, False, 1.0, **options)
    drawn = picture(strand, False, 1.0, arrows=[Arrow(0, 60, (sign * 4.0, 0, 0))], **options)
    white = (np.abs(drawn - plain).max(axis=2) > 0.2) & (drawn.min(axis=2) > 0.9)
    columns = np.flatnonzero(white.sum(axis=0))
    widest = int(np.argmax(white.sum(axis=0)))
    assert len(columns) > 10
    assert (widest - columns.mean()) * sign > 0


def test_hidden_and_far_arrows_leave_no_trace():
    strands = across(2.0)
    options = {"direction": (0, 0, 1), "size": (320, 240)}
    plain = picture(strands, False, 1.0, **options)
    hidden = picture(
        strands, False, 1.0, arrows=[Arrow(0, 60, (3.0, 0, 0)), Arrow(0, 0, (3.0, 0, 0))], **options
    )
    np.testing.assert_array_equal(hidden, plain)


def test_values_take_the_colours_of_a_palette():
    """All red, lit or in shade."""
    strand = [np.linspace(-10, 10, 41)[:, None] * (1.0, 0, 0)]

    def red(values):
        return np.stack([1.0 + 0 * values, 0 * values, 0 * values], axis=-1)

    image = picture(strand, False, 1.0, values=[np.zeros(41)], palette=red, size=(320, 240))
    inked = image[image.min(axis=2) < 0.5]
    assert len(inked) > 1000
    assert np.all(inked[:, 0] >= inked[:, 1:].max(axis=1) - 1e-6)
