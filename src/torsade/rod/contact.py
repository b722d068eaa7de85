"""Soft contact between edges and the collision drag that goes with it.

Contact (thesis 4.4, 4.5): edges whose midpoints are nearer than the diameter 2h repel each other with

    E_c = 2h K sum_<e,f> A_ef V(p),   V(p) = 1/2 (p^2 + p0^2 p^4),   p = 1 - R/2h,

R the distance of the midpoints. The contact area A_ef is the product of rest lengths (`product`, the
continuum limit) or |e . f| of the edge vectors (`projected`, as published). Forces act along the line of
midpoints; they are the exact gradient for `product` and the gradient at frozen area for `projected`.

Collision drag couples the velocities of what touches, as a weighted graph Laplacian:

    node-pair   w = eta_f A (lbar_i + lbar_j)/2 / r_ij^2 on the start and on the end nodes (thesis 4.6,
                with the lengths lbar that edges have at present)
    continuum   w = eta_f A l_e l_f / R^3 on the midpoints (thesis 4.8, 4.10)
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade._compile import compile_kernels
from torsade.rod.neighbours import excluded


class Model(NamedTuple):
    """Coefficients of all forces on uniform circular fibers, SI units.

    EA [N], B = E_b I and C = mu J [N m^2], K bulk modulus [Pa], p0_squared of the contact potential,
    diameter 2h [m], eta_A [N s], eta_J [N m^2 s], their collision counterparts eta_f_A and eta_f_J,
    the laws (projected: contact area; node_pair: drag; spin_drag: whether a strand's own spin is
    dragged in contact; bend_present: curvature per present, not rest, arclength), and the exclusion
    along a fiber (edges, and rest arclength [m]).
    """

    EA: float
    B: float
    C: float
    K: float
    p0_squared: float
    diameter: float
    eta_A: float
    eta_J: float
    eta_f_A: float
    eta_f_J: float
    projected: bool
    node_pair: bool
    spin_drag: bool
    bend_present: bool
    exclusion_edges: int
    exclusion_length: float


class Contacts(NamedTuple):
    """Edge pairs near each other, those in contact, and the drag between nodes that follows.

    pairs (n_pairs, 2) is the Verlet list; the first count[0] rows of edges (n_pairs, 2), direction
    (n_pairs, 3; unit vector from the first to the second edge) and distance (n_pairs,) are contacts;
    the first count[1] rows of drag_nodes (2 n_pairs, 4) and drag_weight (2 n_pairs,) [N s/m] couple the
    mean velocity of the first two nodes to that of the last two.
    """

    pairs: NDArray[np.int64]
    edges: NDArray[np.int64]
    direction: NDArray[np.float64]
    distance: NDArray[np.float64]
    drag_nodes: NDArray[np.int64]
    drag_weight: NDArray[np.float64]
    count: NDArray[np.int64]


def contacts_among(pairs):
    """Empty contacts with room for every pair of the Verlet list."""
    n = max(1, pairs.shape[0])
    return Contacts(
        pairs,
        np.empty((n, 2), np.int64),
        np.empty((n, 3)),
        np.empty(n),
        np.empty((2 * n, 4), np.int64),
        np.empty(2 * n),
        np.zeros(2, np.int64),
    )


def find_contacts(m, mid, contacts):
    """Fill contacts.edges, direction, distance with the pairs nearer than the diameter."""
    count = 0
    for k in range(contacts.pairs.shape[0]):
        e = contacts.pairs[k, 0]
        f = contacts.pairs[k, 1]
        dx = mid[f, 0] - mid[e, 0]
        dy = mid[f, 1] - mid[e, 1]
        dz = mid[f, 2] - mid[e, 2]
        squared = dx * dx + dy * dy + dz * dz
        if squared < m.diameter * m.diameter:
            R = math.sqrt(squared)
            s = 1.0 / R
            contacts.edges[count, 0] = e
            contacts.edges[count, 1] = f
            contacts.distance[count] = R
            contacts.direction[count, 0] = dx * s
            contacts.direction[count, 1] = dy * s
            contacts.direction[count, 2] = dz * s
            count += 1
    contacts.count[0] = count


def contact_area(a, m, e, f, length, tangent):
    """Area A_ef [m^2] of the contact of edges e and f."""
    if m.projected:
        cosine = tangent[e, 0] * tangent[f, 0] + tangent[e, 1] * tangent[f, 1] + tangent[e, 2] * tangent[f, 2]
        return length[e] * length[f] * abs(cosine)
    return a.rest_length[e] * a.rest_length[f]


def contact_energy(a, m, length, tangent, contacts):
    """E_c [J]."""
    total = 0.0
    for k in range(contacts.count[0]):
        p = 1.0 - contacts.distance[k] / m.diameter
        area = contact_area(a, m, contacts.edges[k, 0], contacts.edges[k, 1], length, tangent)
        total += m.diameter * m.K * area * 0.5 * (p * p + m.p0_squared * p**4)
    return total


def contact_pressure(m, R):
    """K V'(p) [Pa] at midpoint distance R [m]."""
    p = 1.0 - R / m.diameter
    return m.K * (p + 2.0 * m.p0_squared * p * p * p)


