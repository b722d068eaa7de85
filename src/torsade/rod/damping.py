"""Internal damping and the two linear systems of overdamped motion.

Node velocities solve M v = F, where M is the graph Laplacian of internal damping (weight eta A / l on
every edge) plus collision drag (thesis 4.8, 4.11). It is symmetric and positive semi-definite; its null
space is removed by fixing nodes. The solver is a conjugate gradient method, warm-started and
preconditioned by the tridiagonal part of M along each fiber. Spins solve a tridiagonal system.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade._compile import compile_kernels


class MobilityWork(NamedTuple):
    """Scratch arrays of the mobility solve: diagonals and factors (n,), vectors (n_nodes, 3)."""

    diagonal: NDArray[np.float64]
    coupling: NDArray[np.float64]
    inverse: NDArray[np.float64]
    lower: NDArray[np.float64]
    r: NDArray[np.float64]
    z: NDArray[np.float64]
    p: NDArray[np.float64]
    q: NDArray[np.float64]


def mobility_work(n_nodes, n_edges):
    """Scratch arrays for n_nodes nodes and n_edges edges."""
    return MobilityWork(
        np.empty(n_nodes),
        np.empty(n_edges),
        np.empty(n_nodes),
        np.empty(n_nodes),
        np.empty((n_nodes, 3)),
        np.empty((n_nodes, 3)),
        np.empty((n_nodes, 3)),
        np.empty((n_nodes, 3)),
    )


def apply_drag(a, eta_A, contacts, v, out):
    """out = M v [N], without regard to fixed nodes; v, out (n_nodes, 3)."""
    out[:] = 0.0
    for e in range(a.edges.shape[0]):
        i = a.edges[e, 0]
        j = a.edges[e, 1]
        w = eta_A / a.rest_length[e]
        for c in range(3):
            f = w * (v[i, c] - v[j, c])
            out[i, c] += f
            out[j, c] -= f
    for k in range(contacts.count[1]):
        i0 = contacts.drag_nodes[k, 0]
        i1 = contacts.drag_nodes[k, 1]
        j0 = contacts.drag_nodes[k, 2]
        j1 = contacts.drag_nodes[k, 3]
        w = 0.25 * contacts.drag_weight[k]
        for c in range(3):
            f = w * (v[i0, c] + v[i1, c] - v[j0, c] - v[j1, c])
            out[i0, c] += f
            out[i1, c] += f
            out[j0, c] -= f
            out[j1, c] -= f


def _tridiagonal_part(a, eta_A, contacts, work):
    """Diagonal of M and its coupling along each edge."""
    work.diagonal[:] = 0.0
    for e in range(a.edges.shape[0]):
        w = eta_A / a.rest_length[e]
        work.diagonal[a.edges[e, 0]] += w
        work.diagonal[a.edges[e, 1]] += w
        work.coupling[e] = -w
    for k in range(contacts.count[1]):
        w = 0.25 * contacts.drag_weight[k]
        for half in range(2):
            i = contacts.drag_nodes[k, 2 * half]
            j = contacts.drag_nodes[k, 2 * half + 1]
            if i == j:
                work.diagonal[i] += 4.0 * w
            else:
                work.diagonal[i] += w
                work.diagonal[j] += w
                work.coupling[contacts.edges[k, half]] += w


def _factorise(a, fixed, work):
    """L D L^T of the tridiagonal part, fiber by fiber; rows of fixed nodes are the identity."""
    for f in range(a.closed.shape[0]):
        first = a.node_start[f]
        to_edge = a.edge_start[f] - first
        d = 1.0 if fixed[first] else work.diagonal[first]
        work.inverse[first] = 1.0 / d
        work.lower[first] = 0.0
        for i in range(first + 1, a.node_start[f + 1]):
            if fixed[i]:
                work.lower[i] = 0.0
                work.inverse[i] = 1.0
            else:
                c = 0.0 if fixed[i - 1] else work.coupling[i - 1 + to_edge]
                m = c * work.inverse[i - 1]
                work.lower[i] = m
                work.inverse[i] = 1.0 / (work.diagonal[i] - m * c)


def _precondition(a, fixed, work):
    """z = P^-1 r with the factors of the tridiagonal part; zero on fixed nodes."""
    r = work.r
    z = work.z
    for f in range(a.closed.shape[0]):
        first = a.node_start[f]
        last = a.node_start[f + 1] - 1
        for c in range(3):
            z[first, c] = r[first, c]
        for i in range(first + 1, last + 1):
            m = work.lower[i]
            for c in range(3):
                z[i, c] = r[i, c] - m * z[i - 1, c]
        for c in range(3):
            z[last, c] *= work.inverse[last]
        for i in range(last - 1, first - 1, -1):
            m = work.lower[i + 1]
            s = work.inverse[i]
            for c in range(3):
                z[i, c] = z[i, c] * s - m * z[i + 1, c]


def _dot(a, b):
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i, 0] * b[i, 0] + a[i, 1] * b[i, 1] + a[i, 2] * b[i, 2]
    return total


def solve_mobility(a, eta_A, contacts, force, fixed, tolerance, v, work):
    """Solve M v = F for the nodes that are not fixed; v holds the guess, and what fixed nodes do.

    Stops when the error, in the norm of the dissipated power v . M v, is below tolerance relative to
    the solution. force, v (n_nodes, 3), fixed (n_nodes,) bool. Returns the number of iterations, or -1
    when they did not suffice.
    """
    n = force.shape[0]
    _tridiagonal_part(a, eta_A, contacts, work)
    _factorise(a, fixed, work)
    apply_drag(a, eta_A, contacts, v, work.q)
    guess_power = abs(_dot(v, work.q))
    for i in range(n):
        for c in range(3):
            work.r[i, c] = 0.0 if fixed[i] else force[i, c] - work.q[i, c]
    _precondition(a, fixed, work)
    work.p[:] = work.z
    rz = _dot(work.r, work.z)
    for iteration in range(20 * n + 100):
        if rz <= tolerance * tolerance * max(abs(_dot(v, force)), guess_power) or rz < 1e-300:
            return iteration
        apply_drag(a, eta_A, contacts, work.p, work.q)
        for i in range(n):
            if fixed[i]:
                work.q[i] = 0.0
        alpha = rz / _dot(work.p, work.q)
        for i in range(n):
            for c in range(3):
                v[i, c] += alpha * work.p[i, c]
                work.r[i, c] -= alpha * work.q[i, c]
        _precondition(a, fixed, work)
        previous = rz
        rz = _dot(work.r, work.z)
        beta = rz / previous
        for i in range(n):
            for c in range(3):
                work.p[i, c] = work.z[i, c] + beta * work.p[i, c]
    return -1


class SpinWork(NamedTuple):
    """Scratch arrays of the spin solve, each (n_edges,)."""

    diagonal: NDArray[np.float64]
    upper: NDArray[np.float64]
    factor: NDArray[np.float64]
    border: NDArray[np.float64]


def spin_work(n_edges):
    """Scratch arrays for n_edges edges."""
    return SpinWork(np.empty(n_edges), np.empty(n_edges), np.empty(n_edges), np.empty(n_edges))


def _thomas(first, last, work, rhs):
    """Solve the symmetric tridiagonal system of edges first..last-1 in place; factor, then sweep."""
    for e in range(first + 1, last):
        rhs[e] -= work.upper[e - 1] * work.factor[e - 1] * rhs[e - 1]
    rhs[last - 1] *= work.factor[last - 1]
    for e in range(last - 2, first - 1, -1):
        rhs[e] = (rhs[e] - work.upper[e] * rhs[e + 1]) * work.factor[e]


def solve_spin(a, eta_J, tangent, torque, spin_weight, fixed, prescribed, omega, work):
    """Spins omega (n_edges,) [rad/s] that balance torque (n_edges,) [N m] by internal damping.

    On edge e: sum over its neighbours f of eta J (omega_e - omega_f t_e . t_f)/lbar, plus spin_weight_e
    omega_e, equals the torque (thesis 4.11). Edges with fixed (n_edges,) turn as prescribed. A fiber
    that nothing holds may spin as a whole; a term of 1e-12 of the damping picks the spin at rest.
    """
    for f in range(a.closed.shape[0]):
        first = a.edge_start[f]
        last = a.edge_start[f + 1]
        for e in range(first, last):
            work.diagonal[e] = spin_weight[e]
            work.upper[e] = 0.0
            omega[e] = torque[e]
        seam = 0.0
        for k in range(a.hinge_start[f], a.hinge_start[f + 1]):
            p = a.hinges[k, 0]
            q = a.hinges[k, 1]
            w = eta_J / a.hinge_length[k]
            cosine = (
                tangent[p, 0] * tangent[q, 0] + tangent[p, 1] * tangent[q, 1] + tangent[p, 2] * tangent[q, 2]
            )
            work.diagonal[p] += w * (1.0 + 1e-12)
            work.diagonal[q] += w * (1.0 + 1e-12)
            if q == p + 1:
                work.upper[p] -= w * cosine
            else:
                seam -= w * cosine
        if seam != 0.0 and (fixed[first] or fixed[last - 1]):
            omega[last - 1] -= seam * prescribed[first] if fixed[first] else 0.0
            omega[first] -= seam * prescribed[last - 1] if fixed[last - 1] else 0.0
            seam = 0.0
        for e in range(first, last):
            if fixed[e]:
                work.diagonal[e] = 1.0
                omega[e] = prescribed[e]
                if e > first:
                    omega[e - 1] -= work.upper[e - 1] * prescribed[e]
                    work.upper[e - 1] = 0.0
                if e < last - 1:
                    omega[e + 1] -= work.upper[e] * prescribed[e]
                    work.upper[e] = 0.0
        _solve_chain(first, last, seam, work, omega)


def _solve_chain(first, last, seam, work, omega):
    """Solve one fiber's system in place; seam couples its last edge to its first (0 if open)."""
    if last - first == 1:
        omega[first] = omega[first] / work.diagonal[first] if work.diagonal[first] > 0.0 else 0.0
        return
    gamma = -work.diagonal[first] if seam != 0.0 else 0.0
    if seam != 0.0:
        work.diagonal[first] -= gamma
        work.diagonal[last - 1] -= seam * seam / gamma
    work.factor[first] = 1.0 / work.diagonal[first]
    for e in range(first + 1, last):
        d = work.diagonal[e] - work.upper[e - 1] * work.upper[e - 1] * work.factor[e - 1]
        work.factor[e] = 1.0 / d
    _thomas(first, last, work, omega)
    if seam != 0.0:
        for e in range(first, last):
            work.border[e] = 0.0
        work.border[first] = gamma
        work.border[last - 1] = seam
        _thomas(first, last, work, work.border)
        ratio = seam / gamma
        s = omega[first] + ratio * omega[last - 1]
        s /= 1.0 + work.border[first] + ratio * work.border[last - 1]
        for e in range(first, last):
            omega[e] -= s * work.border[e]


compile_kernels(__name__)
