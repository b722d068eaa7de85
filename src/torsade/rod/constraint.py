"""Inextensible fibers: impulses along the edges that keep their lengths, by one tridiagonal solve per fiber.

An edge e from node i to node j with tangent t_e pulls its nodes together by an impulse p_e [N s]: node i
moves by +w_i t_e p_e, node j by -w_j t_e p_e, with w the inverse masses (0 where a node is held). What all
edges lose in length by all impulses is a matrix, mass-weighted and symmetric,

    A_ee = w_i + w_j,     A_e,e+1 = -w_j t_e . t_e+1     (j the node between),

tridiagonal along an open fiber. It is factorised once per state, as L D L^T. Velocities are projected by one
solve with it. Positions ask for Newton's method, since lengths are not linear in them: with the impulses
along the tangents at the start of the step, as time-reversible schemes want them (RATTLE, Andersen 1983), the
same factor serves all iterations, and the error falls by the share of an edge that the nodes move in the
step.

An edge between two held nodes keeps what length it has. Where edges pull against each other in vain, as
those of a straight fiber between held ends do, the last of them is left out.
"""

from __future__ import annotations

from torsade._compile import compile_kernels
from torsade.arrays import Floats
from torsade.assembly import Assembly

SINGULAR = 1e-13
"""A pivot smaller than this share of its diagonal is that of an edge whose length others hold already."""


def factor_constraint(a: Assembly, w: Floats, tangent: Floats, below: Floats, inverse: Floats) -> None:
    """Factorise A at the tangents (n_edges, 3), with inverse masses w (n_nodes,) [1/kg].

    below (n_edges,) gets the entry of L that couples an edge with the one before it, inverse (n_edges,) the
    inverse pivots [kg], 0 for edges that cannot change.
    """
    edges, edge_start = a.edges, a.edge_start
    for f in range(edge_start.shape[0] - 1):
        first = edge_start[f]
        for e in range(first, edge_start[f + 1]):
            wi = w[edges[e, 0]]
            diagonal = wi + w[edges[e, 1]]
            pivot = diagonal
            below[e] = 0.0
            if e > first:
                cosine = (
                    tangent[e, 0] * tangent[e - 1, 0]
                    + tangent[e, 1] * tangent[e - 1, 1]
                    + tangent[e, 2] * tangent[e - 1, 2]
                )
                coupling = -wi * cosine
                below[e] = coupling * inverse[e - 1]
                pivot -= coupling * below[e]
            inverse[e] = 1.0 / pivot if pivot > SINGULAR * diagonal else 0.0


def solve_constraint(a: Assembly, below: Floats, inverse: Floats, p: Floats) -> None:
    """Solve A p = loss with the factors of `factor_constraint`; p (n_edges,) holds the loss and gets p."""
    edge_start = a.edge_start
    for f in range(edge_start.shape[0] - 1):
        first = edge_start[f]
        last = edge_start[f + 1] - 1
        for e in range(first + 1, last + 1):
            p[e] -= below[e] * p[e - 1]
        p[last] *= inverse[last]
        for e in range(last - 1, first - 1, -1):
            p[e] = p[e] * inverse[e] - below[e + 1] * p[e + 1]


def add_impulses(a: Assembly, w: Floats, tangent: Floats, p: Floats, scale: float, out: Floats) -> None:
    """Add what impulses p (n_edges,) along the tangents (n_edges, 3) do, times scale, to out (n_nodes, 3)."""
    edges = a.edges
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        wi = w[i] * scale * p[e]
        wj = w[j] * scale * p[e]
        for c in range(3):
            out[i, c] += wi * tangent[e, c]
            out[j, c] -= wj * tangent[e, c]


def lengthening(a: Assembly, w: Floats, x: Floats, over: Floats) -> float:
    """By how much edges of nodes x (n_nodes, 3) [m] are too long, over (n_edges,) [m]; the largest share.

    (|e|^2 - l^2)/2l, which is |e| - l to first order; 0 for an edge between held nodes.
    """
    edges, rest_length = a.edges, a.rest_length
    worst = 0.0
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        over[e] = 0.0
        if w[i] + w[j] > 0.0:
            dx = x[j, 0] - x[i, 0]
            dy = x[j, 1] - x[i, 1]
            dz = x[j, 2] - x[i, 2]
            l = rest_length[e]
            over[e] = 0.5 * ((dx * dx + dy * dy + dz * dz) / l - l)
            worst = max(worst, abs(over[e]) / l)
    return worst


def project_positions(
    a: Assembly,
    w: Floats,
    tangent: Floats,
    below: Floats,
    inverse: Floats,
    tolerance: float,
    most: int,
    x: Floats,
    p: Floats,
    pull: Floats,
) -> int:
    """Move nodes x (n_nodes, 3) [m] until all edges have their lengths; returns the iterations it took.

    Moves are mass-weighted and along the given tangents, whose factors below and inverse are. pull (n_edges,)
    gets what all edges pulled [kg m], p (n_edges,) is scratch. Returns -1 when an edge is off by more than
    tolerance times its length after `most` iterations.
    """
    for e in range(pull.shape[0]):
        pull[e] = 0.0
    for iteration in range(most):
        if lengthening(a, w, x, p) <= tolerance:
            return iteration
        solve_constraint(a, below, inverse, p)
        add_impulses(a, w, tangent, p, 1.0, x)
        for e in range(pull.shape[0]):
            pull[e] += p[e]
    return -1


def project_velocities(
    a: Assembly, w: Floats, tangent: Floats, below: Floats, inverse: Floats, v: Floats, p: Floats
) -> None:
    """Take from velocities v (n_nodes, 3) [m/s] what would change edge lengths; p (n_edges,) is scratch."""
    edges = a.edges
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        p[e] = (
            tangent[e, 0] * (v[j, 0] - v[i, 0])
            + tangent[e, 1] * (v[j, 1] - v[i, 1])
            + tangent[e, 2] * (v[j, 2] - v[i, 2])
        )
    solve_constraint(a, below, inverse, p)
    add_impulses(a, w, tangent, p, 1.0, v)


compile_kernels(__name__)
