"""Exact second derivatives of stretch, bend and twist energies with respect to edges and their angles.

The energies are those of `elasticity`. They depend on nodes through edge vectors e_e = x_j - x_i alone,
so first and second derivatives are blocks of four unknowns per edge, (e, theta): one block on every edge
and one between the two edges of every hinge. Positions vary about time-parallel directors: the reference
director of an edge is carried along the great circle from its present tangent. In this gauge the Hessian
is symmetric; with t~ = (t_a + t_b)/chi and chi = 1 + t_a . t_b the reference twist has (Bergou et al.
2010)

    d2m/de_a2    = -(kb (t_a + t~)^T + (t_a + t~) kb^T) / 4 |e_a|^2        and b for a
    d2m/de_a de_b = (2/chi [t_a]x - kb t~^T) / 2 |e_a| |e_b|
"""

from __future__ import annotations

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Floats, Index
from torsade.assembly import Assembly
from torsade.rod.elasticity import bend_length


def elastic_derivatives(
    a: Assembly,
    EA: float,
    B: float,
    present: bool,
    length: Floats,
    tangent: Floats,
    moment: Floats,
    stiffness: Floats,
    gradient: Floats,
    own: Floats,
    beside: Floats,
) -> None:
    """Gradient (n_edges, 4) and Hessian blocks of E_s + E_b + E_t by the edges' (e, theta), overwritten.

    own (n_edges, 4, 4) are the blocks of edges; beside (n_hinges, 4, 4) those between edge a, rows, and
    edge b, columns. Every hinge has the twisting moment dE_t/dm (n_hinges,) [N m] and the stiffness
    d2E_t/dm2 (n_hinges,) [N m]: C m/lbar and C/lbar where angles are unknown, the given moment and none
    where they are eliminated. Edges without rest length do not stretch.
    """
    gradient[:] = 0.0
    own[:] = 0.0
    beside[:] = 0.0
    for e in range(length.shape[0]):
        if EA > 0.0 and a.rest_length[e] > 0.0:
            _add_stretch(EA, a.rest_length[e], length[e], tangent, e, gradient, own)
    pair = np.empty((5, 4))
    for k in range(a.hinges.shape[0]):
        p = a.hinges[k, 0]
        q = a.hinges[k, 1]
        lbar = bend_length(a.hinge_length[k], present, length[p], length[q])
        _hinge_vectors(tangent, p, q, length, pair)
        _add_bend(B, lbar, present, length, tangent, p, q, pair, gradient, own, beside[k])
        _add_twist(moment[k], stiffness[k], length, tangent, p, q, pair, gradient, own, beside[k])


def _add_stretch(
    EA: float, rest: float, length: float, tangent: Floats, e: Index, gradient: Floats, own: Floats
) -> None:
    """E_s of one edge: EA (|e|/l - 1) t and EA (t t^T/l + (1/l - 1/|e|) (1 - t t^T))."""
    pull = EA * (length / rest - 1.0)
    for c in range(3):
        gradient[e, c] += pull * tangent[e, c]
        own[e, c, c] += pull / length
        for d in range(3):
            own[e, c, d] += (EA / rest - pull / length) * tangent[e, c] * tangent[e, d]


def _hinge_vectors(tangent: Floats, p: Index, q: Index, length: Floats, pair: Floats) -> None:
    """Of the hinge between edges p and q, into the rows of pair (5, 4).

    dc/de_a and dc/de_b with c = t_a . t_b, the fourth of the first row being c; dm/d(e_a, theta_a) and
    dm/d(e_b, theta_b); t~.
    """
    ax, ay, az = tangent[p, 0], tangent[p, 1], tangent[p, 2]
    bx, by, bz = tangent[q, 0], tangent[q, 1], tangent[q, 2]
    c = ax * bx + ay * by + az * bz
    s = 1.0 / (1.0 + c)
    pair[2, 0] = s * (ay * bz - az * by)
    pair[2, 1] = s * (az * bx - ax * bz)
    pair[2, 2] = s * (ax * by - ay * bx)
    for d in range(3):
        pair[0, d] = (tangent[q, d] - c * tangent[p, d]) / length[p]
        pair[1, d] = (tangent[p, d] - c * tangent[q, d]) / length[q]
        pair[3, d] = pair[2, d] / length[q]
        pair[2, d] /= length[p]
        pair[4, d] = s * (tangent[p, d] + tangent[q, d])
    pair[0, 3] = c
    pair[2, 3] = -1.0
    pair[3, 3] = 1.0


