"""Topology of knots, links and tangles; it knows nothing of mechanics.

| module | what it does |
| --- | --- |
| `planar`, `diagram` | the values: graphs on the sphere, and oriented diagrams of knots, links and tangles |
| `projection` | from curves to diagrams |
| `codes` | PD, Gauss, Dowker-Thistlethwaite, braid and Conway codes |
| `tangle` | sums, products, closures, cuts, connected sums and summands |
| `moves`, `simplify` | Reidemeister moves one by one; fewer crossings by pass moves |
| `canonical` | when two drawings are the same |
| `seifert` | which way Seifert circles run |
| `draft` | the workbench on which diagrams are changed |
"""

from torsade.topology.canonical import canonical_form, is_isomorphic
from torsade.topology.diagram import Diagram
from torsade.topology.projection import Projection, project
from torsade.topology.simplify import simplify

__all__ = ["Diagram", "Projection", "canonical_form", "is_isomorphic", "project", "simplify"]
