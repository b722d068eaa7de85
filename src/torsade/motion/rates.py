"""Velocities and spins of overdamped fibers: forces in, one linear solve, rates out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade._compile import compile_kernels
from torsade.rod.contact import (
    add_contact_forces,
    add_drag_torques,
    contact_energy,
    find_contacts,
    find_drag,
)
from torsade.rod.damping import (
    MobilityWork,
    SpinWork,
    apply_drag,
    mobility_work,
    solve_mobility,
    solve_spin,
    spin_work,
)
from torsade.rod.elasticity import (
    add_elastic_forces,
    bend_energy,
    hinge_twist,
    stretch_energy,
    twist_energy,
)
from torsade.rod.kinematics import edge_geometry, reference_twist_change
from torsade.rod.neighbours import edge_midpoints

OK = 0
LOOSE = 1
UNSOLVED = 2


class Work(NamedTuple):
    """Scratch of one evaluation of the rates: per edge, per hinge and per node."""

    length: NDArray[np.float64]
    tangent: NDArray[np.float64]
    mid: NDArray[np.float64]
    torque: NDArray[np.float64]
    drag_torque: NDArray[np.float64]
    spin_weight: NDArray[np.float64]
    m: NDArray[np.float64]
    change: NDArray[np.float64]
    force: NDArray[np.float64]
    held: NDArray[np.bool_]
    component: NDArray[np.int64]
    iterations: NDArray[np.int64]
    mobility: MobilityWork
    spin: SpinWork


def rate_work(a):
    """Scratch for an assembly."""
    n = a.node_length.shape[0]
    n_edges = a.edges.shape[0]
    n_hinges = a.hinges.shape[0]
    return Work(
        np.empty(n_edges),
        np.empty((n_edges, 3)),
        np.empty((n_edges, 3)),
        np.empty(n_edges),
        np.empty(n_edges),
        np.empty(n_edges),
        np.empty(n_hinges),
        np.empty(n_hinges),
        np.empty((n, 3)),
        np.empty(n, np.bool_),
        np.empty(a.closed.shape[0], np.int64),
        np.zeros(2, np.int64),
        mobility_work(n, n_edges),
        spin_work(n_edges),
    )


def forces(a, m, bc, x, theta, base_tangent, base_twist, contacts, w):
    """Total force and elastic plus external torque at nodes x and material angles theta, into w.

    base_tangent (n_edges, 3) and base_twist (n_hinges,) are the tangents and reference twists of the
    last completed step, from which the frames are transported.
    """
    edge_geometry(x, a.edges, w.length, w.tangent)
    reference_twist_change(base_tangent, w.tangent, a.hinges, w.change)
    for k in range(w.change.shape[0]):
        w.change[k] += base_twist[k]
    hinge_twist(theta, w.change, a.hinges, w.m)
    w.force[:] = bc.force
    w.torque[:] = bc.torque
    add_elastic_forces(a, m.EA, m.B, m.C, m.bend_present, w.length, w.tangent, w.m, w.force, w.torque)
    edge_midpoints(x, a.edges, w.mid)
    find_contacts(m, w.mid, contacts)
    add_contact_forces(a, m, w.length, w.tangent, contacts, w.force)


def _label_components(a, bc, contacts, component):
    """Label fibers that contacts join into bodies: component[f] is the smallest fiber of f's body."""
    for f in range(component.shape[0]):
        component[f] = f
    if component.shape[0] == 1:
        return
    for k in range(contacts.count[0]):
        p = component[a.edge_fiber[contacts.edges[k, 0]]]
        q = component[a.edge_fiber[contacts.edges[k, 1]]]
        if p != q:
            low = min(p, q)
            high = max(p, q)
            for f in range(component.shape[0]):
                if component[f] == high:
                    component[f] = low


def hold_bodies(a, bc, contacts, held, component):
    """Mark the held nodes, and ground one node of every body that nothing holds.

    Returns OK, or LOOSE when such a body carries a net external force: nothing resists it, so its
    velocity is unbounded (two ropes that have slipped apart).
    """
    held[:] = bc.held
    _label_components(a, bc, contacts, component)
    for b in range(component.shape[0]):
        if component[b] != b:
            continue
        anchored = False
        fx = 0.0
        fy = 0.0
        fz = 0.0
        size = 0.0
        for f in range(b, component.shape[0]):
            if component[f] == b:
                for i in range(a.node_start[f], a.node_start[f + 1]):
                    anchored = anchored or bc.held[i]
                    fx += bc.force[i, 0]
                    fy += bc.force[i, 1]
                    fz += bc.force[i, 2]
                    size += abs(bc.force[i, 0]) + abs(bc.force[i, 1]) + abs(bc.force[i, 2])
        if not anchored:
            if abs(fx) + abs(fy) + abs(fz) > 1e-9 * size:
                return LOOSE
            held[a.node_start[b]] = True
    return OK


def _ground_guess(a, bc, v, held, component):
    """Make the starting guess agree with held nodes; bodies that float move with their grounded node."""
    for f in range(component.shape[0]):
        g = a.node_start[component[f]]
        floating = held[g] and not bc.held[g]
        vx = v[g, 0]
        vy = v[g, 1]
        vz = v[g, 2]
        for i in range(a.node_start[f], a.node_start[f + 1]):
            if floating:
                v[i, 0] -= vx
                v[i, 1] -= vy
                v[i, 2] -= vz
            if bc.held[i]:
                v[i] = bc.velocity[i]


