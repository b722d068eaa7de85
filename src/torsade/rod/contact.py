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

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index, Ints
from torsade.assembly import Assembly
from torsade.rod.neighbours import near_rows


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

    pairs (n_pairs, 2) may come to touch; the first count[2] of listed (n_pairs,) are those of them that
    may touch now. The first count[0] rows of edges (n_pairs, 2), direction (n_pairs, 3; unit vector from
    the first to the second edge), distance (n_pairs,) and row (n_pairs,; in pairs) are contacts. The first
    count[1] rows of drag_nodes (2 n_pairs, 4) and drag_weight (2 n_pairs,) [N s/m] couple the mean
    velocity of the first two nodes to that of the last two, because of the contact drag_contact.
    """

    pairs: Ints
    listed: Ints
    edges: Ints
    direction: Floats
    distance: Floats
    row: Ints
    drag_nodes: Ints
    drag_weight: Floats
    drag_contact: Ints
    count: Ints  # type: ignore[assignment]  # hides tuple.count


def contacts_among(pairs: Ints) -> Contacts:
    """No contacts yet, with room for every pair (n_pairs, 2); all pairs are listed."""
    n = max(1, pairs.shape[0])
    listed = np.empty(pairs.shape[0], np.int64)
    for k in range(listed.shape[0]):
        listed[k] = k
    count = np.empty(3, np.int64)
    count[0], count[1], count[2] = 0, 0, listed.shape[0]
    return Contacts(
        pairs, listed, np.empty((n, 2), np.int64), np.empty((n, 3)), np.empty(n), np.empty(n, np.int64),
        np.empty((2 * n, 4), np.int64), np.empty(2 * n), np.empty(2 * n, np.int64), count,
    )  # fmt: skip


def list_contacts(mid: Floats, reach: float, contacts: Contacts) -> None:
    """List the pairs with midpoints (n_edges, 3) nearer than reach [m]: only they may touch for a while."""
    pairs, listed = contacts.pairs, contacts.listed
    contacts.count[2] = near_rows(pairs, mid, reach, listed)


def find_contacts(m: Model, mid: Floats, contacts: Contacts) -> None:
    """Fill contacts.edges, direction, distance, row with the listed pairs nearer than the diameter."""
    pairs, listed, row = contacts.pairs, contacts.listed, contacts.row
    edges, direction, distance = contacts.edges, contacts.direction, contacts.distance
    reach = m.diameter * m.diameter
    count = 0
    for n in range(contacts.count[2]):
        k = np.uintp(listed[n])
        e = np.uintp(pairs[k, 0])
        f = np.uintp(pairs[k, 1])
        dx = mid[f, 0] - mid[e, 0]
        dy = mid[f, 1] - mid[e, 1]
        dz = mid[f, 2] - mid[e, 2]
        squared = dx * dx + dy * dy + dz * dz
        if squared < reach:
            R = math.sqrt(squared)
            s = 1.0 / R
            edges[count, 0] = e
            edges[count, 1] = f
            row[count] = k
            distance[count] = R
            direction[count, 0] = dx * s
            direction[count, 1] = dy * s
            direction[count, 2] = dz * s
            count += 1
    contacts.count[0] = count


def _area(projected: bool, e: Index, f: Index, rest_length: Floats, length: Floats, tangent: Floats) -> float:
    """Area A_ef [m^2] of the contact of edges e and f."""
    if projected:
        cosine = tangent[e, 0] * tangent[f, 0] + tangent[e, 1] * tangent[f, 1] + tangent[e, 2] * tangent[f, 2]
        present: float = length[e] * length[f] * abs(cosine)
        return present
    rest: float = rest_length[e] * rest_length[f]
    return rest


def contact_energy(a: Assembly, m: Model, length: Floats, tangent: Floats, contacts: Contacts) -> float:
    """E_c [J]."""
    rest_length, edges, distance = a.rest_length, contacts.edges, contacts.distance
    total = 0.0
    for k in range(contacts.count[0]):
        p = 1.0 - distance[k] / m.diameter
        e, f = np.uintp(edges[k, 0]), np.uintp(edges[k, 1])
        area = _area(m.projected, e, f, rest_length, length, tangent)
        total += m.diameter * m.K * area * contact_potential(m, p)
    return total


def contact_potential(m: Model, p: float) -> float:
    """V(p) of a compression p."""
    return 0.5 * (p * p + m.p0_squared * p**4)


def contact_pressure(m: Model, R: float) -> float:
    """K V'(p) [Pa] at midpoint distance R [m]."""
    p = 1.0 - R / m.diameter
    return m.K * (p + 2.0 * m.p0_squared * p * p * p)


def add_contact_forces(
    a: Assembly, m: Model, length: Floats, tangent: Floats, contacts: Contacts, force: Floats
) -> None:
    """Add the force of every contact to force (n_nodes, 3) [N], half to each node of an edge."""
    nodes, rest_length = a.edges, a.rest_length
    edges, direction, distance = contacts.edges, contacts.direction, contacts.distance
    for k in range(contacts.count[0]):
        e = np.uintp(edges[k, 0])
        f = np.uintp(edges[k, 1])
        area = _area(m.projected, e, f, rest_length, length, tangent)
        half = 0.5 * area * contact_pressure(m, distance[k])
        e0 = np.uintp(nodes[e, 0])
        e1 = np.uintp(nodes[e, 1])
        f0 = np.uintp(nodes[f, 0])
        f1 = np.uintp(nodes[f, 1])
        for c in range(3):
            push = half * direction[k, c]
            force[e0, c] -= push
            force[e1, c] -= push
            force[f0, c] += push
            force[f1, c] += push


