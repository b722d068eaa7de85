"""Knots ready to be pulled."""

from torsade.knots.stacked import BENDS, PULLS, BuiltBend, bend

__all__ = ["BENDS", "PULLS", "BuiltBend", "bend"]