def _add_bend(
    B: float,
    lbar: float,
    present: bool,
    length: Floats,
    tangent: Floats,
    p: Index,
    q: Index,
    pair: Floats,
    gradient: Floats,
    own: Floats,
    between: Floats,
) -> None:
    """E_b = 2 B (1 - c)/(1 + c)/lbar of one hinge."""
    c = pair[0, 3]
    s = 1.0 / (1.0 + c)
    first = -4.0 * B * s * s / lbar
    second = 8.0 * B * s * s * s / lbar
    ra, rb = 1.0 / length[p], 1.0 / length[q]
    energy = 2.0 * B * (1.0 - c) * s / lbar if present else 0.0
    ease = -0.5 / lbar if present else 0.0  # of 1/lbar by |e_a| or |e_b|, over 1/lbar
    for i in range(3):
        ca, cb, ti, tj = pair[0, i], pair[1, i], tangent[p, i], tangent[q, i]
        gradient[p, i] += first * ca + energy * ease * ti
        gradient[q, i] += first * cb + energy * ease * tj
        for j in range(3):
            da, db, ui, uj = pair[0, j], pair[1, j], tangent[p, j], tangent[q, j]
            same = 1.0 if i == j else 0.0
            pa, pb = same - ti * ui, same - tj * uj
            own[p, i, j] += second * ca * da - first * ra * (ca * ui + ti * da + c * ra * pa)
            own[q, i, j] += second * cb * db - first * rb * (cb * uj + tj * db + c * rb * pb)
            both = same - ti * ui - tj * uj + c * ti * uj
            between[i, j] += second * ca * db + first * ra * rb * both
            if present:
                fall = 2.0 * energy * ease * ease
                own[p, i, j] += first * ease * (ca * ui + ti * da) + energy * ease * ra * pa + fall * ti * ui
                own[q, i, j] += first * ease * (cb * uj + tj * db) + energy * ease * rb * pb + fall * tj * uj
                between[i, j] += first * ease * (ca * uj + ti * db) + fall * ti * uj


def _add_twist(
    moment: float,
    stiffness: float,
    length: Floats,
    tangent: Floats,
    p: Index,
    q: Index,
    pair: Floats,
    gradient: Floats,
    own: Floats,
    between: Floats,
) -> None:
    """E_t of one hinge, of which moment and stiffness are the first and second derivative by m."""
    ra, rb = 1.0 / length[p], 1.0 / length[q]
    chi = 1.0 + pair[0, 3]
    for i in range(4):
        gradient[p, i] += moment * pair[2, i]
        gradient[q, i] += moment * pair[3, i]
        for j in range(4):
            own[p, i, j] += stiffness * pair[2, i] * pair[2, j]
            own[q, i, j] += stiffness * pair[3, i] * pair[3, j]
            between[i, j] += stiffness * pair[2, i] * pair[3, j]
    for i in range(3):
        for j in range(3):
            wa, wb = tangent[p, j] + pair[4, j], tangent[q, j] + pair[4, j]
            va, vb = tangent[p, i] + pair[4, i], tangent[q, i] + pair[4, i]
            own[p, i, j] -= 0.5 * moment * ra * (pair[2, i] * wa + va * pair[2, j])
            own[q, i, j] -= 0.5 * moment * rb * (pair[3, i] * wb + vb * pair[3, j])
            between[i, j] -= moment * rb * pair[2, i] * pair[4, j]
    turn = moment * ra * rb / chi
    between[0, 1] -= turn * tangent[p, 2]
    between[0, 2] += turn * tangent[p, 1]
    between[1, 0] += turn * tangent[p, 2]
    between[1, 2] -= turn * tangent[p, 0]
    between[2, 0] -= turn * tangent[p, 1]
    between[2, 1] += turn * tangent[p, 0]


compile_kernels(__name__, owning=("elastic_derivatives",))
