"""Velocities and spins of overdamped fibers: forces in, one linear solve, rates out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import ONE, Bools, Floats, Index, Ints, columns
from torsade.assembly import Assembly
from torsade.motion.ends import Boundary
from torsade.rod.contact import (
    Contacts,
    Model,
    add_contact_forces,
    add_drag_torques,
    contact_energy,
    find_contacts,
    find_drag,
)
from torsade.rod.damping import MobilityWork, mobility_work, power_of_drag, solve_mobility
from torsade.rod.elasticity import (
    add_elastic_forces,
    bend_energy,
    hinge_twist,
    stretch_energy,
    twist_energy,
)
from torsade.rod.factor import Factor, serves
from torsade.rod.kinematics import edge_geometry, reference_twist_change
from torsade.rod.neighbours import edge_midpoints
from torsade.rod.skin import (
    MOST_ROUNDS,
    SETTLED,
    add_skin_forces,
    add_skin_torques,
    join_skin,
    on_skin,
    power_of_skin,
    weigh_skin,
)
from torsade.rod.spin import SpinWork, solve_spin, spin_work

OK = 0
LOOSE = 1
UNSOLVED = 2
STALE = 3
DENSE = 4


class Work(NamedTuple):
    """Scratch of one evaluation of the rates: per edge, per hinge and per node."""

    length: Floats
    tangent: Floats
    mid: Floats
    torque: Floats
    drag_torque: Floats
    spin_weight: Floats
    m: Floats
    change: Floats
    edge_force: Floats
    force: Floats
    held: Bools
    component: Ints
    mobility: MobilityWork
    spin: SpinWork


def rate_work(a: Assembly) -> Work:
    """Scratch for an assembly."""
    n = a.node_length.shape[0]
    n_edges = a.edges.shape[0]
    n_hinges = a.hinges.shape[0]
    return Work(
        np.empty(n_edges),
        columns(n_edges),
        np.empty((n_edges, 3)),
        np.empty(n_edges),
        np.empty(n_edges),
        np.empty(n_edges),
        np.empty(n_hinges),
        np.empty(n_hinges),
        columns(n_edges),
        np.empty((n, 3)),
        np.empty(n, np.bool_),
        np.empty(a.closed.shape[0], np.int64),
        mobility_work(n, n_edges),
        spin_work(n_edges),
    )


def forces(
    a: Assembly,
    m: Model,
    bc: Boundary,
    x: Floats,
    theta: Floats,
    base_tangent: Floats,
    base_twist: Floats,
    contacts: Contacts,
    w: Work,
) -> None:
    """Total force and elastic plus external torque at nodes x and material angles theta, into w.

    base_tangent (n_edges, 3) and base_twist (n_hinges,) are the tangents and reference twists of the
    last completed step, from which the frames are transported.
    """
    length, tangent, twist, force, torque = w.length, w.tangent, w.change, w.force, w.torque
    external, moment = bc.force, bc.torque
    edge_geometry(a, x, length, tangent)
    reference_twist_change(a, base_tangent, tangent, twist)
    for k in range(twist.shape[0]):
        twist[k] += base_twist[k]
    hinge_twist(theta, twist, a.hinges, w.m)
    for i in range(force.shape[0]):
        for c in range(3):
            force[i, c] = external[i, c]
    for e in range(torque.shape[0]):
        torque[e] = moment[e]
    add_elastic_forces(a, m.EA, m.B, m.C, m.bend_present, length, tangent, w.m, w.edge_force, force, torque)
    edge_midpoints(x, a.edges, w.mid)
    find_contacts(m, w.mid, contacts)
    add_contact_forces(a, m, length, tangent, contacts, force)
    add_skin_forces(a, m, bc.skin, x, w.mid, force)


def _label_components(edge_fiber: Ints, contacts: Contacts, component: Ints) -> None:
    """Label fibers that contacts join into bodies: component[f] is the smallest fiber of f's body."""
    n = component.shape[0]
    for f in range(n):
        component[f] = f
    bodies = n
    edges = contacts.edges
    for k in range(contacts.count[0]):
        if bodies == 1:
            return
        p = component[edge_fiber[edges[k, 0]]]
        q = component[edge_fiber[edges[k, 1]]]
        if p != q:
            bodies -= 1
            for f in range(n):
                if component[f] == max(p, q):
                    component[f] = min(p, q)


def _anchored(body: Index, component: Ints, node_start: Ints, fixed: Bools) -> bool:
    """Whether any node of a body is held."""
    for f in range(body, component.shape[0]):
        if component[f] == body:
            for i in range(node_start[f], node_start[f + 1]):
                if fixed[i]:
                    return True
    return False


