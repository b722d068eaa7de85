"""Fibers as index arrays (nodes, edges, hinges) and their state.

A node is a bead, an edge joins two nodes, a hinge is an interior vertex with the edge before and the edge
after it. Open fibers, closed fibers and any number of them are the same structure: nodes and edges of
one fiber are consecutive, a closed fiber has one edge and one hinge more at its seam. Both records are
named tuples of arrays, so that compiled kernels take them as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.arrays import Bools, Floats, Ints
from torsade.curve import rotation_minimising_frames
from torsade.errors import TorsadeError


class Assembly(NamedTuple):
    """Connectivity and rest shape of one or many naturally straight fibers.

    Attributes
    ----------
    edges : (n_edges, 2) nodes at the start and the end of each edge
    hinges : (n_hinges, 3) edge before, edge after, node between
    beside : (n_edges, 2) edge before and edge after each edge, -1 at a free end
    rest_length : (n_edges,) l [m]
    hinge_length : (n_hinges,) lbar, half the rest length of the two edges [m]
    node_length : (n_nodes,) Voronoi length lbar of each node [m]
    edge_arclength : (n_edges,) rest arclength of edge midpoints along their fiber [m]
    edge_fiber : (n_edges,) the fiber of each edge
    fiber_length : (n_fibers,) rest length [m]
    node_start, edge_start, hinge_start : (n_fibers + 1,) offsets
    closed : (n_fibers,) whether the fiber is closed
    ends_meet : (n_fibers,) whether the last edge lies before the first where contacts between neighbours are
        left out: of closed fibers, and of those just cut, whose ends lie face to face
    """

    edges: Ints
    hinges: Ints
    beside: Ints
    rest_length: Floats
    hinge_length: Floats
    node_length: Floats
    edge_arclength: Floats
    edge_fiber: Ints
    fiber_length: Floats
    node_start: Ints
    edge_start: Ints
    hinge_start: Ints
    closed: Bools
    ends_meet: Bools


class State(NamedTuple):
    """Where the fibers are and how they are twisted; everything a run needs to go on.

    Attributes
    ----------
    x : (n_nodes, 3) node positions [m]
    theta : (n_edges,) material angle from the reference director [rad]
    director : (n_edges, 3) reference directors, parallel transported in time
    reference_twist : (n_hinges,) unwrapped twist of the reference directors [rad]
    v : (n_nodes, 3) node velocities [m/s], the starting guess of the mobility solve
    omega : (n_edges,) spin about the tangent [rad/s]
    """

    x: Floats
    theta: Floats
    director: Floats
    reference_twist: Floats
    v: Floats
    omega: Floats

    def copy(self) -> State:
        """A state that shares no memory with this one."""
        return State(*(a.copy() for a in self))


def assemble(
    strands: Sequence[Floats],
    closed: Sequence[bool] | None = None,
    rest_lengths: Sequence[Floats] | None = None,
) -> Assembly:
    """Assembly of the given polylines, each (n, 3) [m]; rest lengths are the present ones unless given.

    Raises
    ------
    TorsadeError
        When a strand has too few nodes (2 if open, 3 if closed), an edge of zero length or a fold.
    """
    flags = [False] * len(strands) if closed is None else list(closed)
    parts = [_fiber(x, c, f) for f, (x, c) in enumerate(zip(strands, flags, strict=True))]
    lengths = [p[2] for p in parts] if rest_lengths is None else [np.asarray(r, float) for r in rest_lengths]
    return _joined([len(x) for x in strands], flags, [(p[0], p[1]) for p in parts], lengths)


def _joined(
    nodes: Sequence[int],
    closed: Sequence[bool],
    parts: Sequence[tuple[Ints, Ints]],
    lengths: Sequence[Floats],
) -> Assembly:
    """The assembly of fibers of so many nodes, with their edges and hinges counted from zero."""
    node_start = np.cumsum([0, *nodes], dtype=np.int64)
    edge_start = np.cumsum([0] + [len(p[0]) for p in parts], dtype=np.int64)
    hinge_start = np.cumsum([0] + [len(p[1]) for p in parts], dtype=np.int64)
    edges = np.concatenate([p[0] + node_start[f] for f, p in enumerate(parts)])
    shift = [np.array([edge_start[f], edge_start[f], node_start[f]]) for f in range(len(parts))]
    hinges = np.concatenate([p[1] + s for p, s in zip(parts, shift, strict=True)])
    rest = np.concatenate(lengths)
    beside = np.full((len(edges), 2), -1, dtype=np.int64)
    beside[hinges[:, 1], 0] = hinges[:, 0]
    beside[hinges[:, 0], 1] = hinges[:, 1]
    node_length = np.zeros(node_start[-1])
    np.add.at(node_length, edges.ravel(), np.repeat(0.5 * rest, 2))
    return Assembly(
        edges=edges,
        hinges=hinges,
        beside=beside,
        rest_length=rest,
        hinge_length=0.5 * (rest[hinges[:, 0]] + rest[hinges[:, 1]]),
        node_length=node_length,
        edge_arclength=np.concatenate([np.cumsum(r) - 0.5 * r for r in lengths]),
        edge_fiber=np.repeat(np.arange(len(parts), dtype=np.int64), np.diff(edge_start)),
        fiber_length=np.array([r.sum() for r in lengths]),
        node_start=node_start,
        edge_start=edge_start,
        hinge_start=hinge_start,
        closed=np.array(closed, dtype=np.bool_),
        ends_meet=np.array(closed, dtype=np.bool_),
    )


def with_points(a: Assembly, count: int) -> Assembly:
    """The assembly and so many nodes after its own, each a fiber without edges: bodies that fibers touch."""
    none, no = np.zeros(count), np.zeros(count, np.bool_)

    def after(start: Ints, step: int) -> Ints:
        return np.append(start, start[-1] + step * np.arange(1, count + 1))

    return a._replace(
        node_length=np.append(a.node_length, none),
        fiber_length=np.append(a.fiber_length, none),
        node_start=after(a.node_start, 1),
        edge_start=after(a.edge_start, 0),
        hinge_start=after(a.hinge_start, 0),
        closed=np.append(a.closed, no),
        ends_meet=np.append(a.ends_meet, no),
    )


def split(a: Assembly, hinge: int) -> Assembly:
    """The assembly after its fiber is cut at a hinge: one hinge less, one node and one fiber more.

    The node of the hinge becomes two neighbours in the order of nodes, the end of one fiber and the beginning
    of the next; the order of edges stays. `doubled(values, node)` makes arrays of
    nodes fit.
    """
    before, after, node = (int(i) for i in a.hinges[hinge])
    fiber = int(a.edge_fiber[before])
    if a.closed[fiber]:
        raise TorsadeError(f"fiber {fiber} is closed, and only open fibers are split; cut it open")
    edges = a.edges + (a.edges > node)
    edges[after, 0] = node + 1
    hinges = np.delete(a.hinges, hinge, axis=0)
    hinges[:, 2] += hinges[:, 2] > node
    beside = a.beside.copy()
    beside[before, 1] = beside[after, 0] = -1
    node_length = _inserted(a.node_length, node, 0.5 * a.rest_length[before])
    node_length[node + 1] = 0.5 * a.rest_length[after]
    start, end = int(a.edge_start[fiber]), int(a.edge_start[fiber + 1])
    first = float(a.rest_length[start:after].sum())
    edge_arclength = a.edge_arclength.copy()
    edge_arclength[after:end] -= first
    edge_fiber = a.edge_fiber.copy()
    edge_fiber[after:] += 1
    fiber_length = _inserted(a.fiber_length, fiber, first)
    fiber_length[fiber + 1] -= first
    shift = np.arange(len(a.node_start)) > fiber
    ends_meet = _inserted(a.ends_meet, fiber, False)
    ends_meet[fiber + 1] = False
    return Assembly(
        edges=edges,
        hinges=hinges,
        beside=beside,
        rest_length=a.rest_length,
        hinge_length=np.delete(a.hinge_length, hinge),
        node_length=node_length,
        edge_arclength=edge_arclength,
        edge_fiber=edge_fiber,
        fiber_length=fiber_length,
        node_start=_inserted(a.node_start + shift, fiber + 1, node + 1),
        edge_start=_inserted(a.edge_start, fiber + 1, after),
        hinge_start=_inserted(a.hinge_start - shift, fiber + 1, hinge),
        closed=_inserted(a.closed, fiber, False),
        ends_meet=ends_meet,
    )


def doubled(values: NDArray[Any], place: int) -> NDArray[Any]:
    """Values (n, ...) with that at a place twice, (n + 1, ...)."""
    return np.concatenate((values[: place + 1], values[place:]))


def _inserted(values: NDArray[Any], place: int, value: float) -> NDArray[Any]:
    """Values (n,) with one more before a place; np.insert does the same in ten times the time."""
    return np.concatenate((values[:place], np.array([value], values.dtype), values[place:]))


def opened(a: Assembly, state: State, hinge: int) -> tuple[Assembly, State]:
    """A closed fiber cut at a hinge, which is then no more: the open fiber begins and ends at its node.

    The node is doubled. All else is carried along to the bit: positions, rates, and the twist of every other
    hinge. The ends still count as neighbours (`ends_meet`), since they lie face to face; see `parted`.

    Raises
    ------
    TorsadeError
        When the fiber is open.
    """
    _, after, node = (int(i) for i in a.hinges[hinge])
    fiber = int(a.edge_fiber[after])
    if not a.closed[fiber]:
        raise TorsadeError(f"fiber {fiber} is open, and only closed fibers are opened; split it instead")
    nodes, edges, hinges = (
        _from(start, fiber, first)
        for start, first in ((a.node_start, node), (a.edge_start, after), (a.hinge_start, hinge))
    )
    nodes = np.insert(nodes, a.node_start[fiber + 1], node)
    hinges = np.delete(hinges, a.hinge_start[fiber])
    sizes, closed = np.diff(a.node_start), a.closed.copy()
    sizes[fiber] += 1
    closed[fiber] = False
    rest = np.split(a.rest_length[edges], a.edge_start[1:-1])
    parts = [_numbered(n, c) for n, c in zip(sizes.tolist(), closed.tolist(), strict=True)]
    cut = _joined(sizes.tolist(), closed.tolist(), parts, rest)._replace(ends_meet=a.ends_meet.copy())
    x, theta, director, reference_twist, v, omega = state
    return cut, State(
        x[nodes], theta[edges], director[edges], reference_twist[hinges], v[nodes], omega[edges]
    )


def _from(start: Ints, fiber: int, first: int) -> Ints:
    """Indices of all fibers in order, those of one beginning with `first`."""
    order = np.arange(start[-1])
    mine = slice(int(start[fiber]), int(start[fiber + 1]))
    order[mine] = np.roll(order[mine], int(start[fiber]) - first)
    return order


def parted(a: Assembly) -> Assembly:
    """The assembly after the ends of fibers that were opened have come apart: they may touch again."""
    return a._replace(ends_meet=a.closed.copy())


def _fiber(x: Floats, closed: bool, fiber: int) -> tuple[Ints, Ints, Floats]:
    """Edges, hinges (both counted from zero) and present edge lengths of one polyline."""
    n = len(x)
    if n < (3 if closed else 2):
        needed = "a closed fiber needs at least 3" if closed else "an open fiber needs at least 2"
        raise TorsadeError(f"fiber {fiber} has {n} node{'' if n == 1 else 's'}; {needed}: give more nodes.")
    edges, hinges = _numbered(n, closed)
    lengths = np.linalg.norm(x[edges[:, 1]] - x[edges[:, 0]], axis=1)
    if not np.all(lengths > 0):
        e = int(np.argmin(lengths))
        raise TorsadeError(
            f"nodes {edges[e, 0]} and {edges[e, 1]} of fiber {fiber} are at one place; "
            "every edge needs a length: remove one of the two nodes."
        )
    t = (x[edges[:, 1]] - x[edges[:, 0]]) / lengths[:, None]
    turn = np.einsum("kc,kc->k", t[hinges[:, 0]], t[hinges[:, 1]])
    if turn.size and turn.min() < -1 + 1e-9:
        node = int(hinges[np.argmin(turn), 2])
        raise TorsadeError(
            f"fiber {fiber} folds straight back at node {node}; fibers bend smoothly: move the node."
        )
    return edges, hinges, lengths


def _numbered(n: int, closed: bool) -> tuple[Ints, Ints]:
    """Edges and hinges of a fiber of n nodes, counted from zero."""
    start = np.arange(n if closed else n - 1, dtype=np.int64)
    edges = np.stack([start, (start + 1) % n], axis=1)
    if closed:
        return edges, np.stack([(start - 1) % n, start, start], axis=1)
    return edges, np.stack([start[:-1], start[1:], start[1:]], axis=1)


def initial_state(assembly: Assembly, strands: Sequence[Floats]) -> State:
    """State at rest in twist: material directors parallel transported along each fiber.

    A closed fiber keeps the holonomy of its centerline as reference twist at its seam, undone by the
    material angle, so that its total twist is the one nearest to zero that closes: minus the holonomy
    angle spread evenly over the hinges (Lk = 0 up to whole turns).
    """
    x = np.ascontiguousarray(np.concatenate([np.asarray(s, float) for s in strands]))
    n_edges = len(assembly.edges)
    frames = [rotation_minimising_frames(s, bool(c)) for s, c in zip(strands, assembly.closed, strict=True)]
    twist = np.zeros(len(assembly.hinges))
    for f, frame in enumerate(frames):
        if assembly.closed[f]:
            twist[assembly.hinge_start[f]] = -frame.holonomy
    director = np.ascontiguousarray(np.concatenate([frame.u for frame in frames]))
    return State(x, np.zeros(n_edges), director, twist, np.zeros_like(x), np.zeros(n_edges))


def twisted(assembly: Assembly, state: State, density: float) -> State:
    """The same centerlines with the twist of every hinge at density [rad/m] times its length.

    The ends of a closed fiber are fused at the angle that takes, which need not be a whole number of turns:
    it is an offset of the reference twist at the seam. The total twist of a closed fiber, and so its link,
    is any real number, and stays what it is.
    """
    wanted = density * assembly.hinge_length
    theta, reference_twist = np.zeros_like(state.theta), state.reference_twist.copy()
    for f, closed in enumerate(assembly.closed):
        hinges = slice(int(assembly.hinge_start[f]) + int(closed), int(assembly.hinge_start[f + 1]))
        steps = wanted[hinges] - reference_twist[hinges]
        theta[assembly.edge_start[f] + 1 : assembly.edge_start[f + 1]] = np.cumsum(steps)
        if closed:
            seam = int(assembly.hinge_start[f])
            before, after, _ = assembly.hinges[seam]
            reference_twist[seam] = wanted[seam] - theta[after] + theta[before]
    return state._replace(theta=theta, reference_twist=reference_twist)