def add_contact_forces(a, m, length, tangent, contacts, force):
    """Add -dE_c/dx of every contact to force (n_nodes, 3) [N], half to each node of an edge."""
    for k in range(contacts.count[0]):
        e = contacts.edges[k, 0]
        f = contacts.edges[k, 1]
        area = contact_area(a, m, e, f, length, tangent)
        half = 0.5 * area * contact_pressure(m, contacts.distance[k])
        e0 = a.edges[e, 0]
        e1 = a.edges[e, 1]
        f0 = a.edges[f, 0]
        f1 = a.edges[f, 1]
        for c in range(3):
            push = half * contacts.direction[k, c]
            force[e0, c] -= push
            force[e1, c] -= push
            force[f0, c] += push
            force[f1, c] += push


def compression(a, m, length, tangent, contacts):
    """Total compression force [N]: over every edge, the sum of the contact forces on it (Fig 4-1B)."""
    total = 0.0
    for k in range(contacts.count[0]):
        area = contact_area(a, m, contacts.edges[k, 0], contacts.edges[k, 1], length, tangent)
        total += 2.0 * area * contact_pressure(m, contacts.distance[k])
    return total


def _edge_before(a, e):
    """The edge that ends where e starts, or -1 at a free end."""
    fiber = a.edge_fiber[e]
    if e > a.edge_start[fiber]:
        return e - 1
    if a.closed[fiber]:
        return a.edge_start[fiber + 1] - 1
    return -1


def _touching(a, m, mid, e, f):
    """Whether the midpoints of edges e and f (either may be -1) are nearer than the diameter."""
    if e < 0 or f < 0 or excluded(a, e, f, m.exclusion_edges, m.exclusion_length):
        return False
    dx = mid[f, 0] - mid[e, 0]
    dy = mid[f, 1] - mid[e, 1]
    dz = mid[f, 2] - mid[e, 2]
    return dx * dx + dy * dy + dz * dz < m.diameter * m.diameter


def _node_length(a, fiber, i, length):
    """Voronoi length [m] of node i with its edges as long as they are."""
    edge = a.edge_start[fiber] + i - a.node_start[fiber]
    after = length[edge] if edge < a.edge_start[fiber + 1] else 0.0
    before = 0.0
    if i > a.node_start[fiber]:
        before = length[edge - 1]
    elif a.closed[fiber]:
        before = length[a.edge_start[fiber + 1] - 1]
    return 0.5 * (before + after)


