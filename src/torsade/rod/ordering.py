"""The order in which to eliminate nodes so that the factors of the mobility matrix stay sparse.

Minimum degree (Tinney and Walker 1967): of the nodes left, the one coupled to fewest goes first, and
couples its neighbours to each other. On fibers in contact this takes several times fewer operations than
any order of small bandwidth, because what is eliminated last is only the few places where strands touch.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index, Ints
from torsade.assembly import Assembly
from torsade.rod.neighbours import NONE


class Elimination(NamedTuple):
    """Nodes (n,) in order of elimination, and to which nodes each is coupled when its turn comes.

    Node i is coupled to pool[begin[i]:begin[i] + size[i]]; work[0] is the sum of size^2, the number of
    operations of a factorisation, infinite when the elimination was given up.
    """

    order: Ints
    begin: Ints
    size: Ints
    pool: Ints
    work: Floats


def _filled(n: Index, value: Index) -> Ints:
    """n times the same number."""
    out = np.empty(n, np.int64)
    for i in range(n):
        out[i] = value
    return out


def couplings(a: Assembly, pairs: Ints, chosen: Bools) -> tuple[Ints, Ints]:
    """Nodes coupled to each node by edges and by the chosen pairs of edges: (offsets, neighbours).

    pairs (n_pairs, 2), chosen (n_pairs,). The neighbours of node i, some of them several times, are
    neighbours[offsets[i]:offsets[i + 1]].
    """
    edges = a.edges
    n = a.node_length.shape[0]
    offset = _filled(n + 1, NONE)
    for e in range(edges.shape[0]):
        offset[edges[e, 0] + 1] += 1
        offset[edges[e, 1] + 1] += 1
    for k in range(pairs.shape[0]):
        if chosen[k]:
            for end in range(2):
                offset[edges[pairs[k, 0], end] + 1] += 2
                offset[edges[pairs[k, 1], end] + 1] += 2
    for i in range(n):
        offset[i + 1] += offset[i]
    place = np.empty(n, np.int64)
    for i in range(n):
        place[i] = offset[i]
    neighbour = np.empty(offset[n], np.int64)
    for e in range(edges.shape[0]):
        _couple(edges[e, 0], edges[e, 1], place, neighbour)
    for k in range(pairs.shape[0]):
        if chosen[k]:
            for p in range(2):
                for q in range(2):
                    _couple(edges[pairs[k, 0], p], edges[pairs[k, 1], q], place, neighbour)
    return offset, neighbour


def _couple(i: Index, j: Index, place: Ints, neighbour: Ints) -> None:
    """Write two nodes down as neighbours of each other."""
    neighbour[place[i]] = j
    neighbour[place[j]] = i
    place[i] += 1
    place[j] += 1


def _distinct(offset: Ints, neighbour: Ints, mark: Ints, begin: Ints, size: Ints, pool: Ints) -> int:
    """Write the neighbours of every node once into pool; returns where it ends."""
    end = 0
    for i in range(size.shape[0]):
        begin[i] = end
        mark[i] = i
        for k in range(offset[i], offset[i + 1]):
            j = neighbour[k]
            if mark[j] != i:
                mark[j] = i
                pool[end] = j
                end += 1
        size[i] = end - begin[i]
    return end


def _link(i: Index, degree: Index, head: Ints, tail: Ints, following: Ints, previous: Ints) -> None:
    """Put node i last among those of a degree."""
    last = tail[degree]
    following[i] = -1
    previous[i] = last
    if last >= 0:
        following[last] = i
    else:
        head[degree] = i
    tail[degree] = i


def _unlink(i: Index, degree: Index, head: Ints, tail: Ints, following: Ints, previous: Ints) -> None:
    """Take node i out of those of its degree."""
    if previous[i] >= 0:
        following[previous[i]] = following[i]
    else:
        head[degree] = following[i]
    if following[i] >= 0:
        previous[following[i]] = previous[i]
    else:
        tail[degree] = previous[i]


def _merge(u: Index, v: Index, stamp: int, mark: Ints, begin: Ints, size: Ints, pool: Ints, end: int) -> int:
    """Couple u to the neighbours of v, which is eliminated; the new list is written at the end of pool."""
    place = end
    mark[u] = stamp
    mark[v] = stamp
    for k in range(begin[u], begin[u] + size[u]):
        w = pool[k]
        if w != v:
            mark[w] = stamp
            pool[end] = w
            end += 1
    for k in range(begin[v], begin[v] + size[v]):
        w = pool[k]
        if mark[w] != stamp:
            pool[end] = w
            end += 1
    begin[u] = place
    size[u] = end - place
    return end


def minimum_degree(offset: Ints, neighbour: Ints, most: float) -> Elimination:
    """Eliminate nodes coupled as in `couplings`, fewest neighbours first; give up beyond work `most`."""
    n = offset.shape[0] - 1
    order, begin, size = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    mark = _filled(n, NONE - 1)
    pool = np.empty(2 * neighbour.shape[0] + 64 * n, np.int64)
    end = _distinct(offset, neighbour, mark, begin, size, pool)
    head, tail = _filled(n + 1, NONE - 1), _filled(n + 1, NONE - 1)
    following, previous = np.empty(n, np.int64), np.empty(n, np.int64)
    for i in range(n):
        _link(i, size[i], head, tail, following, previous)
    work = np.empty(1)
    work[0] = 0.0
    stamp = n
    lowest = 0
    for k in range(n):
        while head[lowest] < 0:
            lowest += 1
        v = head[lowest]
        _unlink(v, size[v], head, tail, following, previous)
        order[k] = v
        work[0] += float(size[v]) ** 2
        if work[0] > most:
            work[0] = np.inf
            break
        room = end
        for t in range(begin[v], begin[v] + size[v]):
            room += size[pool[t]] + size[v]
        if room > pool.shape[0]:
            grown = np.empty(2 * room, np.int64)
            for t in range(end):
                grown[t] = pool[t]
            pool = grown
        for t in range(begin[v], begin[v] + size[v]):
            u = pool[t]
            _unlink(u, size[u], head, tail, following, previous)
            stamp += 1
            end = _merge(u, v, stamp, mark, begin, size, pool, end)
            _link(u, size[u], head, tail, following, previous)
            lowest = min(lowest, size[u])
    return Elimination(order, begin, size, pool, work)


compile_kernels(
    __name__, inline=("_couple", "_link", "_unlink"), owning=("_filled", "couplings", "minimum_degree")
)