def compression(a: Assembly, m: Model, length: Floats, tangent: Floats, contacts: Contacts) -> float:
    """Total compression force [N]: over every edge, the sum of the contact forces on it (Fig 4-1B)."""
    rest_length, edges, distance = a.rest_length, contacts.edges, contacts.distance
    total = 0.0
    for k in range(contacts.count[0]):
        e, f = np.uintp(edges[k, 0]), np.uintp(edges[k, 1])
        area = _area(m.projected, e, f, rest_length, length, tangent)
        total += 2.0 * area * contact_pressure(m, distance[k])
    return total


def _find_node_pairs(
    a: Assembly, m: Model, x: Floats, length: Floats, mid: Floats, contacts: Contacts
) -> None:
    """Node-pair drag: start nodes i, j couple when edges (i, j) or the edges before them touch.

    So do the end nodes of touching edges, which are the start nodes of the next ones; a coupling that
    the edges before have already made is not made twice. Edges before are as far apart along a fiber.
    """
    nodes, neighbour = a.edges, a.beside
    edges, drag_contact = contacts.edges, contacts.drag_contact
    drag_nodes, drag_weight = contacts.drag_nodes, contacts.drag_weight
    count = 0
    for k in range(2 * contacts.count[0]):
        end = 1 - k % 2
        e = edges[k // 2, 0]
        f = edges[k // 2, 1]
        eb = neighbour[e, end]
        fb = neighbour[f, end]
        i = nodes[e, end]
        j = nodes[f, end]
        squared = 0.0
        beside = 0.0
        for c in range(3):
            squared += (x[i, c] - x[j, c]) ** 2
            beside += (mid[eb, c] - mid[fb, c]) ** 2
        if end == 0 and eb >= 0 and fb >= 0 and beside < m.diameter * m.diameter:
            continue
        lbar = length[e] + length[f]
        lbar += length[eb] if eb >= 0 else 0.0
        lbar += length[fb] if fb >= 0 else 0.0
        drag_nodes[count, 0] = i
        drag_nodes[count, 1] = i
        drag_nodes[count, 2] = j
        drag_nodes[count, 3] = j
        drag_weight[count] = m.eta_f_A * 0.25 * lbar / squared
        drag_contact[count] = k // 2
        count += 1
    contacts.count[1] = count


def find_drag(a: Assembly, m: Model, x: Floats, length: Floats, mid: Floats, contacts: Contacts) -> None:
    """Fill contacts.drag_nodes and drag_weight from the contacts found, each coupling once."""
    nodes, rest_length = a.edges, a.rest_length
    edges, distance = contacts.edges, contacts.distance
    drag_nodes, drag_weight, drag_contact = contacts.drag_nodes, contacts.drag_weight, contacts.drag_contact
    if m.node_pair:
        _find_node_pairs(a, m, x, length, mid, contacts)
        return
    for k in range(contacts.count[0]):
        e = np.uintp(edges[k, 0])
        f = np.uintp(edges[k, 1])
        s = 1.0 / distance[k]
        drag_nodes[k, 0] = nodes[e, 0]
        drag_nodes[k, 1] = nodes[e, 1]
        drag_nodes[k, 2] = nodes[f, 0]
        drag_nodes[k, 3] = nodes[f, 1]
        drag_weight[k] = m.eta_f_A * rest_length[e] * rest_length[f] * (s * s * s)
        drag_contact[k] = k
    contacts.count[1] = contacts.count[0]


def add_drag_torques(
    a: Assembly, m: Model, v: Floats, tangent: Floats, contacts: Contacts, torque: Floats, spin_weight: Floats
) -> None:
    """Add the collision torque (n_edges,) [N m] that velocities v (n_nodes, 3) exert on each edge.

    An edge is dragged towards the spin (r x dv) . d_3 / R at which its surface would move with the other
    strand (thesis 4.7, 4.9), with weight eta J l / R^2 (node-pair) or eta_f J l_e l_f / R^3 (continuum);
    spin_weight (n_edges,) [N m s] receives the weights when the model drags a strand's own spin.
    """
    nodes, rest_length = a.edges, a.rest_length
    edges, direction, distance = contacts.edges, contacts.direction, contacts.distance
    for k in range(contacts.count[0]):
        e = np.uintp(edges[k, 0])
        f = np.uintp(edges[k, 1])
        s = 1.0 / distance[k]
        rx, ry, rz = direction[k, 0], direction[k, 1], direction[k, 2]
        e0 = np.uintp(nodes[e, 0])
        e1 = np.uintp(nodes[e, 1])
        f0 = np.uintp(nodes[f, 0])
        f1 = np.uintp(nodes[f, 1])
        dx = 0.5 * (v[f0, 0] + v[f1, 0] - v[e0, 0] - v[e1, 0])
        dy = 0.5 * (v[f0, 1] + v[f1, 1] - v[e0, 1] - v[e1, 1])
        dz = 0.5 * (v[f0, 2] + v[f1, 2] - v[e0, 2] - v[e1, 2])
        sx = (ry * dz - rz * dy) * s
        sy = (rz * dx - rx * dz) * s
        sz = (rx * dy - ry * dx) * s
        we = m.eta_f_J * rest_length[e] * (s * s)
        wf = m.eta_f_J * rest_length[f] * (s * s)
        if not m.node_pair:
            we *= rest_length[f] * s
            wf = we
        torque[e] += we * (sx * tangent[e, 0] + sy * tangent[e, 1] + sz * tangent[e, 2])
        torque[f] += wf * (sx * tangent[f, 0] + sy * tangent[f, 1] + sz * tangent[f, 2])
        if m.spin_drag:
            spin_weight[e] += we
            spin_weight[f] += wf


compile_kernels(
    __name__, inline=("contact_potential", "contact_pressure", "_area"), owning=("contacts_among",)
)