def _couple_nodes(a, m, x, length, e, f, end, contacts):
    """The node-pair drag between the starts (end 0) or the ends (end 1) of edges e and f."""
    i = a.edges[e, end]
    j = a.edges[f, end]
    dx = x[i, 0] - x[j, 0]
    dy = x[i, 1] - x[j, 1]
    dz = x[i, 2] - x[j, 2]
    k = contacts.count[1]
    contacts.drag_nodes[k, 0] = i
    contacts.drag_nodes[k, 1] = i
    contacts.drag_nodes[k, 2] = j
    contacts.drag_nodes[k, 3] = j
    mean = 0.5 * (_node_length(a, a.edge_fiber[e], i, length) + _node_length(a, a.edge_fiber[f], j, length))
    contacts.drag_weight[k] = m.eta_f_A * mean / (dx * dx + dy * dy + dz * dz)
    contacts.count[1] = k + 1


def find_drag(a, m, x, length, mid, contacts):
    """Fill contacts.drag_nodes and drag_weight from the contacts found, each coupling once."""
    contacts.count[1] = 0
    for k in range(contacts.count[0]):
        e = contacts.edges[k, 0]
        f = contacts.edges[k, 1]
        if m.node_pair:
            _couple_nodes(a, m, x, length, e, f, 1, contacts)
            if not _touching(a, m, mid, _edge_before(a, e), _edge_before(a, f)):
                _couple_nodes(a, m, x, length, e, f, 0, contacts)
        else:
            d = contacts.count[1]
            contacts.drag_nodes[d, 0] = a.edges[e, 0]
            contacts.drag_nodes[d, 1] = a.edges[e, 1]
            contacts.drag_nodes[d, 2] = a.edges[f, 0]
            contacts.drag_nodes[d, 3] = a.edges[f, 1]
            area = a.rest_length[e] * a.rest_length[f]
            contacts.drag_weight[d] = m.eta_f_A * area / contacts.distance[k] ** 3
            contacts.count[1] = d + 1


def add_drag_torques(a, m, v, tangent, contacts, torque, spin_weight):
    """Add the collision torque (n_edges,) [N m] that velocities v (n_nodes, 3) exert on each edge.

    An edge is dragged towards the spin (r x dv) . d_3 / R at which its surface would move with the other
    strand (thesis 4.7, 4.9), with weight eta J l / R^2 (node-pair) or eta_f J l_e l_f / R^3 (continuum);
    spin_weight (n_edges,) [N m s] receives the weights when the model drags a strand's own spin.
    """
    for k in range(contacts.count[0]):
        e = contacts.edges[k, 0]
        f = contacts.edges[k, 1]
        R = contacts.distance[k]
        r = contacts.direction[k]
        e0 = a.edges[e, 0]
        e1 = a.edges[e, 1]
        f0 = a.edges[f, 0]
        f1 = a.edges[f, 1]
        dx = 0.5 * (v[f0, 0] + v[f1, 0] - v[e0, 0] - v[e1, 0])
        dy = 0.5 * (v[f0, 1] + v[f1, 1] - v[e0, 1] - v[e1, 1])
        dz = 0.5 * (v[f0, 2] + v[f1, 2] - v[e0, 2] - v[e1, 2])
        sx = (r[1] * dz - r[2] * dy) / R
        sy = (r[2] * dx - r[0] * dz) / R
        sz = (r[0] * dy - r[1] * dx) / R
        if m.node_pair:
            we = m.eta_f_J * a.rest_length[e] / (R * R)
            wf = m.eta_f_J * a.rest_length[f] / (R * R)
        else:
            we = m.eta_f_J * a.rest_length[e] * a.rest_length[f] / (R * R * R)
            wf = we
        torque[e] += we * (sx * tangent[e, 0] + sy * tangent[e, 1] + sz * tangent[e, 2])
        torque[f] += wf * (sx * tangent[f, 0] + sy * tangent[f, 1] + sz * tangent[f, 2])
        if m.spin_drag:
            spin_weight[e] += we
            spin_weight[f] += wf


compile_kernels(__name__)
