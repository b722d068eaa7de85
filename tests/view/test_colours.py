"""Strain colours are the measured ones; strand colours can be told apart."""

from __future__ import annotations

import sys
from itertools import combinations

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.view.colours import (
    PRIMARIES,
    STRAND_COLOURS,
    chromaticity,
    strain_colormap,
    strain_colour,
    strand_colour,
)


@pytest.mark.parametrize(
    ("strain", "rgb"),
    [
        (0.0, (255, 0, 65)),
        (0.20, (255, 23, 0)),
        (0.50, (0, 245, 0)),
        (0.70, (0, 172, 206)),
        (0.525, (0, 248, 42)),
        (0.375, (213.5, 190.5, 0)),
        (-0.1, (255, 0, 65)),
        (2.0, (0, 172, 206)),
    ],
)
def test_measured_colours_linear_between_and_held_outside(strain, rgb):
    """The thesis's calibration of photonic fibers, in steps of 0.05 (its appendix on knot experiments)."""
    assert 255 * strain_colour(strain) == pytest.approx(rgb)


def test_any_shape_of_strains():
    strains = np.linspace(0, 0.7, 24).reshape(2, 3, 4)
    colours = strain_colour(strains)
    assert colours.shape == (2, 3, 4, 3)
    assert colours[1, 2, 3] == pytest.approx(strain_colour(strains[1, 2, 3]))


def test_the_colormap_is_the_same_map():
    pytest.importorskip("matplotlib")
    strains = np.linspace(0.0, 0.7, 200)
    assert strain_colormap()(strains / 0.7)[:, :3] == pytest.approx(strain_colour(strains), abs=0.006)


def test_chromaticities_of_primaries_and_white_are_those_of_the_standard():
    """IEC 61966-2-1: primaries as listed, white D65 at (0.3127, 0.3290)."""
    assert chromaticity(np.eye(3)) == pytest.approx(np.array(PRIMARIES), abs=3e-4)
    assert chromaticity([[1, 1, 1], [0.2, 0.2, 0.2]]) == pytest.approx(
        np.array([[0.3127, 0.3290]] * 2), abs=2e-4
    )


def test_chromaticity_of_a_mixture_lies_between_its_parts_on_a_line():
    """Light adds linearly: 0.735357 of full scale is half the light."""
    red, green, mixed = (
        chromaticity(c) for c in ((0.735357, 0, 0), (0, 0.735357, 0), (0.735357, 0.735357, 0))
    )
    share = (mixed - red) / (green - red)
    assert share[0] == pytest.approx(share[1])
    assert 0 < share[0] < 1
    assert chromaticity((1, 1, 0)) == pytest.approx(mixed)


BLINDNESS = {
    "none": np.eye(3),
    "protanopia": [[0.1523, 1.0526, -0.2049], [0.1145, 0.7863, 0.0992], [-0.0039, -0.0481, 1.0520]],
    "deuteranopia": [[0.3673, 0.8606, -0.2280], [0.2801, 0.6725, 0.0474], [-0.0118, 0.0429, 0.9689]],
    "tritanopia": [[1.2555, -0.0767, -0.1788], [-0.0784, 0.9309, 0.1476], [0.0047, 0.6914, 0.3039]],
}


def lab(linear):
    """CIE L*a*b* of linear sRGB."""
    matrix = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(np.array(matrix) @ np.clip(linear, 0, 1) / [0.9505, 1.0, 1.089])
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("kind", BLINDNESS)
def test_strand_colours_can_be_told_apart_also_by_the_colour_blind(kind):
    """Distances in CIE Lab (2 is just noticeable), dichromacy after Machado et al. (2009)."""
    seen = [lab(BLINDNESS[kind] @ strand_colour(s) ** 2.2) for s in range(len(STRAND_COLOURS))]
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 15.0


def test_neighbouring_strand_colours_differ_in_lightness_so_that_they_print_in_grey():
    light = [lab(strand_colour(s) ** 2.2)[0] for s in range(len(STRAND_COLOURS))]
    assert np.abs(np.diff(light)).min() > 12.0
    assert strand_colour(len(STRAND_COLOURS)) == pytest.approx(strand_colour(0))


def test_a_missing_library_is_named_with_the_way_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(TorsadeError, match=r'pip install "torsade\[view\]"'):
        strain_colormap()
