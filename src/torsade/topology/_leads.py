"""Ends that lie in the midst of a drawing are led out, and all are put in order around it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsade.topology._ports import faces
from torsade.topology.codes._planar import ends_around
from torsade.topology.diagram import Diagram, strand_name
from torsade.topology.draft import Draft

__all__ = ["lead_out"]


def lead_out(
    mate: Sequence[int], starts: list[int], outer: list[int], tips: Sequence[Sequence[float]]
) -> tuple[Diagram, int]:
    """A tangle whose ends stand on the circle around it.

    Args:
        mate: as in `Diagram`, with the two ends of each open strand side by side, in any order.
        starts: as in `Diagram`.
        outer: darts with what is outside on their left; the first of each piece counts.
        tips: where the ends are in the plane of the view, shape (n_ends, 2).

    Returns:
        The diagram, and how many crossings were added at the end of its list.
    """
    m = len(tips)
    names = [""] * m
    for k, s in enumerate(starts):
        if s < 0:
            names[s], names[s + 1] = strand_name(k) + "0", strand_name(k) + "1"
    draft = Draft.of_ports(mate, starts, names, outer)
    n_led_out = sum(_led_out(draft, end) for end in range(-m, 0))
    blocks = ends_around(draft.mate, m)
    order = [end for block in blocks for end in block]
    angles = _angles(tips)
    if len(blocks) > 1:
        seen = sorted(range(-m, 0), key=lambda end: (angles[end], end))
        if not _ordered(draft, seen).genus:
            order = seen
        else:
            turned = [_turned(block, angles) for block in blocks]
            order = [end for block in sorted(turned, key=lambda b: angles[b[0]]) for end in block]
    k = order.index(-m)
    return _ordered(draft, order[k:] + order[:k]), n_led_out


def _led_out(draft: Draft, end: int) -> int:
    """Lead one end out above everything; return over how many edges it went."""
    sides, at = faces(draft.mate, {p: p for p in range(-len(draft.ends), 0)})  # they go around all tips
    outside = _outside(draft, at, end)
    came: dict[int, tuple[int, int]] = {at[end]: (-1, 0)}
    layer = [at[end]]
    while not outside & came.keys():
        following = []
        for f in layer:
            for p in sides[f]:
                g = at[draft.mate[p]]
                if g not in came:
                    came[g] = f, p
                    following.append(g)
        layer = following
    f = min(outside & came.keys())
    path: list[int] = []
    while f != at[end]:
        f, dart = came[f]
        path.insert(0, dart)
    p = draft.mate[end]
    for dart in path:
        p = draft.cross(p, dart, over=True)
    draft.join(p, end)
    return len(path)


def _outside(draft: Draft, at: list[int], end: int) -> set[int]:
    """The outer face of the piece of an end; that of the end itself where the strand crosses nothing."""
    mate = draft.mate
    piece, todo = {end}, [end]
    while todo:
        p = todo.pop()
        near = [mate[p]] if p < 0 else [mate[p], p & ~3 | p + 1 & 3]
        todo += [q for q in near if q not in piece]
        piece.update(near)
    return next(({at[p]} for p in draft.outer if p in piece), {at[end]})


def _angles(tips: Sequence[Sequence[float]]) -> list[float]:
    """The angle at which each end is seen from the middle of all."""
    x = np.asarray(tips, dtype=np.float64)
    x = x - (x.min(axis=0) + x.max(axis=0)) / 2
    angles: list[float] = np.arctan2(x[:, 1], x[:, 0]).tolist()
    return angles


def _turned(block: list[int], angles: list[float]) -> list[int]:
    """The ends of a piece begun after the widest gap between two."""
    gaps = [(angles[end] - angles[block[k - 1]]) % (2 * np.pi) for k, end in enumerate(block)]
    k = int(np.argmax(gaps))
    return block[k:] + block[:k]


def _ordered(draft: Draft, order: list[int]) -> Diagram:
    """The diagram with its ends in this order, its outer darts those of closed pieces."""
    diagram = draft.freeze(order)
    return replace(
        diagram, outer=tuple(p for p in diagram.outer if diagram.pieces[diagram.piece_at[p]][0] >= 0)
    )
