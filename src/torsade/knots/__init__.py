"""Knots ready to be pulled, made from diagrams; bends and sutures by name."""

from torsade.knots.bends import PULLS, Bend, bend_diagram, bend_names, find_bend
from torsade.knots.build import BuiltKnot, build
from torsade.knots.overhand import STRAND_KNOTS, overhand
from torsade.knots.sutures import suture_diagram
from torsade.knots.tied import BuiltBend, bend

__all__ = [
    "PULLS",
    "STRAND_KNOTS",
    "Bend",
    "BuiltBend",
    "BuiltKnot",
    "bend",
    "bend_diagram",
    "bend_names",
    "build",
    "find_bend",
    "overhand",
    "suture_diagram",
]
