"""Spins of edges in overdamped motion: a tridiagonal system along every fiber, a ring where it is closed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import ONE, Bools, Floats, Index
from torsade.assembly import Assembly
from torsade.rod.factor import HELD


class SpinWork(NamedTuple):
    """Scratch arrays of the spin solve, each (n_edges,)."""

    diagonal: Floats
    upper: Floats
    factor: Floats
    border: Floats


def spin_work(n_edges: Index) -> SpinWork:
    """Scratch arrays for n_edges edges."""
    return SpinWork(np.empty(n_edges), np.empty(n_edges), np.empty(n_edges), np.empty(n_edges))


def solve_spin(
    a: Assembly,
    eta_J: float,
    tangent: Floats,
    torque: Floats,
    spin_weight: Floats,
    fixed: Bools,
    prescribed: Floats,
    omega: Floats,
    work: SpinWork,
) -> None:
    """Spins omega (n_edges,) [rad/s] that balance torque (n_edges,) [N m] by internal damping.

    On edge e: sum over its neighbours f of eta J (omega_e - omega_f t_e . t_f)/lbar, plus spin_weight_e
    omega_e, equals the torque (thesis 4.11). Edges with fixed (n_edges,) turn as prescribed. A fiber
    that nothing holds may spin as a whole; a term of 1e-12 of the damping picks the spin at rest.
    """
    edge_start, hinge_start = a.edge_start, a.hinge_start
    diagonal, upper = work.diagonal, work.upper
    _spin_matrix(a, eta_J, tangent, spin_weight, diagonal, upper)
    for e in range(omega.shape[0]):
        if fixed[e]:
            diagonal[e] = HELD * (diagonal[e] if diagonal[e] > 0.0 else 1.0)
        omega[e] = diagonal[e] * prescribed[e] if fixed[e] else torque[e]
    for f in range(edge_start.shape[0] - 1):
        first = edge_start[f]
        last = edge_start[f + 1]
        if last == first:  # what has no edges does not spin
            continue
        if last - first == hinge_start[f + 1] - hinge_start[f]:
            _solve_ring(first, last, diagonal, upper, work.factor, work.border, omega)
        else:
            _eliminate_chain(first, last, diagonal, upper, work.factor, omega)
            _substitute_chain(first, last, upper, work.factor, omega)
    for e in range(omega.shape[0]):
        if fixed[e]:
            omega[e] = prescribed[e]


def _spin_matrix(
    a: Assembly, eta_J: float, t: Floats, spin_weight: Floats, diagonal: Floats, upper: Floats
) -> None:
    """Diagonal of the matrix of spins, and upper, which couples an edge to the one after it."""
    edge_start, hinge_start, lbar = a.edge_start, a.hinge_start, a.hinge_length
    for f in range(edge_start.shape[0] - 1):
        first, n = edge_start[f], edge_start[f + 1] - edge_start[f]
        if n == 0:
            continue
        joints = hinge_start[f + 1] - hinge_start[f]
        after = hinge_start[f] + joints - n + 1
        for k in range(n - 1):
            e = np.uintp(first + k)
            q = e + ONE
            c = t[e, 0] * t[q, 0] + t[e, 1] * t[q, 1] + t[e, 2] * t[q, 2]
            upper[e] = -eta_J / lbar[np.uintp(after + k)] * c
        for k in range(1, n - 1):
            e, h = np.uintp(first + k), np.uintp(after + k)
            diagonal[e] = spin_weight[e] + (eta_J / lbar[h - ONE] + eta_J / lbar[h]) * (1.0 + 1e-12)
        last = first + n - 1
        diagonal[first], diagonal[last], upper[last] = spin_weight[first], spin_weight[last], 0.0
        if n > 1:
            diagonal[first] += eta_J / lbar[after] * (1.0 + 1e-12)
            diagonal[last] += eta_J / lbar[after + n - 2] * (1.0 + 1e-12)
        if joints == n:
            w = eta_J / lbar[hinge_start[f]]
            diagonal[first] += w * (1.0 + 1e-12)
            diagonal[last] += w * (1.0 + 1e-12)
            c = t[first, 0] * t[last, 0] + t[first, 1] * t[last, 1] + t[first, 2] * t[last, 2]
            upper[last] = -w * c


def _eliminate_chain(
    first: Index, last: Index, diagonal: Floats, upper: Floats, factor: Floats, rhs: Floats
) -> None:
    """Eliminate edges first..last-1 of a symmetric tridiagonal system from both ends towards the middle.

    Two recurrences that do not wait for each other take half the time of one.
    """
    middle = (first + last) // 2
    left = 0.0
    right = 0.0
    for s in range(middle - first):
        e = first + s
        factor[e] = 1.0 / (diagonal[e] - left)
        share = upper[e] * factor[e]
        left = upper[e] * share
        rhs[e + 1] -= share * rhs[e]
        g = last - 1 - s
        if g > middle:
            factor[g] = 1.0 / (diagonal[g] - right)
            share = upper[g - 1] * factor[g]
            right = upper[g - 1] * share
            rhs[g - 1] -= share * rhs[g]
    pivot = diagonal[middle] - left - right
    factor[middle] = 1.0 / pivot if pivot > 0.0 else 0.0


def _carry_chain(first: Index, last: Index, upper: Floats, factor: Floats, rhs: Floats) -> None:
    """Eliminate another right side, with factors of `_eliminate_chain`."""
    middle = (first + last) // 2
    for s in range(middle - first):
        e = first + s
        rhs[e + 1] -= upper[e] * factor[e] * rhs[e]
        g = last - 1 - s
        if g > middle:
            rhs[g - 1] -= upper[g - 1] * factor[g] * rhs[g]


def _substitute_chain(first: Index, last: Index, upper: Floats, factor: Floats, rhs: Floats) -> None:
    """Replace what is left of a right side by the solution, from the middle to both ends."""
    middle = (first + last) // 2
    rhs[middle] *= factor[middle]
    for s in range(middle - first - 1, -1, -1):
        e = first + s
        rhs[e] = (rhs[e] - upper[e] * rhs[e + 1]) * factor[e]
        g = last - 1 - s
        if g > middle:
            rhs[g] = (rhs[g] - upper[g - 1] * rhs[g - 1]) * factor[g]


def _solve_ring(
    first: Index,
    last: Index,
    diagonal: Floats,
    upper: Floats,
    factor: Floats,
    border: Floats,
    omega: Floats,
) -> None:
    """Solve one closed fiber's system in place: a chain whose last edge is coupled to its first."""
    seam = upper[last - 1]
    gamma = -diagonal[first]
    diagonal[first] -= gamma
    diagonal[last - 1] -= seam * seam / gamma
    _eliminate_chain(first, last, diagonal, upper, factor, omega)
    _substitute_chain(first, last, upper, factor, omega)
    for e in range(first, last):
        border[e] = 0.0
    border[first] = gamma
    border[last - 1] = seam
    _carry_chain(first, last, upper, factor, border)
    _substitute_chain(first, last, upper, factor, border)
    ratio = seam / gamma
    s = omega[first] + ratio * omega[last - 1]
    s /= 1.0 + border[first] + ratio * border[last - 1]
    for e in range(first, last):
        omega[e] -= s * border[e]


compile_kernels(__name__, plain=("spin_work",))
