"""Curves of strands: drawn, lifted and spread, before ends are led out. Lengths are in radii."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade import curve
from torsade.errors import TorsadeError
from torsade.knots.leads import radius_of
from torsade.knots.lift import angles_of_ends, lifted
from torsade.knots.spread import Laws, Strands, spread
from torsade.topology.canonical import canonical_form
from torsade.topology.diagram import CIRCLE, Diagram, strand_name
from torsade.topology.projection import project

__all__ = ["Shapes", "last_edge", "pieces", "shapes", "standing", "usual"]

FloatArray = NDArray[np.float64]

_LAWS = Laws(tension=1.0, stiffness=1.0, hard_stiffness=100.0, springs=20.0, distance=2.25, bend_radius=2.4)
_LEVELS = (
    (_LAWS._replace(tension=0.0), None, 150),  # room for what is drawn small
    (_LAWS, None, 2000),
    (_LAWS, 0.7, 2500),
    (_LAWS, 0.5, 1500),
)
"""Laws, edges of nodes newly set [radii], and steps."""

_REST = 1e-4  # spreading ends when no node moves farther in a step [radii]
_SMOOTHING = 0.3  # what is shorter is noise of nodes against nodes [radii]
_SAMPLED = 0.125  # edges of a curve from which all nodes are taken [radii]
_MARGIN = 2.0  # from where strands turn back to where leads begin [radii]
_CIRCLE = 2.0  # radius of a circle without crossings [radii]


def standing(diagram: Diagram) -> Diagram:
    """The diagram with open strands running from the end of the smaller name."""
    back = []
    for k, start in enumerate(diagram.starts):
        if start < 0:
            first, last = diagram.ends[start], diagram.ends[diagram.edges[last_edge(diagram, k)][1]]
            if first > last:
                back.append(k)
    return diagram.reverse(back) if back else diagram


def last_edge(diagram: Diagram, strand: int) -> int:
    return len(diagram.edge_strand) - 1 - diagram.edge_strand[::-1].index(strand)


def usual(diagram: Diagram) -> Diagram:
    """The diagram with ends named as `project` names them, A0 and A1 on the first strand and so on."""
    names = list(diagram.ends)
    for k, start in enumerate(diagram.starts):
        if start < 0:
            names[start] = strand_name(k) + "0"
            names[diagram.edges[last_edge(diagram, k)][1]] = strand_name(k) + "1"
    return diagram.renamed(names)


class Shapes(NamedTuple):
    """Curves that are clear of each other and smooth, but for an enlargement.

    Attributes:
        diagram: what they show.
        curves: nodes of each strand, shapes (n, 3); ends of open ones lie on straight legs.
        reach: distance from the origin at which open strands are led away.
        pulled: the clamped and the pulled end, or None.
    """

    diagram: Diagram
    curves: tuple[FloatArray, ...]
    reach: float
    pulled: str | None


@lru_cache(maxsize=256)
def shapes(diagram: Diagram, outer: tuple[int, ...], pulled: str | None) -> Shapes:
    """The curves of all strands, each piece by itself; outer is the diagram's, which equality leaves out."""
    angles = {name: begin for name, (begin, _) in angles_of_ends(diagram, pulled).items()}
    curves: dict[int, FloatArray] = {}
    reach = 0.0
    for strands in pieces(diagram):
        if diagram.starts[strands[0]] == CIRCLE:
            turn = np.arange(0.0, 2 * np.pi, _SAMPLED / _CIRCLE)
            curves[strands[0]] = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]) * _CIRCLE
            continue
        is_open = diagram.is_open(strands[0])
        spread_out = _spread(diagram, strands, angles if is_open else {})
        if is_open:
            reach = radius_of(
                [c for k, c in zip(strands, spread_out, strict=True) if diagram.is_open(k)],
                [c for k, c in zip(strands, spread_out, strict=True) if not diagram.is_open(k)],
            )
            reach += _MARGIN
        curves |= dict(zip(strands, spread_out, strict=True))
    found = tuple(curves[k] for k in range(diagram.n_strands))
    for x in found:
        x.flags.writeable = False
    return Shapes(diagram, found, reach, pulled)


def pieces(diagram: Diagram) -> list[list[int]]:
    """Numbers of the strands of each piece, in the order of their first strands."""
    found: dict[int, list[int]] = {}
    for k, start in enumerate(diagram.starts):
        key = -1 - k if start == CIRCLE else diagram.piece_at[start]
        found.setdefault(key, []).append(k)
    return list(found.values())


def _spread(diagram: Diagram, strands: list[int], angles: dict[str, float]) -> list[FloatArray]:
    """One piece, drawn, lifted and spread on levels ever finer; sampled finely."""
    x = lifted(diagram, strands, angles)
    closed = [not diagram.is_open(k) for k in strands]
    seen = project(x, closed).diagram
    if canonical_form(seen) != canonical_form(usual(_piece(diagram, strands))):
        raise TorsadeError("the drawing made of this diagram shows another one; simplify the diagram first")
    for laws, spacing, steps in _LEVELS:
        if spacing is not None:
            x = [curve.resample(c, spacing=spacing, closed=o) for c, o in zip(x, closed, strict=True)]
        first = np.concatenate([[0], np.cumsum([len(c) for c in x])]).astype(np.int64)
        nodes = np.concatenate(x)
        held = np.zeros(len(nodes), dtype=np.bool_)
        for k, is_closed in enumerate(closed):
            if not is_closed:
                held[[first[k], first[k + 1] - 1]] = True
        number = np.repeat(np.arange(len(x)), np.diff(first))
        spread(laws, Strands(first, np.array(closed), number, held), nodes, steps, _REST)
        x = np.split(nodes, first[1:-1])
    fine = [curve.resample(c, spacing=_SAMPLED, closed=o) for c, o in zip(x, closed, strict=True)]
    return [curve.smooth(c, _SMOOTHING, o) for c, o in zip(fine, closed, strict=True)]


def _piece(diagram: Diagram, strands: list[int]) -> Diagram:
    """One piece by itself."""
    if len(strands) == diagram.n_strands:
        return diagram
    ports = sorted(diagram.pieces[diagram.piece_at[diagram.starts[strands[0]]]])
    m = len(diagram.ends) if diagram.is_open(strands[0]) else 0
    new = {p: k for k, p in enumerate(p for p in ports if p >= 0)} | {p: p for p in ports if p < 0}
    mate = [new[diagram.mate[p]] for p in ports if p >= 0] + [new[diagram.mate[p]] for p in range(-m, 0)]
    return Diagram.assemble(mate, [new[diagram.starts[k]] for k in strands], diagram.ends[:m])