def hold_bodies(a: Assembly, bc: Boundary, contacts: Contacts, held: Bools, component: Ints) -> int:
    """Mark the held nodes, and ground one node of every body that nothing holds.

    Returns OK, or LOOSE when such a body carries a net external force: nothing resists it, so its
    velocity is unbounded (two ropes that have slipped apart).
    """
    node_start, fixed, force = a.node_start, bc.held, bc.force
    for i in range(held.shape[0]):
        held[i] = fixed[i]
    _label_components(a.edge_fiber, contacts, component)
    join_skin(a, bc.skin, component)
    for b in range(component.shape[0]):
        if component[b] != b or _anchored(b, component, node_start, fixed) or on_skin(bc.skin, b, component):
            continue
        fx = 0.0
        fy = 0.0
        fz = 0.0
        size = 0.0
        for f in range(b, component.shape[0]):
            if component[f] == b:
                for i in range(node_start[f], node_start[f + 1]):
                    fx += force[i, 0]
                    fy += force[i, 1]
                    fz += force[i, 2]
                    size += abs(force[i, 0]) + abs(force[i, 1]) + abs(force[i, 2])
        if abs(fx) + abs(fy) + abs(fz) > 1e-9 * size:
            return LOOSE
        held[node_start[b]] = True
    return OK


def _ground_guess(a: Assembly, bc: Boundary, v: Floats, held: Bools, component: Ints) -> None:
    """Make the starting guess agree with held nodes; bodies that float move with their grounded node."""
    node_start, fixed, velocity = a.node_start, bc.held, bc.velocity
    for f in range(component.shape[0]):
        g = node_start[component[f]]
        floating = held[g] and not fixed[g]
        vx = v[g, 0] if floating else 0.0
        vy = v[g, 1] if floating else 0.0
        vz = v[g, 2] if floating else 0.0
        for i in range(node_start[f], node_start[f + 1]):
            if fixed[i]:
                for c in range(3):
                    v[i, c] = velocity[i, c]
            elif floating:
                v[i, 0] -= vx
                v[i, 1] -= vy
                v[i, 2] -= vz


def _centre_floating(a: Assembly, bc: Boundary, v: Floats, held: Bools, component: Ints) -> None:
    """Give every floating body zero mean velocity over its length (its centre stays)."""
    node_start, node_length, fixed = a.node_start, a.node_length, bc.held
    for b in range(component.shape[0]):
        g = node_start[b]
        if component[b] == b and held[g] and not fixed[g]:
            sx = 0.0
            sy = 0.0
            sz = 0.0
            total = 0.0
            for f in range(b, component.shape[0]):
                if component[f] == b:
                    for i in range(node_start[f], node_start[f + 1]):
                        total += node_length[i]
                        sx += node_length[i] * v[i, 0]
                        sy += node_length[i] * v[i, 1]
                        sz += node_length[i] * v[i, 2]
            for f in range(b, component.shape[0]):
                if component[f] == b:
                    for i in range(node_start[f], node_start[f + 1]):
                        v[i, 0] -= sx / total
                        v[i, 1] -= sy / total
                        v[i, 2] -= sz / total


def rates(
    a: Assembly,
    m: Model,
    bc: Boundary,
    x: Floats,
    theta: Floats,
    base_tangent: Floats,
    base_twist: Floats,
    contacts: Contacts,
    factor: Factor | tuple[()],
    tolerance: float,
    v: Floats,
    omega: Floats,
    angular: Floats,
    w: Work,
) -> int:
    """Velocities v (n_nodes, 3), spins omega and rates of the material angles angular (n_edges,).

    v holds the starting guess. The material angle is measured from a director transported straight
    from the base tangent t0, which itself turns about t by -(t0 x t) . dt/dt / (1 + t0 . t).
    Returns OK, LOOSE (see hold_bodies), UNSOLVED, or STALE when contacts were found that the factor does
    not serve; then only forces and contacts are known.
    """
    forces(a, m, bc, x, theta, base_tangent, base_twist, contacts, w)
    if not serves(factor, contacts):
        return STALE
    find_drag(a, m, x, w.length, w.mid, contacts)
    if hold_bodies(a, bc, contacts, w.held, w.component) != OK:
        return LOOSE
    _ground_guess(a, bc, v, w.held, w.component)
    for k in range(MOST_ROUNDS):
        change = weigh_skin(a, m, bc.skin, v)
        if k > 0 and change < SETTLED:
            break
        if not solve_mobility(
            a, m.eta_A, contacts, factor, bc.skin, w.force, w.held, tolerance, v, w.mobility
        ):
            return UNSOLVED
    _centre_floating(a, bc, v, w.held, w.component)
    torque, drag_torque, spin_weight = w.torque, w.drag_torque, w.spin_weight
    for e in range(omega.shape[0]):
        drag_torque[e] = 0.0
        spin_weight[e] = 0.0
    if m.eta_f_J > 0.0:
        add_drag_torques(a, m, v, w.tangent, contacts, drag_torque, spin_weight)
        add_skin_torques(a, m, bc.skin, v, w.tangent, drag_torque, spin_weight)
    for e in range(omega.shape[0]):
        angular[e] = torque[e] + drag_torque[e]
    solve_spin(a, m.eta_J, w.tangent, angular, spin_weight, bc.turned, bc.spin, omega, w.spin)
    _material_rates(a, base_tangent, w.tangent, w.length, v, omega, angular)
    return OK


