"""Which knot or link is this? An answer that is exact, or says what it leaves open.

The diagram is taken apart into prime diagrams (`factor`), and each is looked up by its invariants among the
prime knots through 10 crossings, their mirror images, and their sums (`lookup`), or among links through 8
crossings (`links`). A diagram of n crossings draws a knot of at most n: as far as the table goes it is
complete, and a name is given when one candidate only has the invariants (that crossing numbers add in sums
is part of what the tabulations found). With more crossings other knots may share the invariants, and the
result says so.

Names are those of the table (`table`): "3_1" is the right-handed trefoil, "m3_1" its mirror image. "#" joins
the factors of a sum, "⊔" split pieces. Orientations are left out: a knot and its reverse have one name, and
so have links that differ in orientation only. A sum of links is named without saying which of their
components are joined.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Protocol

from torsade.errors import TorsadeError
from torsade.topology.factor import summands
from torsade.topology.invariants import Code, oriented
from torsade.topology.links import match_link
from torsade.topology.lookup import Match, match_knot
from torsade.topology.names import prime_factors, split_union, sum_name

__all__ = ["Drawing", "Identity", "identify", "identify_pd"]


class Drawing(Protocol):
    """A diagram: an oriented PD code, and a number of components that cross nothing."""

    @property
    def pd(self) -> Sequence[Sequence[int]]: ...

    @property
    def circles(self) -> int: ...


@dataclass(frozen=True, slots=True)
class Identity:
    """What a diagram was found to be.

    Attributes:
        names: the knots or links of the table that it can be; none if it is none of these.
        certain: is it the one in `names`, proven?
        reason: why there is none or more than one, or what else it could be; empty if nothing is to be said.
        factors: the prime factors of the one name, none of the unknot; empty unless there is one name.
        components: of a link, what each of its components is on its own; empty for a knot.
        linking: of a link, the linking numbers of its components as the diagram orients them.
    """

    names: tuple[str, ...]
    certain: bool
    reason: str = ""
    factors: tuple[str, ...] = ()
    components: tuple[Identity, ...] = ()
    linking: tuple[tuple[int, ...], ...] = ()

    def __str__(self) -> str:
        return " or ".join(self.names) or "unknown"


def identify(diagram: Drawing) -> Identity:
    """Which knot or link a diagram is; simplify it first, since fewer crossings leave less open."""
    return identify_pd(diagram.pd, diagram.circles)


def identify_pd(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> Identity:
    """Which knot or link has this oriented PD code, and this many components that cross nothing.

    >>> print(identify_pd([[1, 5, 2, 4], [3, 1, 4, 6], [5, 3, 6, 2]]))
    3_1
    """
    code = oriented(pd, circles)
    if not code.n_components:
        raise TorsadeError("the diagram is empty; give a PD code, or a number of circles")
    pieces = [[_match(part) for part in piece] for piece in summands(code)]
    matches = [match for piece in pieces for match in piece]
    sums = [{sum_name(choice) for choice in product(*(match.names for match in piece))} for piece in pieces]
    names = {split_union(choice) for choice in product(*sums)}
    components: tuple[Identity, ...] = ()
    if code.n_components > 1:
        components = tuple(identify_pd(code.sublink([k])) for k in range(code.n_components))
    return Identity(
        names=tuple(sorted(names)),
        certain=len(names) == 1 and all(match.certain for match in matches),
        reason="; ".join(dict.fromkeys(match.reason for match in matches if match.reason)),
        factors=prime_factors(name for (name,) in sums) if len(names) == 1 else (),
        components=components,
        linking=code.linking if components else (),
    )


def _match(part: Code) -> Match:
    """What a prime diagram can be; one that is too wide for its invariants has no name."""
    try:
        return match_knot(part) if part.n_components == 1 else match_link(part)
    except TorsadeError as error:
        return Match((), False, str(error))
