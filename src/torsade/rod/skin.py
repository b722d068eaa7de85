"""Skin: parallel cylinders held by springs, that fibers press and drag (thesis chapter 6).

A cylinder is endless, lies along z and does not turn: it is one node more, its centre w. Where a fiber
touches it, an edge of rest length l counts as if it lay on an edge 2h long:

    E_skin = 2h K sum_e A_e V(p),   A_e = 2h l,   p = (h_s + h - D)/2h,   V as between strands,
    w_e    = drag eta_f A l/4h^2 + friction N/sqrt(|v|^2 + v_0^2),

D the distance of the edge's midpoint from the cylinder's axis, h_s its radius, N = K A_e V'(p) the normal
force, v the relative velocity, which the drag w_e resists. Springs pull with -k_s (w - w_0) (thesis 6.1, with
its sign put right), and the ground drags with -zeta dw/dt. Cylinders push each other apart in the same way,
as if an edge as long as they are thick lay between them.

All functions take a `Skin`, or () where there is none: the compiler then leaves them out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index, Ints, Slots
from torsade.assembly import Assembly
from torsade.rod.contact import Model, contact_potential, contact_pressure
from torsade.rod.factor import Factor, carry, substitute

MOST_CYLINDERS = 3
"""As many as a right side of the mobility solve has columns."""

SETTLED = 1e-3
"""Relative change of a friction's weight at which velocities are taken to agree with it."""

MOST_ROUNDS = 60
"""Solves of one evaluation, each with the friction of the velocities before; then the last ones are taken."""


class Skin(NamedTuple):
    """Cylinders, what holds them, and where fibers touch them.

    node, fiber (n_cylinders,) say which node and which fiber without edges stand for each; rest
    (n_cylinders, 3) [m]. radius h_s [m], stiffness k_s [N/m], ground zeta [N s/m], drag over that between
    strands, friction coefficient and slip_speed v_0 [m/s]. The first count[0] rows of edge, cylinder,
    direction (n, 2; from edge to axis), push (n,) [N] and weight (n,) [N s/m] are contacts; column
    (n_nodes, 3) and small (n_cylinders, n_cylinders + 3) are scratch.
    """

    node: Ints
    fiber: Ints
    rest: Floats
    radius: float
    stiffness: float
    ground: float
    drag: float
    friction: float
    slip_speed: float
    edge: Ints
    cylinder: Ints
    direction: Floats
    push: Floats
    weight: Floats
    column: Floats
    small: Floats
    count: Ints  # type: ignore[assignment]  # hides tuple.count


def skin_on(
    n_edges: int,
    node: Ints,
    fiber: Ints,
    rest: Floats,
    *,
    radius: float,
    stiffness: float,
    ground: float,
    drag: float = 1.0,
    friction: float = 0.0,
    slip_speed: float = 1e-6,
) -> Skin:
    """Cylinders with room for every contact: each of n_edges edges may touch each of them."""
    size, n = len(node), len(node) * n_edges
    return Skin(
        node, fiber, rest, radius, stiffness, ground, drag, friction, slip_speed, np.zeros(n, np.int64),
        np.zeros(n, np.int64), np.zeros((n, 2)), np.zeros(n), np.zeros(n), np.zeros((int(node[-1]) + 1, 3)),
        np.zeros((size, size + 3)), np.zeros(1, np.int64),
    )  # fmt: skip


