"""Topology of knots, links and tangles; it knows nothing of mechanics.

| module | what it does |
| --- | --- |
| `planar`, `diagram` | the values: graphs on the sphere, and oriented diagrams of knots, links and tangles |
| `projection` | from curves to diagrams |
| `codes` | PD, Gauss, Dowker-Thistlethwaite, braid and Conway codes |
| `named` | diagrams of knots and links by name |
| `drawing_curves` | curves in space from braid words |
| `tangle` | sums, products, closures, cuts, connected sums and summands |
| `moves`, `swing`, `simplify` | Reidemeister moves one by one; swinging ends; fewer crossings by pass moves |
| `canonical` | when two drawings are the same |
| `seifert` | which way Seifert circles run |
| `draft` | the workbench on which diagrams are changed |
| `invariants`, `identify` | polynomials and numbers; which knot or link it is |
| `counting` | the thesis's rules for a pulled knot: N, tau, Gamma |
| `triangle_moves`, `isotopy` | whether curves in space become others without passing through each other |
| `measures`, `framing`, `views` | linking, writhe, twist and turning numbers of curves |
"""

from torsade.topology.canonical import canonical_form, is_isomorphic
from torsade.topology.codes import from_text
from torsade.topology.counting import (
    Range,
    State,
    circulation_range,
    pull_choices,
    state,
    twist_fluctuation,
    whitney_index,
)
from torsade.topology.diagram import Diagram
from torsade.topology.drawing_curves import braid_curves
from torsade.topology.identify import (
    Identity,
    OpenIdentity,
    identify,
    identify_curves,
    identify_open,
    identify_strands,
)
from torsade.topology.measures import average_crossing_number, linking, writhe
from torsade.topology.named import named_diagram
from torsade.topology.projection import Projection, project
from torsade.topology.simplify import simplify

__all__ = [
    "Diagram",
    "Identity",
    "OpenIdentity",
    "Projection",
    "Range",
    "State",
    "average_crossing_number",
    "braid_curves",
    "canonical_form",
    "circulation_range",
    "from_text",
    "identify",
    "identify_curves",
    "identify_open",
    "identify_strands",
    "is_isomorphic",
    "linking",
    "named_diagram",
    "project",
    "pull_choices",
    "simplify",
    "state",
    "twist_fluctuation",
    "whitney_index",
    "writhe",
]
