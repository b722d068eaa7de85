"""Strands drawn short and smooth while they keep apart and never pass through each other: kernels.

Nodes x (n, 3), in radii of the fiber, move towards balance of these forces, the tension being one:

- along an edge e, 1 + `EVEN` (|e|/l - 1): the tension, which shortens strands, larger in edges longer than
  their strand's mean l, so that nodes are spread evenly;
- against bending, from the energy sum B |d|^2/2l^3, d being the second difference at a node. Where the
  curvature, |d| over the product of both edges, exceeds 1/rho, the excess counts with B_hard. A closed
  strand shorter than a circle of radius rho is not drawn together but pushed open;
- springs of energy K l l' (R - r)^2/2 between nodes nearer than R, the distance that strands keep. Nodes of
  one strand are left out if nearer along it than the arc of radius rho and chord R.

**No strand passes through another.** In a step every node moves less than half the distance of each edge at
it to the edges that share no node with it. While a node moves straight, a point of an edge moves no farther
than the farther of the edge's nodes. So two edges that share no node approach each other by less than their
distance, and do not meet. Neighbours on a strand could meet only by folding back onto each other; then an end
of the shorter lies on the longer, and the next edge at that end, which shares no node with the longer, meets
it: that is excluded, too. Nodes stop where edges are `NEAREST` apart, so that round-off does not matter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from torsade._compile import compile_kernels
from torsade.arrays import Bools, Floats, Index, Ints
from torsade.knots.band import solve_band
from torsade.rod.distance import segment_distance
from torsade.rod.neighbours import near_points

LARGEST_MOVE = 0.6  # [radii]
SHARE = 0.45
"""Of its distance to others that an edge may move in a step; below a half."""
NEAREST = 1e-6
"""Edges come no nearer than this [radii]: there round-off is far below their distance."""
SKIN = 1.0  # pairs are listed this much farther than they act [radii]
MEMORY = 0.98
"""Most that is kept of the last step in the next one."""


EVEN = 4.0
EVEN_BOUND = 3.0
"""Tension of an edge twice as long as the mean is 1 + EVEN; the matrix of a step takes EVEN_BOUND for all."""


LOOP = 0.5
"""Loops of less than this times the smallest radius of bending are pushed open."""


FINEST = 0.25
"""Edges that are shorter in the mean count as so long, which lets strands grow that begin small [radii]."""


class Laws(NamedTuple):
    """Tension, B and B_hard [radii^2], K [1/radii^3], R and rho [radii], in units of the tension."""

    tension: float
    stiffness: float
    hard_stiffness: float
    springs: float
    distance: float
    bend_radius: float


class Strands(NamedTuple):
    """Which nodes follow each other: strand k has the nodes from first[k] to before first[k + 1].

    first (n_strands + 1,), closed (n_strands,), strand (n_nodes,) of each node, held (n_nodes,): may not
    move.
    """

    first: Ints
    closed: Bools
    strand: Ints
    held: Bools


def strand_lengths(s: Strands, x: Floats, length: Floats, edge: Floats) -> None:
    """Lengths of strands and their mean edges, at least `FINEST`, into length and edge (n_strands,)."""
    length[:] = 0.0
    for i in range(x.shape[0]):
        j = _after(s, i)
        if j >= 0:
            length[s.strand[i]] += _distance(x, i, j)
    for k in range(length.shape[0]):
        n = s.first[k + 1] - s.first[k]
        edge[k] = max(FINEST, length[k] / (n if s.closed[k] else n - 1))


def _distance(x: Floats, i: Index, j: Index) -> float:
    dx = x[j, 0] - x[i, 0]
    dy = x[j, 1] - x[i, 1]
    dz = x[j, 2] - x[i, 2]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


def _after(s: Strands, i: Index) -> Index:
    """The node after node i, or -1 at the end of an open strand."""
    k = s.strand[i]
    if i + 1 < s.first[k + 1]:
        return i + 1
    return s.first[k] if s.closed[k] else -1


def _apart(s: Strands, i: Index, j: Index) -> Index:
    """How many edges lie between nodes i < j of one strand, the shorter way; many between two strands."""
    k = s.strand[i]
    if s.strand[j] != k:
        return 1 << 30
    n = j - i
    if s.closed[k]:
        n = min(n, s.first[k + 1] - s.first[k] - n)
    return n


def room_to_move(s: Strands, x: Floats, pairs: Ints, room: Floats) -> None:
    """How far nodes may move, into room (n_nodes,): SHARE of the distance of edges that share no node.

    Edge i runs from node i to the next; pairs (n_pairs, 2) of edges hold all that are nearer than twice
    LARGEST_MOVE.
    """
    for i in range(x.shape[0]):
        room[i] = LARGEST_MOVE
    for n in range(pairs.shape[0]):
        i = pairs[n, 0]
        j = pairs[n, 1]
        i1 = _after(s, i)
        j1 = _after(s, j)
        if i1 < 0 or j1 < 0 or i1 == j or j1 == i:
            continue
        reach = 2.0 * LARGEST_MOVE + 0.5 * (_distance(x, i, i1) + _distance(x, j, j1))
        squared = 0.0
        for c in range(3):
            d = 0.5 * (x[i, c] + x[i1, c] - x[j, c] - x[j1, c])
            squared += d * d
        if squared < reach * reach:
            move = SHARE * max(0.0, segment_distance(x[i], x[i1], x[j], x[j1]) - NEAREST)
            room[i] = min(room[i], move)
            room[i1] = min(room[i1], move)
            room[j] = min(room[j], move)
            room[j1] = min(room[j1], move)


def _add_springs(
    laws: Laws, s: Strands, x: Floats, pairs: Ints, edge: Floats, force: Floats, diagonal: Floats
) -> None:
    """Forces of the springs, and twice the stiffness of those that act at a node into diagonal."""
    reach = laws.distance
    rho = LOOP * laws.bend_radius
    for n in range(pairs.shape[0]):
        i = pairs[n, 0]
        j = pairs[n, 1]
        dx = x[j, 0] - x[i, 0]
        dy = x[j, 1] - x[i, 1]
        dz = x[j, 2] - x[i, 2]
        squared = dx * dx + dy * dy + dz * dz
        if squared >= reach * reach:
            continue
        l = edge[s.strand[i]]
        along = _apart(s, i, j) * l
        least = reach
        if along < math.pi * rho:
            least = min(reach, 2.0 * rho * math.sin(0.5 * along / rho))
        r = math.sqrt(squared)
        if along < 1.5 * l or r >= least:
            continue
        weight = laws.springs * l * edge[s.strand[j]]
        push = weight * (least - r) / r
        force[i, 0] -= push * dx
        force[i, 1] -= push * dy
        force[i, 2] -= push * dz
        force[j, 0] += push * dx
        force[j, 1] += push * dy
        force[j, 2] += push * dz
        diagonal[i] += 2.0 * weight
        diagonal[j] += 2.0 * weight


def find_slack(laws: Laws, s: Strands, length: Floats, slack: Floats) -> None:
    """What shortens strands (n_strands,): 1, down to -1 in a closed one too short for a circle of rho."""
    for k in range(slack.shape[0]):
        turns = length[k] / (2.0 * math.pi * laws.bend_radius)
        slack[k] = max(-1.0, min(1.0, 5.0 * (turns - 1.0))) if s.closed[k] else 1.0


def _add_tension(
    laws: Laws,
    s: Strands,
    x: Floats,
    edge: Floats,
    slack: Floats,
    force: Floats,
    diagonal: Floats,
    next1: Floats,
) -> None:
    """Forces of the tension, that of laws times slack (n_strands,); their matrix into diagonal, next1."""
    for i in range(x.shape[0]):
        j = _after(s, i)
        if j < 0:
            continue
        l = edge[s.strand[i]]
        e = _distance(x, i, j)
        tension = slack[s.strand[i]]
        tension *= laws.tension if tension > 0.0 else 1.0
        t = (tension + EVEN * max(-0.22, e / l - 1.0)) / e
        m = max(t, EVEN_BOUND / l)
        diagonal[i] += m
        diagonal[j] += m
        next1[i] -= m
        for c in range(3):
            pull = t * (x[j, c] - x[i, c])
            force[i, c] += pull
            force[j, c] -= pull


def _add_bending(
    laws: Laws,
    s: Strands,
    x: Floats,
    edge: Floats,
    slack: Floats,
    force: Floats,
    diagonal: Floats,
    next1: Floats,
    next2: Floats,
) -> None:
    """Forces against bending; their matrix into diagonal, next1 and next2 (n_nodes,)."""
    for i in range(x.shape[0]):
        j = _after(s, i)
        k = _after(s, j) if j >= 0 else j
        if k < 0:
            continue
        squared = 0.0
        for c in range(3):
            d = x[i, c] - 2.0 * x[j, c] + x[k, c]
            squared += d * d
        allowed = _distance(x, i, j) * _distance(x, j, k) / laws.bend_radius
        # Smaller second differences are also had by shrinking: a strand that is to grow has no stiffness.
        taut = min(1.0, 1.0 + slack[s.strand[j]])
        m = laws.stiffness
        bend = laws.stiffness
        if squared > allowed * allowed:
            m += laws.hard_stiffness
            bend += laws.hard_stiffness * (1.0 - allowed / math.sqrt(squared))
        l = edge[s.strand[i]]
        m *= taut / (l * l * l)
        bend *= taut / (l * l * l)
        diagonal[i] += m
        diagonal[j] += 4.0 * m
        diagonal[k] += m
        next1[i] -= 2.0 * m
        next1[j] -= 2.0 * m
        next2[i] += m
        for c in range(3):
            turn = bend * (x[i, c] - 2.0 * x[j, c] + x[k, c])
            force[i, c] -= turn
            force[j, c] += 2.0 * turn
            force[k, c] -= turn


def _midpoints(s: Strands, x: Floats, mid: Floats) -> float:
    """Middles of the edges (n_nodes, 3), an end itself where none follows; returns the longest edge."""
    longest = 0.0
    for i in range(x.shape[0]):
        j = _after(s, i)
        for c in range(3):
            mid[i, c] = 0.5 * (x[i, c] + x[j, c]) if j >= 0 else x[i, c]
        if j >= 0:
            longest = max(longest, _distance(x, i, j))
    return longest


def _order(pairs: Ints) -> None:
    """Sort pairs (n_pairs, 2) by the second, too: sums are then those of the mirror image."""
    for n in range(1, pairs.shape[0]):
        i, j = pairs[n, 0], pairs[n, 1]
        m = n - 1
        while m >= 0 and pairs[m, 0] == i and pairs[m, 1] > j:
            pairs[m + 1, 1] = pairs[m, 1]
            m -= 1
        pairs[m + 1, 1] = j


def _stopped(x: Floats, v: Floats, held: Bools, room: Floats) -> float:
    """Shorten each row of v to less than its room, and move x by it; returns the longest move."""
    longest = 0.0
    for i in range(x.shape[0]):
        size = math.sqrt(v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
        scale = 0.0 if held[i] else min(1.0, room[i] / max(size, 1e-300))
        longest = max(longest, scale * size)
        for c in range(3):
            v[i, c] *= scale
            x[i, c] += v[i, c]
    return longest


def spread(laws: Laws, s: Strands, x: Floats, most: Index, tolerance: float) -> Index:
    """Move x (n_nodes, 3) [radii] towards the least energy; returns the number of steps.

    Steps solve (M + D) v = F, M the matrix of tension and stiffness and D a bound of the springs, with part
    of the last step added (heavy ball) as long as it leads downhill.

    Args:
        laws: of the energy.
        s: the strands.
        x: nodes.
        most: steps.
        tolerance: [radii] the end is reached when no node moves farther in a step.
    """
    n = x.shape[0]
    force, v, y, mid = np.empty((n, 3)), np.zeros((n, 3)), np.empty((n, 3)), np.empty((n, 3))
    diagonal, next1, next2 = np.empty(n), np.empty(n), np.empty(n)
    w1, w2, room = np.empty(n), np.empty(n), np.empty(n)
    pairs = np.empty((0, 2), np.int64)
    n_strands = s.closed.shape[0]
    slack, length, edge = np.empty(n_strands), np.empty(n_strands), np.empty(n_strands)
    moved = 1e300
    gliding = 0
    for step in range(most):
        if 4.0 * moved > SKIN:
            longest = _midpoints(s, x, mid)
            pairs = near_points(mid, max(laws.distance, 2.0 * LARGEST_MOVE) + longest + SKIN)
            _order(pairs)
            moved = 0.0
        strand_lengths(s, x, length, edge)
        for i in range(n):
            diagonal[i], next1[i], next2[i] = 1e-9, 0.0, 0.0
            for c in range(3):
                force[i, c] = 0.0
        find_slack(laws, s, length, slack)
        _add_bending(laws, s, x, edge, slack, force, diagonal, next1, next2)
        _add_tension(laws, s, x, edge, slack, force, diagonal, next1)
        _add_springs(laws, s, x, pairs, edge, force, diagonal)
        room_to_move(s, x, pairs, room)
        downhill = 0.0
        for i in range(n):
            if s.held[i]:
                diagonal[i] = 1e12
            for c in range(3):
                y[i, c] = force[i, c]
                downhill += force[i, c] * v[i, c]
        for k in range(s.closed.shape[0]):
            solve_band(s.first[k], s.first[k + 1], diagonal, next1, next2, w1, w2, y)
        gliding = gliding + 1 if downhill > 0.0 else 0
        memory = min(MEMORY, gliding / (gliding + 3.0))
        for i in range(n):
            for c in range(3):
                v[i, c] = memory * v[i, c] + y[i, c]
        largest = _stopped(x, v, s.held, room)
        moved += largest
        if largest < tolerance:
            return step + 1
    return most


compile_kernels(
    __name__,
    inline=("_distance", "_after", "_apart"),
    owning=("spread",),
)
