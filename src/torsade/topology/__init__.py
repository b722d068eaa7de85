"""Topology and geometry of curves: what is linked, how much, and which knot it is. No mechanics."""