def _centre_floating(a, bc, v, held, component):
    """Give every floating body zero mean velocity over its length (its centre stays)."""
    for b in range(component.shape[0]):
        g = a.node_start[b]
        if component[b] == b and held[g] and not bc.held[g]:
            sx = 0.0
            sy = 0.0
            sz = 0.0
            total = 0.0
            for f in range(b, component.shape[0]):
                if component[f] == b:
                    for i in range(a.node_start[f], a.node_start[f + 1]):
                        weight = a.node_length[i]
                        total += weight
                        sx += weight * v[i, 0]
                        sy += weight * v[i, 1]
                        sz += weight * v[i, 2]
            for f in range(b, component.shape[0]):
                if component[f] == b:
                    for i in range(a.node_start[f], a.node_start[f + 1]):
                        v[i, 0] -= sx / total
                        v[i, 1] -= sy / total
                        v[i, 2] -= sz / total


def rates(a, m, bc, x, theta, base_tangent, base_twist, contacts, tolerance, v, omega, angular, w):
    """Velocities v (n_nodes, 3), spins omega and rates of the material angles angular (n_edges,).

    v holds the starting guess. The material angle is measured from a director transported straight
    from the base tangent t0, which itself turns about t by -(t0 x t) . dt/dt / (1 + t0 . t).
    Returns OK, LOOSE (see hold_bodies) or UNSOLVED.
    """
    forces(a, m, bc, x, theta, base_tangent, base_twist, contacts, w)
    find_drag(a, m, x, w.length, w.mid, contacts)
    if hold_bodies(a, bc, contacts, w.held, w.component) != OK:
        return LOOSE
    _ground_guess(a, bc, v, w.held, w.component)
    iterations = solve_mobility(a, m.eta_A, contacts, w.force, w.held, tolerance, v, w.mobility)
    if iterations < 0:
        return UNSOLVED
    w.iterations[0] += 1
    w.iterations[1] += iterations
    _centre_floating(a, bc, v, w.held, w.component)
    w.drag_torque[:] = 0.0
    w.spin_weight[:] = 0.0
    if m.eta_f_J > 0.0:
        add_drag_torques(a, m, v, w.tangent, contacts, w.drag_torque, w.spin_weight)
    for e in range(omega.shape[0]):
        angular[e] = w.torque[e] + w.drag_torque[e]
    solve_spin(a, m.eta_J, w.tangent, angular, w.spin_weight, bc.turned, bc.spin, omega, w.spin)
    for e in range(omega.shape[0]):
        t0 = base_tangent[e]
        t = w.tangent[e]
        i = a.edges[e, 0]
        j = a.edges[e, 1]
        triple = (
            (t0[1] * t[2] - t0[2] * t[1]) * (v[j, 0] - v[i, 0])
            + (t0[2] * t[0] - t0[0] * t[2]) * (v[j, 1] - v[i, 1])
            + (t0[0] * t[1] - t0[1] * t[0]) * (v[j, 2] - v[i, 2])
        )
        cosine = t0[0] * t[0] + t0[1] * t[1] + t0[2] * t[2]
        angular[e] = omega[e] + triple / (w.length[e] * (1.0 + cosine))
    return OK


def powers(a, m, bc, v, omega, contacts, w):
    """External power and dissipated power [W] at the rates just computed.

    External power is that of forces, torques and held ends. Dissipation is v . M v, the damping of spin
    and what the collision drag takes from it.
    """
    apply_drag(a, m.eta_A, contacts, v, w.mobility.q)
    external = 0.0
    dissipated = 0.0
    for i in range(v.shape[0]):
        for c in range(3):
            drag = w.mobility.q[i, c]
            dissipated += v[i, c] * drag
            if bc.held[i]:
                external += v[i, c] * (drag - w.force[i, c] + bc.force[i, c])
            else:
                external += v[i, c] * bc.force[i, c]
    for e in range(omega.shape[0]):
        dissipated += omega[e] * (w.spin_weight[e] * omega[e] - w.drag_torque[e])
        external += omega[e] * bc.torque[e]
        if bc.turned[e]:
            internal = w.torque[e] + w.drag_torque[e]
            external += omega[e] * (w.spin_weight[e] * omega[e] - internal)
    for k in range(a.hinges.shape[0]):
        p = a.hinges[k, 0]
        q = a.hinges[k, 1]
        rate = m.eta_J / a.hinge_length[k]
        c = (
            w.tangent[p, 0] * w.tangent[q, 0]
            + w.tangent[p, 1] * w.tangent[q, 1]
            + w.tangent[p, 2] * w.tangent[q, 2]
        )
        on_p = rate * (omega[p] - c * omega[q])
        on_q = rate * (omega[q] - c * omega[p])
        dissipated += omega[p] * on_p + omega[q] * on_q
        if bc.turned[p]:
            external += omega[p] * on_p
        if bc.turned[q]:
            external += omega[q] * on_q
    return external, dissipated


def energies(a, m, contacts, w, out):
    """Stretch, bend, twist and contact energy [J] into out (4,), at the forces just computed."""
    out[0] = stretch_energy(a, m.EA, w.length)
    out[1] = bend_energy(a, m.B, m.bend_present, w.length, w.tangent)
    out[2] = twist_energy(a, m.C, w.m)
    out[3] = contact_energy(a, m, w.length, w.tangent, contacts)


compile_kernels(__name__)