def add_skin_forces(
    a: Assembly, m: Model, skin: Skin | tuple[()], x: Floats, mid: Floats, force: Floats
) -> None:
    """Find where edges with midpoints mid (n_edges, 3) touch, and add all forces on and by the skin."""
    if len(skin) == 0:
        return
    node, rest, edges, rest_length = skin.node, skin.rest, a.edges, a.rest_length
    edge, cylinder, direction, push = skin.edge, skin.cylinder, skin.direction, skin.push
    reach = skin.radius + 0.5 * m.diameter
    count = 0
    for c in range(node.shape[0]):
        i = node[c]
        for k in range(3):
            force[i, k] -= skin.stiffness * (x[i, k] - rest[c, k])
        for e in range(edges.shape[0]):
            dx = x[i, 0] - mid[e, 0]
            dy = x[i, 1] - mid[e, 1]
            squared = dx * dx + dy * dy
            if squared < reach * reach:
                D = math.sqrt(squared)
                # So much overlap is that of two strands at this distance.
                apart = D - skin.radius + 0.5 * m.diameter
                N = m.diameter * rest_length[e] * contact_pressure(m, apart)
                edge[count] = e
                cylinder[count] = c
                push[count] = N
                direction[count, 0] = dx / D
                direction[count, 1] = dy / D
                for k in range(2):
                    f = N * direction[count, k]
                    force[i, k] += f
                    force[edges[e, 0], k] -= 0.5 * f
                    force[edges[e, 1], k] -= 0.5 * f
                count += 1
        for d in range(c):
            _part_cylinders(m, skin.radius, i, node[d], x, force)
    skin.count[0] = count


def _part_cylinders(m: Model, radius: float, i: Index, j: Index, x: Floats, force: Floats) -> None:
    """Push two cylinders, nodes i and j, apart where they overlap."""
    dx = x[i, 0] - x[j, 0]
    dy = x[i, 1] - x[j, 1]
    D = math.sqrt(dx * dx + dy * dy)
    if 2.0 * radius > D:
        N = m.diameter * 2.0 * radius * contact_pressure(m, D - 2.0 * radius + m.diameter)
        force[i, 0] += N * dx / D
        force[i, 1] += N * dy / D
        force[j, 0] -= N * dx / D
        force[j, 1] -= N * dy / D


