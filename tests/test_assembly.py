"""Assemblies as index arrays, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.assembly import assemble, initial_state
from torsade.errors import TorsadeError

LINE = np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0], [3, 4, 0]])
SQUARE = np.array([[0.0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]])


def test_open_fiber():
    """Three edges, two hinges, Voronoi lengths that add up to the fiber's."""
    a = assemble([LINE])
    assert a.edges.tolist() == [[0, 1], [1, 2], [2, 3]]
    assert a.hinges.tolist() == [[0, 1, 1], [1, 2, 2]]
    assert a.rest_length.tolist() == [1, 2, 4]
    assert a.hinge_length.tolist() == [1.5, 3]
    assert a.node_length.tolist() == [0.5, 1.5, 3, 2]
    assert a.edge_arclength.tolist() == [0.5, 2, 5]
    assert a.fiber_length.tolist() == [7]
    assert not a.closed[0]


def test_closed_fiber_has_a_seam():
    """One edge and one hinge more: edge 3 leads back to node 0, the hinge at node 0 joins edges 3 and 0."""
    a = assemble([SQUARE], [True])
    assert a.edges.tolist() == [[0, 1], [1, 2], [2, 3], [3, 0]]
    assert a.hinges.tolist() == [[3, 0, 0], [0, 1, 1], [1, 2, 2], [2, 3, 3]]
    assert a.node_length.tolist() == [2, 2, 2, 2]
    assert a.fiber_length.tolist() == [8]


def test_several_fibers_are_numbered_through():
    """Offsets shift every index; a hinge joins the edges that meet at its node, in every fiber."""
    a = assemble([LINE, SQUARE, LINE[:2] + 7], [False, True, False])
    assert a.node_start.tolist() == [0, 4, 8, 10]
    assert a.edge_start.tolist() == [0, 3, 7, 8]
    assert a.hinge_start.tolist() == [0, 2, 6, 6]
    assert a.edge_fiber.tolist() == [0, 0, 0, 1, 1, 1, 1, 2]
    assert a.edges[6].tolist() == [7, 4]
    assert a.hinges[2].tolist() == [6, 3, 4]
    assert np.array_equal(a.edges[a.hinges[:, 0], 1], a.hinges[:, 2])
    assert np.array_equal(a.edges[a.hinges[:, 1], 0], a.hinges[:, 2])
    assert a.node_length.sum() == pytest.approx(a.rest_length.sum())


def test_rest_lengths_may_differ_from_present_ones():
    """Given rest lengths are used for all lengths of the assembly."""
    a = assemble([LINE], rest_lengths=[np.array([2.0, 2.0, 2.0])])
    assert a.rest_length.tolist() == [2, 2, 2]
    assert a.node_length.tolist() == [1, 2, 2, 1]
    assert a.hinge_length.tolist() == [2, 2]


def test_initial_state_is_untwisted_and_at_rest():
    """Directors are unit, normal to their edge, parallel along the fiber; nothing moves."""
    a = assemble([LINE, SQUARE], [False, True])
    s = initial_state(a, [LINE, SQUARE])
    edge = s.x[a.edges[:, 1]] - s.x[a.edges[:, 0]]
    assert np.allclose(np.linalg.norm(s.director, axis=1), 1, rtol=1e-15)
    assert np.abs(np.einsum("ij,ij->i", s.director, edge)).max() < 1e-15
    assert not s.theta.any()
    assert not s.v.any()
    assert not s.omega.any()
    assert np.abs(s.reference_twist).max() < 1e-15
    other = s.copy()
    other.x[0] = 9.0
    assert s.x[0, 0] == 0.0


@pytest.mark.parametrize(
    ("strands", "closed", "said"),
    [
        ([LINE[:1]], None, r"fiber 0 has 1 node; an open fiber needs at least 2: give more nodes"),
        ([LINE[:0]], None, r"fiber 0 has 0 nodes; an open fiber needs at least 2"),
        ([LINE, SQUARE[:2]], [False, True], r"fiber 1 has 2 nodes; a closed fiber needs at least 3"),
        ([LINE, LINE[[0, 1, 1, 2]]], None, r"nodes 1 and 2 of fiber 1 are at one place.*remove one"),
        ([SQUARE[[0, 1, 2, 0]]], [True], r"nodes 3 and 0 of fiber 0 are at one place"),
        ([np.where(LINE == 4, np.nan, LINE)], None, r"fiber 0"),
    ],
)
def test_what_is_refused(strands, closed, said):
    """One sentence that names the fiber, what was given and what to do."""
    with pytest.raises(TorsadeError, match=said):
        assemble(strands, closed)


def test_as_many_flags_as_strands():
    """A flag too few is a programming error, not a silent guess."""
    with pytest.raises(ValueError, match="argument 2 is shorter"):
        assemble([LINE, LINE + 1], [True])
