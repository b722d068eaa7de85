"""Knots ready to be pulled, bends and sutures as diagrams, and knots pulled tight."""

from torsade.knots.bends import Bend, bend_diagram, bend_names, find_bend
from torsade.knots.loose import listed_ropelength, loose_diagram, loose_knot
from torsade.knots.overhand import STRAND_KNOTS, overhand
from torsade.knots.ropelength import Thickness, thickness
from torsade.knots.stacked import BENDS, PULLS, BuiltBend, bend
from torsade.knots.sutures import suture_diagram
from torsade.knots.tight import TightKnot, tighten

__all__ = [
    "BENDS",
    "PULLS",
    "STRAND_KNOTS",
    "Bend",
    "BuiltBend",
    "Thickness",
    "TightKnot",
    "bend",
    "bend_diagram",
    "bend_names",
    "find_bend",
    "listed_ropelength",
    "loose_diagram",
    "loose_knot",
    "overhand",
    "suture_diagram",
    "thickness",
    "tighten",
]
