"""Whether two diagrams are of the same knot, link or tangle, found as cheaply as it can be."""

from __future__ import annotations

from torsade.errors import TorsadeError
from torsade.topology.canonical import canonical_form
from torsade.topology.codes import to_pd
from torsade.topology.diagram import Diagram
from torsade.topology.identify import identify, identify_strands
from torsade.topology.invariants import jones
from torsade.topology.simplify import reduced_by_passes, simplify
from torsade.topology.tangle import closures

__all__ = ["reads_as"]


def reads_as(read: Diagram, wanted: Diagram) -> bool:
    """Whether `read` can be the knot, link or tangle of `wanted`, its ends with the same names.

    Certain where both reduce to one drawing. Otherwise names and Jones polynomials are compared, for a tangle
    those of all its closures and of each strand by itself.
    """
    if read.ends and sorted(read.ends) != sorted(wanted.ends):
        return False
    for reduced in (reduced_by_passes, simplify):
        read, wanted = reduced(read), reduced(wanted)
        if canonical_form(read) == canonical_form(wanted):
            return True
    if not read.ends:
        return _agree(read, wanted)
    if [str(k) for k in identify_strands(read)] != [str(k) for k in identify_strands(wanted)]:
        return False
    other = {frozenset(map(frozenset, joins)): closed for joins, closed in closures(wanted)}
    found = {frozenset(map(frozenset, joins)): closed for joins, closed in closures(read)}
    return found.keys() == other.keys() and all(_agree(found[joins], other[joins]) for joins in found)


def _agree(one: Diagram, other: Diagram) -> bool:
    """Whether names and Jones polynomials of closed diagrams are the same."""
    a, b = identify(one), identify(other)
    if a.names != b.names or a.linking != b.linking:
        return False
    if a.certain and b.certain:
        return True
    one, other = simplify(one), simplify(other)
    try:
        v, w = (jones(to_pd(d.without_circles()), d.circles) for d in (one, other))
    except TorsadeError:  # too wide for a polynomial; what else is known agrees
        return True
    return v == w
