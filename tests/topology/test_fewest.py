"""Fewest crossings over all views, and curves thinned by triangle moves."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.knots.loops import tight_loop
from torsade.topology.fewest import DIRECTIONS, _views, fewest_crossings
from torsade.topology.identify import identify_curves
from torsade.topology.isotopy import thinned
from torsade.topology.views import directional_crossing_number


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("knot", ["3_1", "m5_2", "7_7"])
def test_the_least_of_what_is_seen_along_every_direction(knot: str, closed: bool) -> None:
    """Beside the count that the rest of the package makes, direction by direction."""
    x = tight_loop(knot).nodes[: None if closed else -20]
    toward = [np.cross(*view) for view in _views(DIRECTIONS)]
    assert len(toward) == DIRECTIONS
    seen = [directional_crossing_number(x, closed, d) for d in toward]
    assert fewest_crossings(x, closed) == min(seen)


def test_tight_knots_show_about_as_many_crossings_as_they_must() -> None:
    assert fewest_crossings(tight_loop("3_1").nodes, True) == 3
    assert 4 <= fewest_crossings(tight_loop("4_1").nodes, True) <= 5
    line = np.column_stack([np.arange(9.0), np.zeros(9), np.zeros(9)])
    assert fewest_crossings(line, False) == 0


@pytest.mark.parametrize(("knot", "most"), [("0_1", 3), ("3_1", 8), ("m7_4", 14)])
def test_thinned_curves_are_the_same_knot_of_few_nodes(knot: str, most: int) -> None:
    """A trefoil needs six edges; triangle moves that only take out come near that."""
    x = tight_loop(knot).nodes
    few = thinned(x)
    assert 3 <= len(few) <= most
    assert str(identify_curves([few])) == knot
    assert {tuple(node) for node in few} <= {tuple(node) for node in x}
