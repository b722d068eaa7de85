"""The counting rules of a pulled knot: crossings, twist fluctuation and circulation (thesis 4.5, 4.6).

Every strand runs towards its pulled end. A right-handed crossing then turns both strands one way, a
left-handed one the other (charge q = +1 or -1): opposite charges lock, equal ones let strands roll.
Edges that run around a face the same way slide along each other. Both are counts on a drawing; tau does
not change where a drawing is changed by moves that keep every crossing's sign, Gamma does.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import product

from torsade.centerline import Centerline
from torsade.errors import TorsadeError
from torsade.topology.canonical import canonical_form
from torsade.topology.diagram import Diagram
from torsade.topology.moves import (
    add_bigon,
    bigons,
    fingers,
    kinks,
    remove_bigon,
    remove_kink,
    slide_triangle,
    triangles,
)
from torsade.topology.projection import project
from torsade.topology.seifert import turning
from torsade.topology.swing import swings

__all__ = [
    "Face",
    "Range",
    "State",
    "circulation_range",
    "pull_choices",
    "state",
    "twist_fluctuation",
    "whitney_index",
]


@dataclass(frozen=True)
class Face:
    """A face of a drawing: its edges, how many more run counterclockwise than clockwise, and where it is."""

    edges: int
    circulation: int
    bounded: bool

    @property
    def energy(self) -> Fraction:
        """Its share |C|/e of the circulation energy."""
        return Fraction(abs(self.circulation), self.edges) if self.edges else Fraction(0)


@dataclass(frozen=True)
class State:
    """What is counted on an oriented drawing.

    Attributes:
        crossings: N.
        charges: sign of every crossing, right-handed +1.
        faces: all faces, unbounded ones among them.
        whitney: sum of the senses of the loops left when every crossing is smoothed, counterclockwise +1.
            A ring that crosses nothing counts as +1 whichever way it ran: diagrams do not keep that.
        loops: how many such loops there are.
    """

    crossings: int
    charges: tuple[int, ...]
    faces: tuple[Face, ...]
    whitney: int
    loops: int

    @property
    def writhe(self) -> int:
        """Wr: the sum of all charges."""
        return sum(self.charges)

    @property
    def tau(self) -> float:
        """Twist fluctuation energy per crossing (4.12): 1 - (Wr/N)^2, and 0 without crossings."""
        return float(1 - Fraction(self.writhe, self.crossings) ** 2) if self.crossings else 0.0

    @property
    def gamma(self) -> float:
        """Circulation energy (4.19), the sum of |C|/e over bounded faces."""
        return _gamma(self.faces)

    @property
    def gamma_with_outer(self) -> float:
        """The same over all faces, unbounded ones included."""
        return float(sum((face.energy for face in self.faces), Fraction(0)))


def twist_fluctuation(charges: Iterable[int]) -> tuple[float, float, float]:
    """tau in the three forms of the thesis (4.12 and below it), which are equal.

    The mean square of q - mean q; 1 - (Wr/N)^2; and as an interaction, 1 - 1/N - (2/N^2) sum of q_i q_j
    over pairs.

    Raises:
        TorsadeError: there are no charges.
    """
    q = list(charges)
    n = len(q)
    if n == 0:
        raise TorsadeError("there are no crossings; twist fluctuation is a mean over crossings: give some")
    mean = Fraction(sum(q), n)
    pairs = (sum(q) ** 2 - sum(c * c for c in q)) // 2
    spread = sum(((c - mean) ** 2 for c in q), Fraction(0)) / n
    return float(spread), float(1 - mean**2), float(1 - Fraction(1, n) - Fraction(2 * pairs, n * n))


def state(knot: Diagram | Centerline, pulled: str | Iterable[str] | None = None) -> State:
    """Count on a drawing, its strands running as they do or towards the pulled ends.

    Args:
        knot: a diagram of a knot, link or tangle; or a centerline, which is looked at along z.
        pulled: names of the pulled ends, as in `Diagram.pulled`. A bend that says which ends are pulled, as
            those of `torsade.knots.bend` do, need not be told.

    Raises:
        TorsadeError: pulled ends that are not one of each open strand, or what `project` refuses.
    """
    if isinstance(knot, Centerline):
        pulled = getattr(knot, "pulled", None) if pulled is None else pulled
        knot = project(knot.strands, knot.closed).diagram
    drawn = knot if pulled is None else knot.pulled(pulled)
    loops = len(drawn.seifert_circles)
    return State(drawn.n_crossings, drawn.signs, _faces(drawn), whitney_index(drawn), loops)


def _faces(drawn: Diagram) -> tuple[Face, ...]:
    return tuple(
        Face(len(face), drawn.circulation(f), drawn.is_bounded(f)) for f, face in enumerate(drawn.faces)
    )


def _gamma(faces: Iterable[Face]) -> float:
    """The sum of |C|/e over bounded faces."""
    return float(sum((face.energy for face in faces if face.bounded), Fraction(0)))


def pull_choices(diagram: Diagram) -> Iterator[tuple[str, ...]]:
    """Every choice of one end of each open strand to pull, the second ends first.

    >>> from torsade.topology.tangle import integer
    >>> list(pull_choices(integer(2)))[0]
    ('A1', 'B1')
    """
    tips: dict[str, list[str]] = {}
    for name in sorted(diagram.ends, reverse=True):
        tips.setdefault(name.rstrip("0123456789"), []).append(name)
    yield from product(*(tips[strand] for strand in sorted(tips)))


def whitney_index(diagram: Diagram) -> int:
    """Sum of the senses of the loops left when every crossing is smoothed, counterclockwise +1.

    For a closed drawing in the plane this is the degree of its tangent map (Whitney 1937); arcs that lead
    from end to end are left out. Circles without crossings count as counterclockwise: a diagram does not keep
    which way they run, `torsade.topology.views.turning_number` of the curve says it.
    """
    return sum(turning(diagram, loop) for loop in diagram.seifert_circles)


_CROSSINGS_EACH = 200  # how many are drawn for each drawing to be looked at, in the mean, at most


@dataclass(frozen=True)
class Range:
    """Gamma over drawings of one tangle: least and greatest value, how many drawings, and whether all.

    drawings counts those with the least number of crossings found; complete is False when the search was
    stopped at its limit before it had gone wherever its moves lead within the crossings allowed.
    """

    least: float
    greatest: float
    crossings: int
    drawings: int
    complete: bool


def circulation_range(
    diagram: Diagram, pulled: str | Iterable[str] | None = None, extra: int = 1, limit: int = 2000
) -> Range:
    """Gamma over the drawings with fewest crossings that moves reach, ends swinging freely outside.

    The moves are `swings` of the ends (a rope is the same bend wherever its tails lie) and those of
    Reidemeister, except that no kink is added; a drawing on the way may have `extra` crossings more than the
    fewest found so far. So the range is that of the drawings found, not proven to be that of all. Drawings
    with fewer crossings are looked at first.

    Args:
        diagram: where to start.
        pulled: names of the pulled ends, as in `Diagram.pulled`.
        extra: with less than 2 there is no room to push one strand over another: ends swing, triangles
            slide and crossings go. With 2 or more the search goes much farther, and takes much longer.
        limit: how many drawings to look at, at most; of large ones, from which many moves lead, fewer, so
            that the time stays about the same: 2 to 4 s for 2000.

    Raises:
        TorsadeError: ends to pull that are not one of each open strand.
    """
    begun = diagram if pulled is None else diagram.pulled(pulled)
    found = {canonical_form(begun, plane=True): begun}
    queue, looked, drawn = [(begun.n_crossings, 0, begun)], 0, 0
    fewest = begun.n_crossings
    while queue and looked < limit and drawn < _CROSSINGS_EACH * limit:
        drawing = heappop(queue)[2]
        looked += 1
        for new in _moved(drawing, fewest + extra):
            drawn += new.n_crossings
            form = canonical_form(new, plane=True)
            if form not in found:
                heappush(queue, (new.n_crossings, len(found), new))
                found[form] = new
                fewest = min(fewest, new.n_crossings)
    minimal = [d for d in found.values() if d.n_crossings == fewest]
    gamma = [_gamma(_faces(d)) for d in minimal]
    return Range(min(gamma), max(gamma), fewest, len(minimal), not queue)


def _moved(diagram: Diagram, most: int) -> Iterator[Diagram]:
    """Drawings one move away, with at most so many crossings."""
    for dart in kinks(diagram):
        yield remove_kink(diagram, dart)
    for dart in bigons(diagram):
        yield remove_bigon(diagram, dart)
    for dart in triangles(diagram):
        yield slide_triangle(diagram, dart)
    yield from swings(diagram, most)
    if diagram.n_crossings + 2 <= most:
        for dart, other in fingers(diagram):
            yield add_bigon(diagram, dart, other, over=True)
            yield add_bigon(diagram, dart, other, over=False)
