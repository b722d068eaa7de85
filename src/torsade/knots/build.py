"""From a diagram to a clean fiber: `build`.

A drawing by circle packing (`packing`) is lifted into space (`lift`), where it shows the diagram exactly. Then
strands are drawn short, smooth and apart without passing through each other (`spread`), so that it stays the
same knot. Open ends are led out (`leads`), all is sampled evenly, and the result is read again.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from torsade import curve
from torsade.centerline import Centerline
from torsade.errors import TorsadeError
from torsade.knots.drawing import SPACING, SPACING_RANGE, in_radii, known_radius
from torsade.knots.leads import cut_at, radius_of, way_out
from torsade.knots.lift import angles_of_ends, lifted
from torsade.knots.reading import reads_as
from torsade.knots.spread import Laws, Strands, spread
from torsade.topology.canonical import canonical_form
from torsade.topology.diagram import CIRCLE, Diagram, strand_name
from torsade.topology.projection import project
from torsade.topology.simplify import untwisted

__all__ = ["CLEARANCE", "H_KAPPA", "BuiltKnot", "build"]

FloatArray = NDArray[np.float64]

CLEARANCE = 2.1
"""Strands are at least so many radii apart, axis to axis: a gap of a tenth of a radius."""

H_KAPPA = 0.5
"""Nowhere does a fiber bend tighter than this over its radius."""

LEAD = 16.0  # [radii]
LEAD_RANGE = (5.0, 1e4)  # [radii]
TAILS = 2.5  # lengths of free ends [leads]

_LAWS = Laws(tension=1.0, stiffness=1.0, hard_stiffness=100.0, springs=20.0, distance=2.25, bend_radius=2.4)
_LEVELS = (
    (_LAWS._replace(tension=0.0), None, 150),  # room for what is drawn small
    (_LAWS, None, 2000),
    (_LAWS, 0.5, 1000),
)
"""Laws, edges of nodes newly set [radii], and steps."""

_REST = 1e-4  # spreading ends when no node moves farther in a step [radii]
_SMOOTHING = 0.3  # what is shorter is noise of nodes against nodes [radii]
_SAMPLED = 0.125  # edges of a curve from which all nodes are taken [radii]
_GAP = 4.0  # between pieces side by side, beyond what they reach [radii]
_MARGIN = 2.0  # from where strands turn back to where leads begin [radii]
_ROUNDS = 6
_FAILED = 2.0  # a curve that would have to be enlarged so much has not been spread


@dataclass(frozen=True, eq=False)
class BuiltKnot(Centerline):
    """A knot, link or tangle made from a diagram, ready to be pulled or written to a file.

    Attributes:
        strands: nodes [m], shapes (n, 3). Open strands run from their end 0 to their end 1.
        closed: which strands are closed.
        diagram: what it was made from, its open strands running as those of the fiber do.
        pulled: the clamped end, at -x, and the pulled end, at +x; None where ends leave evenly, or for none.
        radius: of the fiber h [m].
        clearance: smallest distance of two strands, or parts of one more than pi h apart along it [m].
        h_kappa: largest curvature times h.
    """

    diagram: Diagram = field(default_factory=Diagram.circle)
    pulled: str | None = None
    radius: float = 0.0
    clearance: float = 0.0
    h_kappa: float = 0.0


def build(
    diagram: Diagram,
    radius: float | str = 0.2e-3,
    *,
    length: float | str | None = None,
    lead: float | str | None = None,
    tail: float | str | None = None,
    spacing: float | str | None = None,
    pulled: str | None = None,
) -> BuiltKnot:
    """A loose, smooth and compact fiber that is the knot, link or tangle of a diagram.

    Nothing touches: axes are at least 2.1 h apart, and h kappa is at most 0.5. Pieces that are not connected
    lie side by side. The result is read again, and is certainly what the diagram is, with its labels. The fiber
    of the mirror image is the mirror image, z → -z, to the last bit.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        diagram: of a knot, a link or a tangle.
        radius: fiber radius h [m].
        length: of all closed strands, or of the one open strand [m]; by default the shortest that `build` makes.
            A closed knot is enlarged for it, an open one gets longer ends.
        lead: length from the knot to a clamped or pulled end [m], 5 radii or more; by default 16 radii.
        tail: length of free ends [m]; by default two and a half leads.
        spacing: greatest distance between nodes along a strand [m], one radius or less; by default half a radius.
        pulled: names of the clamped and the pulled end, such as "A1B1". They lie on the x axis and leave along it,
            the first along -x; free ends leave that line by 60 degrees. By default "A0A1" for one open strand
            and "A1B1" for two; the ends of more leave evenly.

    Raises:
        TorsadeError: a length out of range, ends that the diagram does not have, or, which no diagram tried has
            shown, a curve that does not come out as the diagram.
    """
    h = known_radius(radius)
    apart = SPACING if spacing is None else in_radii("spacing", spacing, SPACING_RANGE, h)
    n_open = len(diagram.ends) // 2
    for what, given in (("lead", lead), ("tail", tail)):
        if given is not None and not n_open:
            raise TorsadeError(f"a {what} is given, but all strands are closed; leave it out")
    straight = LEAD if lead is None else in_radii("lead", lead, LEAD_RANGE, h)
    free = TAILS * straight if tail is None else in_radii("tail", tail, LEAD_RANGE, h)
    total = None if length is None else in_radii("length", length, (1.0, 1e9), h)
    if total is not None and n_open and diagram.n_strands > 1:
        raise TorsadeError("length is for closed strands or one open strand; give lead and tail for these")
    return _built(diagram, diagram.outer, h, total, straight, free, apart, _known_pull(diagram, pulled))


def _known_pull(diagram: Diagram, pulled: str | None) -> str | None:
    """The clamped and the pulled end, checked."""
    n_open = len(diagram.ends) // 2
    if pulled is None:
        return {1: "A0A1", 2: "A1B1"}.get(n_open) if _has_usual_ends(diagram) else None
    names = re.findall(r"[A-Z]+\d+", pulled.strip().upper())
    usable = n_open in (1, 2) and _has_usual_ends(diagram)
    fits = len(names) == 2 and set(names) <= set(diagram.ends) and len({name[:1] for name in names}) == n_open
    if not usable or not fits:
        has = f"ends {' '.join(diagram.ends)}" if diagram.ends else "no ends"
        raise TorsadeError(
            f"pulled ends are {pulled!r} of a diagram with {has}; give the clamped, then the pulled end, one of "
            'each of two open strands, such as "A1B1", or both of one'
        )
    return "".join(names)


def _has_usual_ends(diagram: Diagram) -> bool:
    return sorted(diagram.ends) in (["A0", "A1"], ["A0", "A1", "B0", "B1"])


@lru_cache(maxsize=64)
def _built(
    diagram: Diagram,
    outer: tuple[int, ...],
    h: float,
    total: float | None,
    lead: float,
    tail: float,
    spacing: float,
    pulled: str | None,
) -> BuiltKnot:
    """`build` of arguments that are checked; lengths in radii. The outer faces are told apart by `outer`."""
    drawn = _standing(untwisted(diagram))
    closed = tuple(not drawn.is_open(k) for k in range(drawn.n_strands))
    reach, shapes = _shapes(drawn, drawn.outer, pulled)
    make = _Maker(drawn, shapes, closed, reach, pulled, spacing)
    if total is None:
        strands, gap, bend = make.clear(1.0, lead, tail)
    elif all(closed):
        strands, gap, bend = make.enlarged(total, h)
    else:
        strands, gap, bend = make.with_longer_ends(total, h)
    if not reads_as(project(strands, closed).diagram, _usual(drawn)):
        raise TorsadeError("the curve made of this diagram is another knot; simplify the diagram first")
    return BuiltKnot(tuple(h * x for x in strands), closed, drawn, pulled, h, h * gap, bend)


Built = tuple[list[FloatArray], float, float]
"""Strands, their clearance and h kappa; lengths in radii."""


@dataclass(frozen=True)
class _Maker:
    """Shapes enlarged, led out, put side by side and sampled; lengths in radii."""

    diagram: Diagram
    shapes: tuple[FloatArray, ...]
    closed: tuple[bool, ...]
    reach: float
    pulled: str | None
    spacing: float

    def at(self, factor: float, lead: float, tail: float) -> Built:
        """Shapes enlarged by a factor, with leads and tails."""
        placed = _placed(self, factor, lead, tail)
        strands = [
            curve.resample(x, spacing=self.spacing, closed=c)
            for x, c in zip(placed, self.closed, strict=True)
        ]
        gap = curve.clearance(strands, self.closed, math.pi).distance
        bends = [curve.curvature(x, c) for x, c in zip(strands, self.closed, strict=True)]
        return strands, gap, max(float(kappa.max(initial=0.0)) for kappa in bends)

    def length(self, strands: Sequence[FloatArray]) -> float:
        return sum(curve.length(x, c) for x, c in zip(strands, self.closed, strict=True))

    def clear(self, factor: float, lead: float, tail: float) -> Built:
        """The smallest enlargement, from a factor on, that keeps to `CLEARANCE` and `H_KAPPA`."""
        for _ in range(_ROUNDS):
            strands, gap, bend = self.at(factor, lead, tail)
            lacking = max(CLEARANCE / gap, bend / H_KAPPA)
            if lacking <= 1.0:
                return strands, gap, bend
            factor *= lacking * (1 + 1e-3)
            if lacking > _FAILED:
                break
        raise TorsadeError(
            f"the curve of this diagram has strands {gap:.3g} radii apart and h kappa {bend:.3g}, and enlarging "
            "does not help; simplify the diagram, or give longer leads"
        )

    def enlarged(self, total: float, h: float) -> Built:
        """Closed strands of this length together."""
        least = self.length(self.clear(1.0, 0.0, 0.0)[0])
        _at_least(total, least, h)
        return self._of_length(total, total / least, 0.0)

    def with_longer_ends(self, total: float, h: float) -> Built:
        """One open strand of this length, its two ends equal."""
        shortest = LEAD_RANGE[0]
        least = self.length(self.clear(1.0, shortest, shortest)[0])
        _at_least(total, least, h)
        return self._of_length(total, 1.0, shortest + (total - least) / 2)

    def _of_length(self, total: float, factor: float, lead: float) -> Built:
        """A first guess improved until the length is right."""
        for _ in range(_ROUNDS):
            strands, gap, bend = self.clear(factor, lead, lead)
            off = total - self.length(strands)
            if abs(off) <= 1e-12 * total:
                break
            factor, lead = (factor, lead + off / 2) if lead else (factor * (1 + off / (total - off)), 0.0)
        return strands, gap, bend


def _at_least(total: float, least: float, h: float) -> None:
    if total < least * (1 - 1e-9):
        raise TorsadeError(
            f"a length of {total * h:.4g} m is asked for, {total:.4g} radii, and the shortest fiber made of this "
            f"diagram has {least * h:.6g} m, {least:.5g} radii; give that much, or a smaller radius"
        )


def _standing(diagram: Diagram) -> Diagram:
    """The diagram with open strands running from the end of the smaller name."""
    back = []
    for k, start in enumerate(diagram.starts):
        if start < 0:
            first, last = diagram.ends[start], diagram.ends[diagram.edges[_last_edge(diagram, k)][1]]
            if first > last:
                back.append(k)
    return diagram.reverse(back) if back else diagram


def _last_edge(diagram: Diagram, strand: int) -> int:
    return len(diagram.edge_strand) - 1 - diagram.edge_strand[::-1].index(strand)


def _usual(diagram: Diagram) -> Diagram:
    """The diagram with ends named as `project` names them, A0 and A1 on the first strand and so on."""
    names = list(diagram.ends)
    for k, start in enumerate(diagram.starts):
        if start < 0:
            names[start] = strand_name(k) + "0"
            names[diagram.edges[_last_edge(diagram, k)][1]] = strand_name(k) + "1"
    return diagram.renamed(names)


@lru_cache(maxsize=256)
def _shapes(
    diagram: Diagram, outer: tuple[int, ...], pulled: str | None
) -> tuple[float, tuple[FloatArray, ...]]:
    """Curves [radii] of all strands, each piece by itself, and how far open strands reach before they lead away.

    Ends of open strands lie where spreading left them, on straight legs.
    """
    angles = {name: begin for name, (begin, _) in angles_of_ends(diagram, pulled).items()}
    shapes: dict[int, FloatArray] = {}
    reach = 0.0
    for strands in _pieces(diagram):
        if diagram.starts[strands[0]] == CIRCLE:
            turn = np.arange(0.0, 2 * np.pi, _SAMPLED * H_KAPPA)
            shapes[strands[0]] = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]) / H_KAPPA
            continue
        is_open = diagram.is_open(strands[0])
        curves = _spread(diagram, strands, angles if is_open else {})
        if is_open:
            reach = radius_of([x for k, x in zip(strands, curves, strict=True) if diagram.is_open(k)])
            reach = (
                max(
                    [
                        reach,
                        *(
                            float(np.linalg.norm(x, axis=1).max())
                            for k, x in zip(strands, curves, strict=True)
                            if not diagram.is_open(k)
                        ),
                    ]
                )
                + _MARGIN
            )
        shapes |= dict(zip(strands, curves, strict=True))
    found = tuple(shapes[k] for k in range(diagram.n_strands))
    for x in found:
        x.flags.writeable = False
    return reach, found


def _pieces(diagram: Diagram) -> list[list[int]]:
    """Numbers of the strands of each piece, in the order of their first strands."""
    found: dict[int, list[int]] = {}
    for k, start in enumerate(diagram.starts):
        key = -1 - k if start == CIRCLE else diagram.piece_at[start]
        found.setdefault(key, []).append(k)
    return list(found.values())


def _spread(diagram: Diagram, strands: list[int], angles: dict[str, float]) -> list[FloatArray]:
    """One piece, drawn, lifted and spread on two levels; sampled finely."""
    x = lifted(diagram, strands, angles)
    closed = [not diagram.is_open(k) for k in strands]
    seen = project(x, closed).diagram
    if canonical_form(seen) != canonical_form(_usual(_piece(diagram, strands))):
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


def _placed(make: _Maker, factor: float, lead: float, tail: float) -> list[FloatArray]:
    """The curves enlarged, open strands led out, closed pieces beside them or beside each other."""
    diagram = make.diagram
    angles = angles_of_ends(diagram, make.pulled)
    out: dict[int, FloatArray] = {}
    edge = -math.inf
    gap_angle, gap_width = _widest_gap([last for _, last in angles.values()])
    for strands in sorted(_pieces(diagram), key=lambda s: not diagram.is_open(s[0])):
        x = [factor * make.shapes[k] for k in strands]
        if diagram.is_open(strands[0]):
            x = [
                _led_out(make, k, c, factor, angles, (lead, tail)) if diagram.is_open(k) else c
                for k, c in zip(strands, x, strict=True)
            ]
            edge = factor * make.reach
        else:
            x, edge = _beside(x, edge, gap_angle, gap_width if angles else math.pi)
        out |= dict(zip(strands, x, strict=True))
    return [out[k] for k in range(diagram.n_strands)]


def _widest_gap(angles: Sequence[float]) -> tuple[float, float]:
    """Middle and width [rad] of the widest gap between directions; all around where there are none."""
    if not angles:
        return 0.0, 2 * math.pi
    around = sorted(a % (2 * math.pi) for a in angles)
    widths = [
        (b - a) % (2 * math.pi) or 2 * math.pi for a, b in zip(around, around[1:] + around[:1], strict=True)
    ]
    k = int(np.argmax(np.round(widths, 9)))
    return around[k] + widths[k] / 2, widths[k]


def _beside(x: list[FloatArray], edge: float, angle: float, width: float) -> tuple[list[FloatArray], float]:
    """A piece moved out along an angle until it is clear of what reaches to the edge, and of leads."""
    nodes = np.concatenate(x)
    middle = (nodes.min(axis=0) + nodes.max(axis=0)) / 2
    size = float(np.linalg.norm(nodes - middle, axis=1).max())
    if edge == -math.inf:
        return [c - middle for c in x], size
    away = edge + _GAP + size
    if width < math.pi:
        away = max(away, (size + _GAP) / math.sin(width / 2))
    shift = away * np.array([math.cos(angle), math.sin(angle), 0.0]) - middle
    return [c + shift for c in x], away + size


def _led_out(
    make: _Maker,
    strand: int,
    x: FloatArray,
    factor: float,
    angles: dict[str, tuple[float, float]],
    lengths: tuple[float, float],
) -> FloatArray:
    """An open strand with its two leads."""
    diagram = make.diagram
    reach = factor * make.reach
    x = cut_at(x, reach)
    tips = diagram.starts[strand], diagram.edges[_last_edge(diagram, strand)][1]
    for tip in reversed(tips):
        name = diagram.ends[tip]
        is_pulled = make.pulled is None or name in (make.pulled[:2], make.pulled[2:])
        out = way_out(x, angles[name][1], reach, is_pulled, lengths[0 if is_pulled else 1])
        x = np.concatenate([x, out])[::-1]
    return x
