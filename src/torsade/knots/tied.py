"""Fibers by name: what the catalogue has, built."""

from __future__ import annotations

from torsade.knots.build import BuiltKnot, build
from torsade.knots.drawing import known_radius
from torsade.knots.finding import interpret, known_bend, known_strand

__all__ = ["bend", "strand", "tie"]

Size = float | str | None

STRAND_LEAD = 26.0
"""Straight ends of a knot in one strand [radii]: what it takes up as it tightens comes from them."""


def tie(
    name: str,
    radius: float | str = 0.2e-3,
    *,
    length: Size = None,
    lead: Size = None,
    tail: Size = None,
    spacing: Size = None,
    pulled: str | None = None,
) -> BuiltKnot:
    """The fiber of anything that has a name or a code: `build` of its diagram, its ends led as the name says.

    >>> import torsade as ts
    >>> knot = ts.knots.tie("figure-eight", radius="1 mm")
    >>> knot.pulled, len(knot.strands), knot.clearance >= 2e-3
    ('A0A1', 1, True)

    Arguments are those of `build`.

    Raises:
        TorsadeError: nothing is called so, or what `build` refuses.
    """
    entry = interpret(name)
    ends = entry.pulled if pulled is None else pulled
    return build(entry.diagram, radius, length=length, lead=lead, tail=tail, spacing=spacing, pulled=ends)


def bend(
    name: str,
    radius: float | str = 0.2e-3,
    lead: Size = None,
    spacing: Size = None,
    pulled: str | None = None,
    tail: Size = None,
) -> BuiltKnot:
    """A loose, smooth fiber of a bend, or of another knot of two strands: a suture, a variant of the thesis.

    The clamped and the pulled end lie on the x axis and leave along it, so nothing turns the knot as a whole;
    the free ends turn away from it by 60 degrees. Nothing touches: parts that are not neighbours are 2.1
    radii apart, and h kappa is at most 0.5.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        name: such as "reef", "zeppelin", "alpine24" or "5,-3".
        radius: fiber radius h [m].
        lead: length from the knot to the clamped and to the pulled end [m], 5 radii or more, 16 radii by
            default; longer where the strand needs more to come to the axis.
        spacing: greatest distance between nodes along a strand [m], one radius or less; half a radius by
            default.
        pulled: the clamped end, then the pulled end, one of `PULLS`; by default what the name says: "A1B0"
            for the thief and the grief, "A1B1" for a bend.
        tail: length of the free ends [m]; 25 radii by default.

    Raises:
        TorsadeError: a name or a pull that is not known, or a length out of range.
    """
    return tie(known_bend(name).name, radius, lead=lead, tail=tail, spacing=spacing, pulled=pulled)


def strand(
    name: str = "overhand", radius: float | str = 0.2e-3, lead: Size = None, spacing: Size = None
) -> BuiltKnot:
    """A loose, smooth knot in one open strand, its ends led out along -x and +x.

    Args:
        name: such as "overhand", "figure-eight", "overhand-7" or "open 5_2".
        radius: fiber radius h [m].
        lead: length of each straight end [m]; 26 radii by default.
        spacing: greatest distance between nodes along the strand [m]; half a radius by default.

    Raises:
        TorsadeError: a name that is not known, or a length out of range.
    """
    ends = STRAND_LEAD * known_radius(radius) if lead is None else lead
    return tie(known_strand(name).name, radius, lead=ends, spacing=spacing)
