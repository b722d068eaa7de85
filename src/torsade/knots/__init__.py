"""Knots by name: the catalogue, their diagrams, and their fibers: ready to be pulled, tight, or measured."""

from torsade.knots.bends import PULLS, Bend
from torsade.knots.build import BuiltKnot, build
from torsade.knots.entries import KINDS, Entry, facts, variants
from torsade.knots.finding import bend_diagram, bend_names, find, interpret, search
from torsade.knots.measured import Cleaned, clean
from torsade.knots.ropelength import Thickness, thickness
from torsade.knots.sutures import suture_diagram
from torsade.knots.tied import bend, strand, tie
from torsade.knots.tight import TightKnot, tighten

__all__ = [
    "KINDS",
    "PULLS",
    "Bend",
    "BuiltKnot",
    "Cleaned",
    "Entry",
    "Thickness",
    "TightKnot",
    "bend",
    "bend_diagram",
    "bend_names",
    "build",
    "clean",
    "facts",
    "find",
    "interpret",
    "search",
    "strand",
    "suture_diagram",
    "thickness",
    "tie",
    "tighten",
    "variants",
]
