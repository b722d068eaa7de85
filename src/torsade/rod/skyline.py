"""Direct solution of the mobility system: L D L^T within the envelope of a reordered matrix.

Nodes are renumbered by the reverse Cuthill-McKee method whenever the neighbour list is made, which
brings nodes that touch close together; rows then reach back only a few places, and factorising costs a
few operations per node. The envelope itself is that of the contacts of the moment.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index, Ints
from torsade.assembly import Assembly
from torsade.rod.contact import Contacts


class Skyline(NamedTuple):
    """A symmetric matrix in envelope storage, and its factors.

    position (n,) is the row of each node; row i holds values[start[i]:start[i + 1]] in columns first[i]
    to i - 1, and diagonal[i]; inverse (n,) holds 1/D, y (n, 3) the right side. Rows that reach back
    farther than worthwhile in sum leave values empty: then the system is solved iteratively.
    """

    position: Ints
    first: Ints
    start: Ints
    values: Floats
    diagonal: Floats
    inverse: Floats
    y: Floats


def _adjacency(a: Assembly, pairs: Ints) -> tuple[Ints, Ints]:
    """Nodes coupled to each node by edges and by pairs of edges: (offsets, neighbours), repeats allowed."""
    n = a.node_length.shape[0]
    offset = np.zeros(n + 1, np.int64)
    for e in range(a.edges.shape[0]):
        offset[a.edges[e, 0] + 1] += 1
        offset[a.edges[e, 1] + 1] += 1
    for k in range(pairs.shape[0]):
        for end in range(2):
            offset[a.edges[pairs[k, 0], end] + 1] += 2
            offset[a.edges[pairs[k, 1], end] + 1] += 2
    for i in range(n):
        offset[i + 1] += offset[i]
    place = offset[:n].copy()
    neighbour = np.empty(offset[n], np.int64)
    for e in range(a.edges.shape[0]):
        i = a.edges[e, 0]
        j = a.edges[e, 1]
        neighbour[place[i]] = j
        neighbour[place[j]] = i
        place[i] += 1
        place[j] += 1
    for k in range(pairs.shape[0]):
        for p in range(2):
            for q in range(2):
                i = a.edges[pairs[k, 0], p]
                j = a.edges[pairs[k, 1], q]
                neighbour[place[i]] = j
                neighbour[place[j]] = i
                place[i] += 1
                place[j] += 1
    return offset, neighbour


def _sweep(
    offset: Ints, neighbour: Ints, root: Index, mark: Ints, stamp: int, queue: Ints, begin: int
) -> int:
    """Breadth-first sweep from root over unmarked nodes into queue[begin:], lower degrees first.

    Returns the end of the queue; the last node is farthest from the root.
    """
    queue[begin] = root
    mark[root] = stamp
    end = begin + 1
    head = begin
    while head < end:
        i = queue[head]
        head += 1
        fresh = end
        for k in range(offset[i], offset[i + 1]):
            j = neighbour[k]
            if mark[j] != stamp and mark[j] != -1:
                mark[j] = stamp
                degree = offset[j + 1] - offset[j]
                place = end
                while place > fresh:
                    before = queue[place - 1]
                    if offset[before + 1] - offset[before] <= degree:
                        break
                    queue[place] = before
                    place -= 1
                queue[place] = j
                end += 1
    return end


def reverse_cuthill_mckee(a: Assembly, pairs: Ints) -> Ints:
    """Row (n_nodes,) of every node such that coupled nodes are near each other."""
    n = a.node_length.shape[0]
    offset, neighbour = _adjacency(a, pairs)
    mark = np.zeros(n, np.int64)
    queue = np.empty(n, np.int64)
    done = 0
    stamp = 0
    for seed in range(n):
        if mark[seed] == -1:
            continue
        root = seed
        for _ in range(2):
            stamp += 1
            end = _sweep(offset, neighbour, root, mark, stamp, queue, done)
            root = queue[end - 1]
        stamp += 1
        end = _sweep(offset, neighbour, root, mark, stamp, queue, done)
        for k in range(done, end):
            mark[queue[k]] = -1
        done = end
    position = np.empty(n, np.int64)
    for k in range(n):
        position[queue[k]] = n - 1 - k
    return position


def skyline_for(a: Assembly, pairs: Ints, worth: float) -> Skyline:
    """An empty skyline with room for every contact among pairs of edges.

    worth is the mean squared reach of rows up to which factorising pays; beyond, values are empty.
    """
    n = a.node_length.shape[0]
    position = reverse_cuthill_mckee(a, pairs)
    first = np.empty(n, np.int64)
    start = np.empty(n + 1, np.int64)
    _reset(position, a.edges, first)
    for k in range(pairs.shape[0]):
        e = pairs[k, 0]
        f = pairs[k, 1]
        _reach(position, first, a.edges[e, 0], a.edges[e, 1], a.edges[f, 0], a.edges[f, 1])
    size = 0
    work = 0.0
    for i in range(n):
        size += i - first[i]
        work += float(i - first[i]) ** 2
    if work > worth * n:
        size = 0
    return Skyline(position, first, start, np.empty(size), np.empty(n), np.empty(n), np.empty((n, 3)))


def _reset(position: Ints, edges: Ints, first: Ints) -> None:
    """Rows that reach as far as their own edges."""
    for i in range(first.shape[0]):
        first[i] = i
    for e in range(edges.shape[0]):
        p = position[edges[e, 0]]
        q = position[edges[e, 1]]
        if p > q:
            first[p] = min(first[p], q)
        else:
            first[q] = min(first[q], p)


def _reach(position: Ints, first: Ints, i0: Index, i1: Index, j0: Index, j1: Index) -> None:
    """Let the rows of four coupled nodes reach the lowest of them."""
    p = position[i0]
    q = position[i1]
    r = position[j0]
    s = position[j1]
    low = min(min(p, q), min(r, s))
    first[p] = min(first[p], low)
    first[q] = min(first[q], low)
    first[r] = min(first[r], low)
    first[s] = min(first[s], low)


def _couple(
    i: Index, j: Index, w: float, fixed: Bools, position: Ints, first: Ints, start: Ints, values: Floats
) -> None:
    """Add w to the entry of nodes i and j; couplings to fixed nodes are left out."""
    if not (fixed[i] or fixed[j]):
        p = position[i]
        q = position[j]
        row = max(p, q)
        values[start[row] + min(p, q) - first[row]] += w


def assemble_skyline(a: Assembly, eta_A: float, contacts: Contacts, fixed: Bools, sky: Skyline) -> None:
    """The mobility matrix of internal damping and collision drag; rows of fixed nodes are the identity."""
    position, first, start = sky.position, sky.first, sky.start
    values, diagonal = sky.values, sky.diagonal
    edges, rest_length = a.edges, a.rest_length
    nodes, weight = contacts.drag_nodes, contacts.drag_weight
    n = diagonal.shape[0]
    _reset(position, edges, first)
    for k in range(contacts.count[1]):
        _reach(position, first, nodes[k, 0], nodes[k, 1], nodes[k, 2], nodes[k, 3])
    start[0] = 0
    for i in range(n):
        start[i + 1] = start[i] + i - first[i]
        diagonal[i] = 0.0
    for k in range(start[n]):
        values[k] = 0.0
    for e in range(edges.shape[0]):
        i = edges[e, 0]
        j = edges[e, 1]
        w = eta_A / rest_length[e]
        diagonal[position[i]] += w
        diagonal[position[j]] += w
        _couple(i, j, -w, fixed, position, first, start, values)
    for k in range(contacts.count[1]):
        i0 = nodes[k, 0]
        i1 = nodes[k, 1]
        j0 = nodes[k, 2]
        j1 = nodes[k, 3]
        w = 0.25 * weight[k]
        if i0 == i1:
            diagonal[position[i0]] += 4.0 * w
            diagonal[position[j0]] += 4.0 * w
            _couple(i0, j0, -4.0 * w, fixed, position, first, start, values)
        else:
            diagonal[position[i0]] += w
            diagonal[position[i1]] += w
            diagonal[position[j0]] += w
            diagonal[position[j1]] += w
            _couple(i0, i1, w, fixed, position, first, start, values)
            _couple(j0, j1, w, fixed, position, first, start, values)
            _couple(i0, j0, -w, fixed, position, first, start, values)
            _couple(i0, j1, -w, fixed, position, first, start, values)
            _couple(i1, j0, -w, fixed, position, first, start, values)
            _couple(i1, j1, -w, fixed, position, first, start, values)
    for i in range(n):
        if fixed[i]:
            diagonal[position[i]] = 1.0


def factorise(sky: Skyline) -> bool:
    """L D L^T in place (Jennings): row i of values becomes row i of L; False if not positive definite."""
    first, start, values = sky.first, sky.start, sky.values
    diagonal, inverse = sky.diagonal, sky.inverse
    for i in range(diagonal.shape[0]):
        fi = first[i]
        row = start[i] - fi
        d = diagonal[i]
        for j in range(fi + 1, i):
            fj = first[j]
            other = start[j] - fj
            s = values[row + j]
            for k in range(max(fi, fj), j):
                s -= values[row + k] * values[other + k]
            values[row + j] = s
        for j in range(fi, i):
            u = values[row + j]
            l = u * inverse[j]
            values[row + j] = l
            d -= u * l
        if not d > 0.0:
            return False
        inverse[i] = 1.0 / d
    return True


def back_substitute(sky: Skyline, r: Floats, out: Floats) -> None:
    """Solve for out (n_nodes, 3) from the right side r (n_nodes, 3), both in node order."""
    position, first, start = sky.position, sky.first, sky.start
    values, inverse, y = sky.values, sky.inverse, sky.y
    n = inverse.shape[0]
    for i in range(n):
        p = position[i]
        for c in range(3):
            y[p, c] = r[i, c]
    for i in range(n):
        row = start[i] - first[i]
        y0 = y[i, 0]
        y1 = y[i, 1]
        y2 = y[i, 2]
        for j in range(first[i], i):
            l = values[row + j]
            y0 -= l * y[j, 0]
            y1 -= l * y[j, 1]
            y2 -= l * y[j, 2]
        y[i, 0] = y0
        y[i, 1] = y1
        y[i, 2] = y2
    for i in range(n - 1, -1, -1):
        for c in range(3):
            y[i, c] *= inverse[i]
    for i in range(n - 1, -1, -1):
        row = start[i] - first[i]
        for j in range(first[i], i):
            l = values[row + j]
            for c in range(3):
                y[j, c] -= l * y[i, c]
    for i in range(n):
        p = position[i]
        for c in range(3):
            out[i, c] = y[p, c]


compile_kernels(__name__, inline=("_couple", "_reach"))