def _material_rates(
    a: Assembly, t0: Floats, t: Floats, length: Floats, v: Floats, omega: Floats, angular: Floats
) -> None:
    """Rates of the material angles: spins, corrected for the turning of the reference directors."""
    node_start, edge_start = a.node_start, a.edge_start
    for f in range(edge_start.shape[0] - 1):
        node, edge = node_start[f], edge_start[f]
        n = node_start[f + 1] - node
        for k in range(n - 1):
            e, i = np.uintp(edge + k), np.uintp(node + k)
            angular[e] = _material_rate(t0, t, length, v, omega, e, i, i + ONE)
        if edge_start[f + 1] - edge == n:
            e, i = np.uintp(edge + n - 1), np.uintp(node + n - 1)
            angular[e] = _material_rate(t0, t, length, v, omega, e, i, np.uintp(node))


def _material_rate(
    t0: Floats, t: Floats, length: Floats, v: Floats, omega: Floats, e: Index, i: Index, j: Index
) -> float:
    """Rate of the material angle of edge e from node i to node j."""
    triple = (
        (t0[e, 1] * t[e, 2] - t0[e, 2] * t[e, 1]) * (v[j, 0] - v[i, 0])
        + (t0[e, 2] * t[e, 0] - t0[e, 0] * t[e, 2]) * (v[j, 1] - v[i, 1])
        + (t0[e, 0] * t[e, 1] - t0[e, 1] * t[e, 0]) * (v[j, 2] - v[i, 2])
    )
    cosine = t0[e, 0] * t[e, 0] + t0[e, 1] * t[e, 1] + t0[e, 2] * t[e, 2]
    rate: float = omega[e] + triple / (length[e] * (1.0 + cosine))
    return rate


def powers(
    a: Assembly, m: Model, bc: Boundary, v: Floats, omega: Floats, contacts: Contacts, w: Work
) -> tuple[float, float]:
    """External power and dissipated power [W] at the rates just computed.

    External power is that of forces, torques and held ends. Dissipation is v . M v and its like for spin:
    where nothing is held, drag balances the forces, so it is v . F; held nodes and turned edges matter
    only when they move.
    """
    force, held, pull = w.force, bc.held, bc.force
    torque, turned, moment = w.torque, bc.turned, bc.torque
    external = 0.0
    dissipated = 0.0
    moved = False
    for i in range(v.shape[0]):
        vx, vy, vz = v[i, 0], v[i, 1], v[i, 2]
        external += vx * pull[i, 0] + vy * pull[i, 1] + vz * pull[i, 2]
        if held[i]:
            moved = moved or vx != 0.0 or vy != 0.0 or vz != 0.0
        else:
            dissipated += vx * force[i, 0] + vy * force[i, 1] + vz * force[i, 2]
    spun = False
    for e in range(omega.shape[0]):
        external += omega[e] * moment[e]
        if turned[e]:
            spun = spun or omega[e] != 0.0
        else:
            dissipated += omega[e] * torque[e]
    if moved:
        lost = power_of_drag(a, m.eta_A, contacts, v, held) + power_of_skin(a, bc.skin, v, held)
        dissipated += lost
        external += lost
        for i in range(v.shape[0]):
            if held[i]:
                external -= v[i, 0] * force[i, 0] + v[i, 1] * force[i, 1] + v[i, 2] * force[i, 2]
    if spun:
        lost = _turning_power(a, m.eta_J, omega, turned, w)
        dissipated += lost
        external += lost
        for e in range(omega.shape[0]):
            external -= omega[e] * torque[e] if turned[e] else 0.0
    return external, dissipated


def _turning_power(a: Assembly, eta_J: float, omega: Floats, turned: Bools, w: Work) -> float:
    """Power [W] that turned edges spend on the damping of spin and on collision drag."""
    drag_torque, spin_weight, tangent = w.drag_torque, w.spin_weight, w.tangent
    hinges, hinge_length = a.hinges, a.hinge_length
    lost = 0.0
    for e in range(omega.shape[0]):
        lost += omega[e] * (spin_weight[e] * omega[e] - drag_torque[e]) if turned[e] else 0.0
    for k in range(hinges.shape[0]):
        p = hinges[k, 0]
        q = hinges[k, 1]
        rate = eta_J / hinge_length[k]
        c = tangent[p, 0] * tangent[q, 0] + tangent[p, 1] * tangent[q, 1] + tangent[p, 2] * tangent[q, 2]
        lost += rate * (omega[p] - c * omega[q]) * omega[p] if turned[p] else 0.0
        lost += rate * (omega[q] - c * omega[p]) * omega[q] if turned[q] else 0.0
    return lost


def energies(a: Assembly, m: Model, contacts: Contacts, w: Work, out: Floats) -> None:
    """Stretch, bend, twist and contact energy [J] into out (4,), at the forces just computed."""
    out[0] = stretch_energy(a, m.EA, w.length)
    out[1] = bend_energy(a, m.B, m.bend_present, w.length, w.tangent)
    out[2] = twist_energy(a, m.C, w.m)
    out[3] = contact_energy(a, m, w.length, w.tangent, contacts)


compile_kernels(__name__, inline=("_material_rate",), splice=("rates",), plain=("rate_work",))
