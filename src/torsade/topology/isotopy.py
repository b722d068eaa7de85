"""Whether polygons become others without passing through each other: shown by triangle moves, or not shown.

The answer yes is a proof, up to round-off: a chain of triangle moves, none of which another edge pierces. The
answer no says only that no such chain was found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsade.arrays import Bools, Floats
from torsade.curve import length
from torsade.topology.triangle_moves import OUT, RUN, Chain, enclose_all, move_all, take_out

__all__ = ["carried_over", "chain_of", "thinned", "thinned_to"]

_SHAKE = 1e-8
"""How far nodes are put from where they stand, in edges, so that none lies on a line or plane of others."""

_HALVINGS = 6
"""Rounds of halved moves without a node arriving, after which none will."""

_COARSENINGS = (0.0, 1.0, 2.0, 4.0, 8.0)
"""Lengths of edges that nodes are taken out up to, one after another, in units of the scale."""


def carried_over(
    before: Sequence[Floats], after: Sequence[Floats], closed: Sequence[bool], scale: float
) -> bool:
    """Whether nodes can be moved from one place to another, strands passing through no strand.

    First they are moved one by one. Where noise is larger than edges are long these are entangled with
    their own neighbours; then nodes are taken out first, on both sides the same ones, until edges are
    as long as `scale`, and longer.

    Args:
        before: nodes [m] of each strand, shapes (n, 3).
        after: the same nodes elsewhere; ends of open strands must not move.
        closed: which strands are closed.
        scale: a length [m] below which the shape of strands means nothing.
    """
    for coarse in _COARSENINGS:
        start, goal = chain_of(before, closed), chain_of(after, closed, before)
        if coarse:
            every = np.ones(len(start.x), dtype=bool)
            for share in (0.25, 0.5, 1.0):
                take_out(start, every, share * coarse * scale)
            gone = start.after == OUT
            if take_out(goal, gone, np.inf):
                continue
        if move_all(start, goal.x, np.empty(3), _HALVINGS) == 0:
            return True
    return False


def thinned_to(strands: Sequence[Floats], closed: Sequence[bool], keep: Sequence[Bools]) -> bool:
    """Whether all nodes but some can be taken out one after another, strands passing through no strand.

    Args:
        strands: nodes [m] of each, shapes (n, 3).
        closed: which are closed.
        keep: which nodes of each are to stay, shapes (n,); ends of open strands must.
    """
    return int(take_out(chain_of(strands, closed), ~np.concatenate(keep), np.inf)) == 0


def thinned(x: Floats) -> Floats:
    """A closed polygon of the same knot with as few nodes as taking them out one by one leaves, 3 or more.

    Args:
        x: nodes, shape (n, 3).
    """
    chain = chain_of([x], [True])
    take_out(chain, np.ones(len(x), dtype=bool), np.inf)
    return np.asarray(x[chain.after != OUT])


def chain_of(strands: Sequence[Floats], closed: Sequence[bool], like: Sequence[Floats] = ()) -> Chain:
    """All strands in one array, each node put a trifle away from where it stands; the same every time.

    Args:
        strands: nodes [m] of each, shapes (n, 3).
        closed: which are closed.
        like: strands of as many nodes, with whose origin and trifles these are to be compared.
    """
    like = like or strands
    x = np.concatenate(strands) - like[0][0]  # far from the origin a trifle would be lost
    edge = sum(length(s, c) for s, c in zip(like, closed, strict=True)) / len(x)
    x += _SHAKE * edge * np.random.default_rng(0).uniform(-1, 1, x.shape)
    after = np.arange(1, len(x) + 1)
    first = 0
    for s, is_closed in zip(strands, closed, strict=True):
        after[first + len(s) - 1] = first if is_closed else -1
        first += len(s)
    before = np.full(len(x), -1)
    before[after[after >= 0]] = np.flatnonzero(after >= 0)
    boxes = (-(-len(x) // RUN), 3)
    chain = Chain(x, before, after, np.empty(boxes), np.empty(boxes))
    enclose_all(chain)
    return chain
