"""Which edges are near each other: looked for seldom, and listed from those found when nodes have moved."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Ints
from torsade.assembly import Assembly, State
from torsade.motion.ends import Boundary
from torsade.motion.guard import first_crossing
from torsade.motion.rates import Work, energies, forces
from torsade.motion.scheme import Control
from torsade.rod.contact import (
    Contacts,
    Model,
    add_drag_torques,
    compression,
    contacts_among,
    list_contacts,
)
from torsade.rod.kinematics import edge_geometry
from torsade.rod.neighbours import (
    NEXT,
    edge_midpoints,
    near_points,
    near_rows,
    neighbour_pairs,
    without_excluded,
)


class Near(NamedTuple):
    """Pairs of edges found near each other.

    apart (n, 2) share no node; the first count[0] of guarded (n,) are rows of those that a step might let
    pass through each other. contacts has its own pairs, those that may come to touch.
    """

    apart: Ints
    guarded: Ints
    contacts: Contacts
    count: Ints  # type: ignore[assignment]  # hides tuple.count


def _guard_reach(length: Floats, control: Control, move: float) -> float:
    """Midpoints of edges that may cross in a step of nodes by move [m] are nearer than this [m]."""
    longest = 0.0
    for e in range(length.shape[0]):
        longest = max(longest, length[e])
    return longest + 2.0 * move + 0.5 * control.skin


def find_near(a: Assembly, m: Model, control: Control, mid: Floats, length: Floats) -> Near:
    """Look for pairs of edges with midpoints mid (n_edges, 3) and lengths (n_edges,), and list them.

    They serve until a node has gone control.roam; lists, until a node has gone a quarter of the skin.
    """
    touching = m.diameter + control.skin + 2.0 * control.roam
    crossing = _guard_reach(length, control, control.move) + 2.0 * control.roam
    found = near_points(mid, max(touching, crossing))
    apart = without_excluded(a, found, mid, crossing, NEXT, 0.0)
    pairs = without_excluded(a, found, mid, touching, m.exclusion_edges, m.exclusion_length)
    near = Near(apart, np.empty(apart.shape[0], np.int64), contacts_among(pairs), np.empty(1, np.int64))
    list_near(m, control, mid, length, near)
    return near


def list_near(m: Model, control: Control, mid: Floats, length: Floats, near: Near) -> None:
    """List the pairs to look at in the next steps."""
    near.count[0] = near_rows(near.apart, mid, _guard_reach(length, control, control.move), near.guarded)
    list_contacts(mid, m.diameter + control.skin, near.contacts)


def crossing(
    a: Assembly,
    control: Control,
    near: Near,
    x0: Floats,
    x1: Floats,
    length: Floats,
    mid: Floats,
    move: float,
) -> tuple[int, int]:
    """Edges that would pass through each other as nodes go from x0 to x1, by at most move [m], or (-1, -1).

    length (n_edges,) and mid (n_edges, 3) are those at x0.
    """
    pairs, rows, count = near.apart, near.guarded, near.count[0]
    if move > control.move:
        reach = _guard_reach(length, control, move)
        pairs = neighbour_pairs(a, mid, reach, NEXT, 0.0)
        rows = np.empty(pairs.shape[0], np.int64)
        count = near_rows(pairs, mid, reach, rows)
    k = first_crossing(a, pairs, rows, count, x0, x1, length, mid, move)
    return (pairs[k, 0], pairs[k, 1]) if k >= 0 else (-1, -1)


def measure(a: Assembly, m: Model, bc: Boundary, state: State, w: Work, out: Floats) -> Ints:
    """Stretch, bend, twist and contact energy [J] and total compression [N] of a state, into out (5,).

    Returns the pairs of edges in contact (n_contacts, 2); w.drag_torque holds the torques [N m] that the
    velocities of the state exert by collision drag.
    """
    edge_geometry(a, state.x, w.length, w.tangent)
    edge_midpoints(state.x, a.edges, w.mid)
    pairs = neighbour_pairs(a, w.mid, m.diameter, m.exclusion_edges, m.exclusion_length)
    contacts = contacts_among(pairs)
    forces(a, m, bc, state.x, state.theta, w.tangent, state.reference_twist, contacts, w)
    energies(a, m, contacts, w, out)
    out[4] = compression(a, m, w.length, w.tangent, contacts)
    w.drag_torque[:] = 0.0
    add_drag_torques(a, m, state.v, w.tangent, contacts, w.drag_torque, w.spin_weight)
    return pairs


compile_kernels(__name__, inline=("_guard_reach",), owning=("find_near", "crossing", "measure"))
