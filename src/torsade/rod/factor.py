"""Direct solution of the mobility system: sparse L D L^T with everything but arithmetic done beforehand.

A pattern holds every pair of edges in contact or nearly so. For a pattern, nodes are put in an order of
elimination, and all places that a factorisation updates are written down one after the other, so that
factorising is one pass without searching. A pattern serves until a pair outside of it touches.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import ONE, Bools, Floats, Index, Ints, Slots
from torsade.assembly import Assembly
from torsade.rod.contact import Contacts
from torsade.rod.ordering import couplings, minimum_degree

MARGIN = 1.05
"""Pairs nearer than so many diameters belong to the pattern."""

WORTH = 1000.0
"""Operations per node up to which a direct solve is faster than an iterative one."""

HELD = 1e30
"""Held nodes resist so many times more than they would: exact to round-off, without another case."""

UNMADE = 0
MADE = 1
DENSE = 2


class Factor(NamedTuple):
    """A pattern, and a matrix in it or its factors; slots are places in value.

    kind (1,) is UNMADE, MADE or DENSE (factorising would take too long). order (n,) are the nodes as they
    are eliminated; column k, that of order[k], has rows row[start[k]:start[k + 1]], in the order of
    elimination. tape are the slots that factorising updates, in turn. edge_slot (n_edges,) couples the
    nodes of an edge, pair_slot (n_pairs, 4) start and end of one edge with start and end of the other, for
    known (n_pairs,) pairs. value holds the entries below the diagonal; diagonal, inverse (n,) are by node.
    inner and inner_diagonal are the entries of internal damping with eta A = 1, which never change [1/m].
    """

    kind: Ints
    order: Ints
    start: Ints
    row: Slots
    tape: Slots
    edge_slot: Slots
    pair_slot: Slots
    known: Bools
    value: Floats
    diagonal: Floats
    inverse: Floats
    inner: Floats
    inner_diagonal: Floats


def no_factor() -> Factor:
    """Without a pattern yet."""
    none = np.zeros(0, np.int64)
    slots = np.zeros(0, np.uint32)
    values = np.zeros(0)
    return Factor(
        np.zeros(1, np.int64), none, none, slots, slots, slots, np.zeros((0, 4), np.uint32),
        np.zeros(0, np.bool_), values, values, values, values, values,
    )  # fmt: skip


def serves(factor: Factor | tuple[()], contacts: Contacts) -> bool:
    """Whether the pattern holds all contacts found; without a factor there is nothing to hold them."""
    if len(factor) == 0:
        return True
    if factor.kind[0] == UNMADE:
        return False
    known, row = factor.known, contacts.row
    missing = 0
    for k in range(contacts.count[0]):
        missing += not known[row[k]]
    return missing == 0


def _near(contacts: Contacts, mid: Floats, reach: float) -> Bools:
    """Which of the listed pairs are nearer than reach [m]."""
    pairs, listed = contacts.pairs, contacts.listed
    near = np.empty(pairs.shape[0], np.bool_)
    for k in range(near.shape[0]):
        near[k] = False
    for k in range(contacts.count[2]):
        e = pairs[listed[k], 0]
        f = pairs[listed[k], 1]
        squared = 0.0
        for c in range(3):
            squared += (mid[e, c] - mid[f, c]) ** 2
        near[listed[k]] = squared < reach * reach
    return near


def _slot(i: Index, j: Index, rank: Ints, start: Ints, row: Slots) -> Index:
    """Where the entry of nodes i and j is kept."""
    first = min(rank[i], rank[j])
    other = j if first == rank[i] else i
    k: Index = start[first]
    while row[k] != other:
        k += 1
    return k


def _columns(order: Ints, begin: Ints, size: Ints, pool: Ints, rank: Ints, start: Ints) -> Slots:
    """Rows of every column in the order of elimination, one column after the other."""
    n = order.shape[0]
    start[0] = 0
    for k in range(n):
        rank[order[k]] = k
        start[k + 1] = start[k] + size[order[k]]
    row = np.empty(start[n], np.uint32)
    for k in range(n):
        first = begin[order[k]]
        for t in range(size[order[k]]):
            j = pool[first + t]
            place = start[k] + t
            while place > start[k] and rank[row[place - 1]] > rank[j]:
                row[place] = row[place - 1]
                place -= 1
            row[place] = j
    return row


def _place(
    edges: Ints,
    pairs: Ints,
    known: Bools,
    rank: Ints,
    start: Ints,
    row: Slots,
    edge_slot: Slots,
    pair_slot: Slots,
) -> None:
    """Note the slots of every edge and of every known pair of edges."""
    for e in range(edges.shape[0]):
        edge_slot[e] = _slot(edges[e, 0], edges[e, 1], rank, start, row)
    for k in range(pairs.shape[0]):
        if known[k]:
            for c in range(4):
                i = edges[pairs[k, 0], c // 2]
                pair_slot[k, c] = _slot(i, edges[pairs[k, 1], c % 2], rank, start, row)


def _tape(start: Ints, row: Slots, rank: Ints) -> Slots:
    """Slots of all products of two entries of a column, in the order in which factorising makes them."""
    n = start.shape[0] - 1
    length = 0
    for k in range(n):
        size = start[k + 1] - start[k]
        length += size * (size - 1) // 2
    tape = np.empty(length, np.uint32)
    slot = np.empty(n, np.uint32)
    t = 0
    for k in range(n):
        for p in range(start[k], start[k + 1]):
            target = rank[row[p]]
            for s in range(start[target], start[target + 1]):
                slot[row[s]] = s
            for q in range(p + 1, start[k + 1]):
                tape[t] = slot[row[q]]
                t += 1
    return tape


def pattern(a: Assembly, contacts: Contacts, mid: Floats, diameter: float, worth: float) -> Factor:
    """A new pattern for edges with midpoints mid (n_edges, 3), touching below a distance diameter [m].

    worth is the number of operations per node up to which it is made; beyond, it is DENSE and of no use.
    """
    known = _near(contacts, mid, MARGIN * diameter)
    offset, neighbour = couplings(a, contacts.pairs, known)
    n = a.node_length.shape[0]
    order, begin, size, pool, work = minimum_degree(offset, neighbour, worth * n)
    kind = np.empty(1, np.int64)
    kind[0] = MADE
    if not work[0] < np.inf:
        kind[0] = DENSE
        for i in range(n):
            order[i] = i
            size[i] = 0
    rank, start = np.empty(n, np.int64), np.empty(n + 1, np.int64)
    row = _columns(order, begin, size, pool, rank, start)
    edge_slot = np.empty(a.edges.shape[0], np.uint32)
    pair_slot = np.empty((contacts.pairs.shape[0], 4), np.uint32)
    if kind[0] == MADE:
        _place(a.edges, contacts.pairs, known, rank, start, row, edge_slot, pair_slot)
    inner, inner_diagonal = np.zeros(row.shape[0]), np.zeros(n)
    for e in range(edge_slot.shape[0]):
        w = 1.0 / a.rest_length[e]
        inner_diagonal[a.edges[e, 0]] += w
        inner_diagonal[a.edges[e, 1]] += w
        if kind[0] == MADE:
            inner[edge_slot[e]] -= w
    return Factor(
        kind, order, start, row, _tape(start, row, rank), edge_slot, pair_slot, known,
        np.empty(row.shape[0]), np.empty(n), np.empty(n), inner, inner_diagonal,
    )  # fmt: skip


def renewed(
    factor: Factor | tuple[()], a: Assembly, contacts: Contacts, mid: Floats, diameter: float
) -> Factor | tuple[()]:
    """A factor for a new pattern; the empty tuple stays what it is."""
    if len(factor) == 0:
        return factor
    return pattern(a, contacts, mid, diameter, WORTH)


def usable(factor: Factor | tuple[()]) -> bool:
    """Whether a solve is possible: iteratively, or directly."""
    if len(factor) == 0:
        return True
    made: bool = factor.kind[0] == MADE
    return made


def assemble(a: Assembly, eta_A: float, contacts: Contacts, fixed: Bools, factor: Factor) -> None:
    """The mobility matrix of internal damping and collision drag, with fixed (n_nodes,) nodes held."""
    value, diagonal, edge_slot, pair_slot = factor.value, factor.diagonal, factor.edge_slot, factor.pair_slot
    edges, touching, inner, inner_diagonal = a.edges, contacts.edges, factor.inner, factor.inner_diagonal
    nodes, weight, coupled, rows = (
        contacts.drag_nodes,
        contacts.drag_weight,
        contacts.drag_contact,
        contacts.row,
    )
    for i in range(diagonal.shape[0]):
        diagonal[i] = eta_A * inner_diagonal[i]
    for s in range(value.shape[0]):
        value[s] = eta_A * inner[s]
    for k in range(contacts.count[1]):
        i0 = np.uintp(nodes[k, 0])
        i1 = np.uintp(nodes[k, 1])
        j0 = np.uintp(nodes[k, 2])
        j1 = np.uintp(nodes[k, 3])
        w = 0.25 * weight[k]
        contact = np.uintp(coupled[k])
        slot = np.uintp(rows[contact])
        if i0 == i1:
            end = 0 if i0 == edges[touching[contact, 0], 0] else 3
            diagonal[i0] += 4.0 * w
            diagonal[j0] += 4.0 * w
            value[pair_slot[slot, end]] -= 4.0 * w
        else:
            diagonal[i0] += w
            diagonal[i1] += w
            diagonal[j0] += w
            diagonal[j1] += w
            value[edge_slot[touching[contact, 0]]] += w
            value[edge_slot[touching[contact, 1]]] += w
            for c in range(4):
                value[pair_slot[slot, c]] -= w
    for i in range(diagonal.shape[0]):
        if fixed[i]:
            diagonal[i] *= HELD


def eliminate(factor: Factor, v: Floats) -> bool:
    """L D L^T in place: value becomes L, inverse 1/D; and v (n_nodes, 3), the right side, L^-1 v.

    False if the matrix is not positive definite.
    """
    order, start, row, tape = factor.order, factor.start, factor.row, factor.tape
    value, diagonal, inverse = factor.value, factor.diagonal, factor.inverse
    t = np.uintp(0)
    for k in range(order.shape[0]):
        i = np.uintp(order[k])
        end = np.uintp(start[k + 1])
        d = diagonal[i]
        if not d > 0.0:
            return False
        s = 1.0 / d
        inverse[i] = s
        v0, v1, v2 = v[i, 0], v[i, 1], v[i, 2]
        for p in range(np.uintp(start[k]), end):
            j = row[p]
            l = value[p] * s
            diagonal[j] -= l * value[p]
            v[j, 0] -= l * v0
            v[j, 1] -= l * v1
            v[j, 2] -= l * v2
            for q in range(p + ONE, end):
                value[tape[t]] -= l * value[q]
                t += ONE
            value[p] = l
    return True


def carry(factor: Factor, v: Floats) -> None:
    """Eliminate another right side v (n_nodes, 3) with the factors that `eliminate` made."""
    order, start, row, value = factor.order, factor.start, factor.row, factor.value
    for k in range(order.shape[0]):
        i = np.uintp(order[k])
        v0, v1, v2 = v[i, 0], v[i, 1], v[i, 2]
        for p in range(np.uintp(start[k]), np.uintp(start[k + 1])):
            j = row[p]
            l = value[p]
            v[j, 0] -= l * v0
            v[j, 1] -= l * v1
            v[j, 2] -= l * v2


def substitute(factor: Factor, v: Floats) -> None:
    """Replace what `eliminate` or `carry` left in v (n_nodes, 3) by the solution."""
    order, start, row, value, inverse = factor.order, factor.start, factor.row, factor.value, factor.inverse
    for k in range(order.shape[0] - 1, -1, -1):
        i = np.uintp(order[k])
        s = inverse[i]
        v0, v1, v2 = s * v[i, 0], s * v[i, 1], s * v[i, 2]
        for p in range(np.uintp(start[k]), np.uintp(start[k + 1])):
            j = row[p]
            l = value[p]
            v0 -= l * v[j, 0]
            v1 -= l * v[j, 1]
            v2 -= l * v[j, 2]
        v[i, 0] = v0
        v[i, 1] = v1
        v[i, 2] = v2


compile_kernels(
    __name__,
    inline=("_slot",),
    owning=("_near", "_columns", "_tape", "pattern", "renewed"),
    plain=("no_factor",),
)