def skin_energy(a: Assembly, m: Model, skin: Skin, x: Floats, mid: Floats) -> tuple[float, float]:
    """Energy [J] of contacts with the skin and between its parts, at the contacts found, and of springs."""
    node, rest, edge, cylinder = skin.node, skin.rest, skin.edge, skin.cylinder
    contact = 0.0
    for n in range(skin.count[0]):
        e = edge[n]
        i = node[cylinder[n]]
        D = math.sqrt((x[i, 0] - mid[e, 0]) ** 2 + (x[i, 1] - mid[e, 1]) ** 2)
        p = (skin.radius + 0.5 * m.diameter - D) / m.diameter
        contact += m.diameter * a.rest_length[e] * (m.diameter * m.K * contact_potential(m, p))
    spring = 0.0
    for c in range(node.shape[0]):
        i = node[c]
        for k in range(3):
            spring += 0.5 * skin.stiffness * (x[i, k] - rest[c, k]) ** 2
        for d in range(c):
            j = node[d]
            D = math.sqrt((x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2)
            p = (2.0 * skin.radius - D) / m.diameter
            if p > 0.0:
                contact += m.diameter * 2.0 * skin.radius * (m.diameter * m.K * contact_potential(m, p))
    return contact, spring


def weigh_skin(a: Assembly, m: Model, skin: Skin | tuple[()], v: Floats) -> float:
    """Weight of the drag at every contact, its friction that at velocities v (n_nodes, 3).

    Friction is left out where nothing moves at all, since then velocities are not known yet.
    Returns the largest relative change of a weight, 0 where there is no friction.
    """
    if len(skin) == 0:
        return 0.0
    node, edges, rest_length = skin.node, a.edges, a.rest_length
    edge, cylinder, push, weight = skin.edge, skin.cylinder, skin.push, skin.weight
    viscous = skin.drag * m.eta_f_A / (m.diameter * m.diameter)
    change = 0.0
    for n in range(skin.count[0]):
        w = viscous * rest_length[edge[n]]
        if skin.friction > 0.0:
            i = edges[edge[n], 0]
            j = edges[edge[n], 1]
            c = node[cylinder[n]]
            squared = 0.0
            for k in range(3):
                squared += (0.5 * (v[i, k] + v[j, k]) - v[c, k]) ** 2
            if squared > 0.0:
                w += skin.friction * push[n] / math.sqrt(squared + skin.slip_speed * skin.slip_speed)
            change = max(change, abs(w - weight[n]) / w)
        weight[n] = w
    return change


def add_skin_drag(a: Assembly, skin: Skin | tuple[()], v: Floats, out: Floats) -> None:
    """out (n_nodes, 3) [N] += the skin's part of M v."""
    if len(skin) == 0:
        return
    node, edges = skin.node, a.edges
    edge, cylinder, weight = skin.edge, skin.cylinder, skin.weight
    for c in range(node.shape[0]):
        for k in range(3):
            out[node[c], k] += skin.ground * v[node[c], k]
    for n in range(skin.count[0]):
        i = edges[edge[n], 0]
        j = edges[edge[n], 1]
        c = node[cylinder[n]]
        for k in range(3):
            f = weight[n] * (0.5 * (v[i, k] + v[j, k]) - v[c, k])
            out[i, k] += 0.5 * f
            out[j, k] += 0.5 * f
            out[c, k] -= f


def power_of_skin(a: Assembly, skin: Skin | tuple[()], v: Floats, chosen: Bools) -> float:
    """Power [W] that chosen nodes (n_nodes,) spend on the skin's drag at velocities v (n_nodes, 3)."""
    power = 0.0
    if len(skin) == 0:
        return power
    node, edges = skin.node, a.edges
    edge, cylinder, weight = skin.edge, skin.cylinder, skin.weight
    for c in range(node.shape[0]):
        if chosen[node[c]]:
            for k in range(3):
                power += skin.ground * v[node[c], k] * v[node[c], k]
    for n in range(skin.count[0]):
        i = edges[edge[n], 0]
        j = edges[edge[n], 1]
        c = node[cylinder[n]]
        for k in range(3):
            own = 0.5 * ((v[i, k] if chosen[i] else 0.0) + (v[j, k] if chosen[j] else 0.0))
            own -= v[c, k] if chosen[c] else 0.0
            power += weight[n] * (0.5 * (v[i, k] + v[j, k]) - v[c, k]) * own
    return power


def add_skin_entries(
    a: Assembly, skin: Skin | tuple[()], diagonal: Floats, coupling: Floats, slot: Slots | tuple[()]
) -> None:
    """Add the skin's part of M, but for what couples fibers and cylinders.

    diagonal (n_nodes,) is that of M, and coupling what couples the nodes of edges: of edge e at slot[e], or
    at e where slot is ().
    """
    if len(skin) == 0:
        return
    node, edges = skin.node, a.edges
    edge, cylinder, weight = skin.edge, skin.cylinder, skin.weight
    for c in range(node.shape[0]):
        diagonal[node[c]] += skin.ground
    for n in range(skin.count[0]):
        w = 0.25 * weight[n]
        e = edge[n]
        diagonal[edges[e, 0]] += w
        diagonal[edges[e, 1]] += w
        coupling[e if len(slot) == 0 else slot[e]] += w
        diagonal[node[cylinder[n]]] += weight[n]


def couple_skin(
    a: Assembly, skin: Skin | tuple[()], factor: Factor, force: Floats, fixed: Bools, v: Floats
) -> None:
    """Correct v (n_nodes, 3), solved as if cylinders did not move, for what fibers and cylinders do together.

    With B the coupling and D the diagonal of cylinders, they solve (D - B^T A^-1 B) v_c = F_c + B^T v, and
    fibers move by A^-1 B v_c more. A held node (fixed) does not respond.
    """
    if len(skin) == 0:
        return
    node, edges, column, small = skin.node, a.edges, skin.column, skin.small
    edge, cylinder, weight = skin.edge, skin.cylinder, skin.weight
    size = node.shape[0]
    for i in range(column.shape[0]):
        for k in range(3):
            column[i, k] = 0.0
    for c in range(size):
        for d in range(size):
            small[c, d] = skin.ground if d == c else 0.0
        for k in range(3):
            small[c, size + k] = force[node[c], k]
    for n in range(skin.count[0]):
        c = cylinder[n]
        small[c, c] += weight[n]
        for end in range(2):
            i = edges[edge[n], end]
            for k in range(3):
                small[c, size + k] += 0.5 * weight[n] * v[i, k]
            if not fixed[i]:
                column[i, c] += 0.5 * weight[n]
    carry(factor, column)
    substitute(factor, column)
    for n in range(skin.count[0]):
        c = cylinder[n]
        for end in range(2):
            i = edges[edge[n], end]
            for d in range(size):
                small[c, d] -= 0.5 * weight[n] * column[i, d]
    _solve_small(size, small)
    for i in range(v.shape[0]):
        for c in range(size):
            for k in range(3):
                v[i, k] += column[i, c] * small[c, size + k]
    for c in range(size):
        for k in range(3):
            v[node[c], k] = small[c, size + k]


def _solve_small(size: Index, rows: Floats) -> None:
    """Solve a symmetric, positive definite system of a few unknowns; three right sides stand behind it."""
    for p in range(size):
        for q in range(p + 1, size):
            l = rows[q, p] / rows[p, p]
            for d in range(p, size + 3):
                rows[q, d] -= l * rows[p, d]
    for p in range(size - 1, -1, -1):
        for k in range(size, size + 3):
            for q in range(p + 1, size):
                rows[p, k] -= rows[p, q] * rows[q, k]
            rows[p, k] /= rows[p, p]


def add_skin_torques(
    a: Assembly,
    m: Model,
    skin: Skin | tuple[()],
    v: Floats,
    tangent: Floats,
    torque: Floats,
    spin_weight: Floats,
) -> None:
    """Add the torque (n_edges,) [N m] of the viscous drag on the skin, as that between strands 2h apart."""
    if len(skin) == 0:
        return
    node, edges, rest_length = skin.node, a.edges, a.rest_length
    edge, cylinder, direction = skin.edge, skin.cylinder, skin.direction
    for n in range(skin.count[0]):
        e = edge[n]
        i = edges[e, 0]
        j = edges[e, 1]
        c = node[cylinder[n]]
        dx = v[c, 0] - 0.5 * (v[i, 0] + v[j, 0])
        dy = v[c, 1] - 0.5 * (v[i, 1] + v[j, 1])
        dz = v[c, 2] - 0.5 * (v[i, 2] + v[j, 2])
        rx, ry = direction[n, 0], direction[n, 1]
        s = ry * dz * tangent[e, 0] - rx * dz * tangent[e, 1] + (rx * dy - ry * dx) * tangent[e, 2]
        w = skin.drag * m.eta_f_J * rest_length[e] / (m.diameter * m.diameter)
        torque[e] += w * s / m.diameter
        if m.spin_drag:
            spin_weight[e] += w


def join_skin(a: Assembly, skin: Skin | tuple[()], component: Ints) -> None:
    """Let fibers that touch a cylinder be one body with it; component (n_fibers,) labels bodies."""
    if len(skin) == 0:
        return
    for n in range(skin.count[0]):
        p = component[a.edge_fiber[skin.edge[n]]]
        q = component[skin.fiber[skin.cylinder[n]]]
        if p != q:
            for f in range(component.shape[0]):
                if component[f] == max(p, q):
                    component[f] = min(p, q)


def on_skin(skin: Skin | tuple[()], body: Index, component: Ints) -> bool:
    """Whether a cylinder, which the ground holds, is part of a body."""
    if len(skin) == 0:
        return False
    found = False
    for c in range(skin.fiber.shape[0]):
        found = found or component[skin.fiber[c]] == body
    return found


compile_kernels(__name__, inline=("_part_cylinders", "_solve_small"), plain=("skin_on",))
