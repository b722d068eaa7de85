"""From a diagram to a clean fiber: `build`.

A drawing by circle packing (`packing`) is lifted into space (`lift`), where it shows the diagram exactly.
Then strands are drawn short, smooth and apart without passing through each other (`spread`), so that it stays
the same knot. Open ends are led out (`leads`), all is sampled evenly, and the result is read again.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from torsade import curve
from torsade.centerline import Centerline
from torsade.errors import TorsadeError, listed, quoted
from torsade.knots.drawing import SPACING, SPACING_RANGE, in_radii, known_radius
from torsade.knots.placing import placed
from torsade.knots.reading import reads_as
from torsade.knots.shape import Shapes, shapes, standing, usual
from torsade.topology.diagram import Diagram
from torsade.topology.projection import project
from torsade.topology.simplify import simplify, untwisted

__all__ = ["CLEARANCE", "H_KAPPA", "BuiltKnot", "build"]

FloatArray = NDArray[np.float64]

CLEARANCE = 2.1
"""Strands are at least so many radii apart, axis to axis: a gap of a tenth of a radius."""

H_KAPPA = 0.5
"""Nowhere does a fiber bend tighter than this over its radius."""

LEAD = 16.0  # [radii]
LEAD_RANGE = (5.0, 1e4)  # [radii]
TAIL = 25.0  # the median of the free ends of the published bends [radii]

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
    lie side by side. The result is read again, and is certainly what the diagram is, with its labels. The
    fiber of the mirror image is the mirror image, z → -z, to the last bit.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        diagram: of a knot, a link or a tangle.
        radius: fiber radius h [m].
        length: of all closed strands, or of the one open strand [m]; by default the shortest that `build`
            makes. A closed knot is enlarged for it, an open one gets longer ends.
        lead: length from the knot to a clamped or pulled end [m], 5 radii or more; by default 16 radii.
        tail: length of free ends [m]; by default 25 radii.
        spacing: greatest distance between nodes along a strand [m], one radius or less; by default half a
        radius.
        pulled: names of the clamped and the pulled end, such as "A1B1". They lie on the x axis and leave
            along it, the first along -x; free ends leave that line by 60 degrees. By default "A0A1" for one
            open strand and "A1B1" for two; the ends of more leave evenly.

    Raises:
        TorsadeError: a length out of range, ends that the diagram does not have, or, which no diagram tried
            has shown, a curve that does not come out as the diagram.
    """
    h = known_radius(radius)
    apart = SPACING if spacing is None else in_radii("spacing", spacing, SPACING_RANGE, h)
    n_open = len(diagram.ends) // 2
    for what, given in (("lead", lead), ("tail", tail)):
        if given is not None and not n_open:
            raise TorsadeError(f"a {what} is given, but all strands are closed; leave it out")
    straight = LEAD if lead is None else in_radii("lead", lead, LEAD_RANGE, h)
    free = TAIL if tail is None else in_radii("tail", tail, LEAD_RANGE, h)
    total = None if length is None else in_radii("length", length, (1.0, 1e9), h)
    if total is not None and n_open and diagram.n_strands > 1:
        raise TorsadeError("length is for closed strands or one open strand; give lead and tail for these")
    return _built(diagram, diagram.outer, h, total, straight, free, apart, _known_pull(diagram, pulled))


def _known_pull(diagram: Diagram, pulled: str | None) -> str | None:
    """The clamped and the pulled end, checked."""
    n_open = len(diagram.ends) // 2
    if pulled is None:
        return {1: "A0A1", 2: "A1B1"}.get(n_open) if _hasusual_ends(diagram) else None
    names = re.findall(r"[A-Z]+\d+", pulled.strip().upper())
    usable = n_open in (1, 2) and _hasusual_ends(diagram)
    fits = len(names) == 2 and set(names) <= set(diagram.ends) and len({name[:1] for name in names}) == n_open
    if not usable or not fits:
        has = f"ends {listed(diagram.ends)}" if diagram.ends else "no ends"
        raise TorsadeError(
            f"pulled ends are {quoted(pulled)} of a diagram with {has}; give the clamped, then the pulled "
            'end, one of each of two open strands, such as "A1B1", or both of one'
        )
    return "".join(names)


def _hasusual_ends(diagram: Diagram) -> bool:
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
    arguments = h, total, lead, tail, spacing, pulled
    refused: TorsadeError | None = None
    for drawing in _drawings(diagram):
        try:
            return _made(standing(untwisted(drawing)), *arguments)
        except _NotApartError as error:
            refused = refused or error
    assert refused is not None  # the first drawing is the diagram itself
    raise refused


class _NotApartError(TorsadeError):
    """What a drawing shows small has not got apart; another drawing of the same may."""


def _drawings(diagram: Diagram) -> Iterator[Diagram]:
    """The diagram, one with fewer crossings, and the diagram with other faces outside, longest first."""
    yield diagram
    simpler = simplify(diagram)
    if simpler.n_crossings < diagram.n_crossings:
        yield simpler
    if not diagram.ends and len(diagram.pieces) == 1:
        for face in sorted(diagram.faces, key=len, reverse=True):
            yield replace(diagram, outer=(face[0],))


def _made(
    drawn: Diagram,
    h: float,
    total: float | None,
    lead: float,
    tail: float,
    spacing: float,
    pulled: str | None,
) -> BuiltKnot:
    """The fiber of a diagram without nugatory crossings."""
    closed = tuple(not drawn.is_open(k) for k in range(drawn.n_strands))
    make = _Maker(shapes(drawn, drawn.outer, pulled), closed, spacing)
    if total is None:
        strands, gap, bend = make.clear(1.0, lead, tail)
    elif all(closed):
        strands, gap, bend = make.enlarged(total, h)
    else:
        strands, gap, bend = make.with_longer_ends(total, h)
    if not reads_as(project(strands, closed).diagram, usual(drawn)):
        raise _NotApartError("the curve made of this diagram is another knot; simplify the diagram first")
    return BuiltKnot(tuple(h * x for x in strands), closed, drawn, pulled, h, h * gap, bend)


Built = tuple[list[FloatArray], float, float]
"""Strands, their clearance and h kappa; lengths in radii."""


@dataclass(frozen=True)
class _Maker:
    """Shapes enlarged, led out, put side by side and sampled; lengths in radii."""

    shapes: Shapes
    closed: tuple[bool, ...]
    spacing: float

    def at(self, factor: float, lead: float, tail: float) -> Built:
        """Shapes enlarged by a factor, with leads and tails."""
        curves = placed(self.shapes, factor, lead, tail)
        strands = [
            curve.resample(x, spacing=self.spacing, closed=c)
            for x, c in zip(curves, self.closed, strict=True)
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
        raise _NotApartError(
            f"the curve of this diagram has strands {gap:.3g} radii apart and h kappa {bend:.3g}, and "
            "enlarging does not help; simplify the diagram, or give longer leads"
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
            f"a length of {total * h:.4g} m is asked for, {total:.4g} radii, and the shortest fiber made of "
            f"this diagram has {least * h:.6g} m, {least:.5g} radii; give that much, or a smaller radius"
        )
