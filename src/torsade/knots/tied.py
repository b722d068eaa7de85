"""The bends of the catalogue as fibers: `bend`."""

from __future__ import annotations

from dataclasses import dataclass, fields

from torsade.errors import TorsadeError
from torsade.knots.bends import PULLS, find_bend, usual_name
from torsade.knots.build import BuiltKnot, build

__all__ = ["BuiltBend", "bend"]


@dataclass(frozen=True, eq=False)
class BuiltBend(BuiltKnot):
    """A bend ready to be pulled or written to a file.

    Attributes:
        name: one of `bend_names()`.
        strands: nodes [m] of strands A and B, shapes (n, 3), each from its end 0 to its end 1.
        pulled: one of `PULLS`; the first end is clamped at -x, the second pulled along +x.
    """

    name: str = ""


def bend(
    name: str,
    radius: float | str = 0.2e-3,
    lead: float | str | None = None,
    spacing: float | str | None = None,
    pulled: str | None = None,
) -> BuiltBend:
    """A loose, smooth fiber of a bend of the catalogue, made by `build` of its diagram.

    The clamped and the pulled end lie on the x axis and leave along it, so nothing turns the knot as a whole;
    the free ends turn away from it by 60°. Nothing touches: parts that are not neighbours are 2.1 radii
    apart, and radius * kappa is at most 0.5.

    Lengths are numbers in metres, or text with a unit such as "0.2 mm".

    Args:
        name: one of `bend_names()`, or another name of it.
        radius: fiber radius h [m].
        lead: length from the knot to the clamped and to the pulled end [m], 5 radii or more, 16 radii by
            default; longer where the strand needs more to come to the axis. The free ends are two and a half
            times as long.
        spacing: greatest distance between nodes along a strand [m], one radius or less; half a radius by
        default.
        pulled: one of `PULLS`, the clamped end first; by default what the name says: "A1B0" for the thief and
            the grief, "A1B1" for a bend.

    Raises:
        TorsadeError: a name or a pull that is not in the list, or a length out of range.
    """
    entry, usual = find_bend(name)
    ends = usual if pulled is None else pulled.strip().upper()
    if ends not in PULLS:
        raise TorsadeError(
            f"pulled ends {ends!r} are unknown; choose one of {', '.join(PULLS)}, clamped end first"
        )
    built = build(entry.diagram, radius, lead=lead, spacing=spacing, pulled=ends)
    return BuiltBend(**{f.name: getattr(built, f.name) for f in fields(built)}, name=usual_name(name))
