"""Pieces over a grid of twist and limit curvature: rods of the critical curve, every worker, no shape."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.errors import TorsadeError
from torsade.fracture.criteria import limit_curvature
from torsade.fracture.phase import NO_SHAPE, Rods, phase_diagram
from torsade.fracture.rod import spaghetti
from torsade.material import Section, named_material
from torsade.protocols import SnapTwist

ROD = spaghetti()
RODS = Rods(named_material("spaghetti"), Section(ROD.h))


def curvature_of_strength(twist: float) -> float:
    return float(limit_curvature(twist / ROD.L, 1.9e7, ROD.E, ROD.mu, ROD.h))


@pytest.mark.parametrize("degrees", [0.0, 60.0, 200.0, 250.0, 300.0])
def test_rods_of_one_strength_break_as_snap_twist_breaks_them(degrees: float) -> None:
    """A point on the curve of a strength is the rod of that strength."""
    twist = np.radians(degrees)
    cascade, _ = (spec := SnapTwist(twist=twist)).broken()
    cascade.advance(spec.lasting)
    assert phase_diagram(RODS, [twist], [curvature_of_strength(twist)]) == len(cascade.lengths)


def test_stronger_rods_of_one_twist_break_into_no_fewer_pieces_across_the_line_of_two() -> None:
    """(3.23): below the line two pieces; well above it more, for twist has less of a share."""
    (row,) = phase_diagram(RODS, [np.radians(200.0)], [3.0, 5.0, 10.0, 13.0])
    assert row[:2].tolist() == [2, 2]
    assert row[2:].min() >= 4


def test_rods_that_do_not_bend_so_far_have_no_shape() -> None:
    (row,) = phase_diagram(RODS, np.radians([280.0]), [6.0, 60.0])
    assert row.tolist() == [2, NO_SHAPE]


@pytest.mark.slow
def test_workers_change_nothing() -> None:
    twists, curvatures = np.radians([0.0, 280.0]), [6.0, 14.0]
    alone = phase_diagram(RODS, twists, curvatures)
    assert len(np.unique(alone)) > 1
    assert np.array_equal(alone, phase_diagram(RODS, twists, curvatures, workers=2))


def test_grids_that_make_no_sense_are_refused() -> None:
    with pytest.raises(TorsadeError, match="limit curvatures do not increase from above 0"):
        phase_diagram(RODS, [0.0], [3.0, 2.0])
    with pytest.raises(TorsadeError, match="edges is 51; give an even number"):
        phase_diagram(Rods(RODS.material, RODS.section, edges=51), [0.0], [3.0])
