"""Closed fibers twisted by any amount, and cut open: what is carried along, and what is neighbour to what."""

from __future__ import annotations

import numpy as np
import pytest

from rod.helpers import circle
from torsade import observables
from torsade.assembly import assemble, initial_state, opened, parted, split, twisted
from torsade.errors import TorsadeError
from torsade.knots.loops import tight_loop
from torsade.rod.neighbours import NEXT, neighbour_pairs


def middles(assembly, state):
    return state.x[assembly.edges].mean(axis=1)


@pytest.fixture(scope="module")
def fibers():
    """A straight fiber, a ring and a trefoil, evenly twisted; velocities and spins that tell them apart."""
    line = np.column_stack([np.linspace(0.0, 5.0, 6), np.full(6, 30.0), np.zeros(6)])
    strands = [line, circle(12, 3.0), tight_loop("3_1").nodes]
    a = assemble(strands, [False, True, True])
    s = twisted(a, initial_state(a, strands), 0.37)
    number = np.arange(len(s.x), dtype=float)
    return a, s._replace(
        v=np.stack([number, -number, 2 * number], axis=1), omega=np.arange(len(a.edges)) + 0.5
    )


def test_twist_is_even_and_need_not_be_whole_turns(fibers) -> None:
    """m = density times length at every hinge, seams included, so Lk = Tw + Wr is no whole number."""
    a, s = fibers
    np.testing.assert_allclose(observables.hinge_twist(a, s), 0.37 * a.hinge_length, rtol=1e-12)
    assert observables.twist(a, s)[2] == pytest.approx(0.37 * a.fiber_length[2])


@pytest.mark.parametrize(("fiber", "hinge"), [(1, 0), (1, 7), (2, 0), (2, 40)])
def test_a_cut_carries_everything_else_along(fibers, fiber: int, hinge: int) -> None:
    """Edges, rest lengths, rates and the twist of all other hinges are the same to the bit."""
    a, s = fibers
    hinge += int(a.hinge_start[fiber])
    b, cut = opened(a, s, hinge)
    node, start = a.hinges[hinge, 2], b.node_start
    mine = slice(start[fiber], start[fiber + 1])
    np.testing.assert_array_equal(cut.x[mine][[0, -1]], s.x[[node, node]])
    assert b.closed.tolist() == [False, fiber != 1, fiber != 2]
    assert np.diff(start).tolist() == [n + (f == fiber) for f, n in enumerate(np.diff(a.node_start))]
    assert len(b.hinges) == len(a.hinges) - 1
    order = np.argsort(cut.omega)  # edges by their names
    np.testing.assert_array_equal(cut.omega[order], s.omega)
    for name in ("rest_length", "edge_fiber"):
        np.testing.assert_array_equal(getattr(b, name)[order], getattr(a, name))
    np.testing.assert_array_equal(cut.theta[order], s.theta)
    np.testing.assert_array_equal(cut.director[order], s.director)
    for ends in (0, 1):
        np.testing.assert_array_equal(cut.x[b.edges[order, ends]], s.x[a.edges[:, ends]])
        np.testing.assert_array_equal(cut.v[b.edges[order, ends]], s.v[a.edges[:, ends]])
    named = {tuple(s.omega[k[:2]]): m for k, m in zip(a.hinges, observables.hinge_twist(a, s), strict=True)}
    left = {
        tuple(cut.omega[k[:2]]): m for k, m in zip(b.hinges, observables.hinge_twist(b, cut), strict=True)
    }
    assert set(named) - set(left) == {tuple(s.omega[a.hinges[hinge, :2]])}
    assert all(named[k] == m for k, m in left.items())


def test_the_opened_fiber_is_what_assembly_makes_of_its_nodes(fibers) -> None:
    """Index arrays and lengths, but for which ends meet."""
    a, s = fibers
    b, cut = opened(a, s, int(a.hinge_start[2]) + 40)
    parts = [cut.x[b.node_start[f] : b.node_start[f + 1]] for f in range(3)]
    rest = [b.rest_length[b.edge_start[f] : b.edge_start[f + 1]] for f in range(3)]
    wanted = assemble(parts, b.closed.tolist(), rest)
    for name in b._fields:
        np.testing.assert_array_equal(getattr(parted(b), name), getattr(wanted, name), err_msg=name)


def test_ends_are_neighbours_until_they_have_parted() -> None:
    """A cut makes no pair that the ring had not; parted, edges beside the cut are far along the fiber."""
    x = circle(60, 10.0)
    a = assemble([x], [True])
    s = initial_state(a, [x])
    closed = neighbour_pairs(a, middles(a, s), 3.0, NEXT, 3.5)
    b, cut = opened(a, s, 0)
    assert len(neighbour_pairs(b, middles(b, cut), 3.0, NEXT, 3.5)) == len(closed)
    apart = neighbour_pairs(parted(b), middles(b, cut), 3.0, NEXT, 3.5)
    assert len(apart) > len(closed)
    assert [0, 59] in apart.tolist()


def test_open_fibers_are_split_and_closed_ones_opened(fibers) -> None:
    a, s = fibers
    with pytest.raises(TorsadeError, match=r"fiber 0 is open, and only closed fibers are opened; split it"):
        opened(a, s, 2)
    with pytest.raises(TorsadeError, match=r"fiber 1 is closed, and only open fibers are split"):
        split(a, int(a.hinge_start[1]))
    b, cut = opened(a, s, int(a.hinge_start[1]))
    assert split(b, int(b.hinge_start[1]) + 4).ends_meet.tolist() == [False, False, False, True]
    assert cut.x.shape == (len(s.x) + 1, 3)
