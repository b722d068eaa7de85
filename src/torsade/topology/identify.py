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

DT codes, and Gauss codes without signs, leave open the mirror image of each summand that the drawing shows,
and the diagram made of one does not say so. With `handed=False`, `identify` takes that into account.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from torsade.curve import perpendicular
from torsade.errors import TorsadeError, listed
from torsade.topology import tangle
from torsade.topology.codes import from_gauss, to_pd
from torsade.topology.diagram import Diagram
from torsade.topology.factor import summands
from torsade.topology.invariants import Code, oriented
from torsade.topology.isotopy import thinned
from torsade.topology.links import match_link, prime_links
from torsade.topology.lookup import Match, match_knot
from torsade.topology.names import UNKNOT, mirror_name, prime_factors, split_union, sum_name
from torsade.topology.projection import project, spiral
from torsade.topology.simplify import simplify
from torsade.topology.table import entries

__all__ = [
    "Identity",
    "OpenIdentity",
    "identify",
    "identify_curves",
    "identify_open",
    "identify_pd",
    "identify_strands",
    "name_open",
]


MOST_NAMES = 64
"""Of mirror images that a code leaves open, as many are listed."""


MORE = 5
"""How many times as long fewer crossings are looked for where a single name is only not certain."""


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


def identify(diagram: Diagram, patience: int = 100, handed: bool = True) -> Identity:
    """Which knot or link a closed diagram is; it is simplified first, since fewer crossings leave less open.

    >>> from torsade.topology.codes import from_dt, to_dt
    >>> from torsade.topology.named import named_diagram
    >>> print(identify(from_dt(to_dt(named_diagram("3_1#m3_1"))), handed=False))
    3_1#3_1 or 3_1#m3_1

    Args:
        diagram: of a knot or a link.
        patience: how long to look for fewer crossings, as in `simplify`, where the name is not certain.
        handed: False where a code does not say which mirror image each of the drawn summands is. One
            keeps the name of its drawing; of several, all are named that differ from each other by more
            than a mirror image of the whole.

    Raises:
        TorsadeError: the diagram has open strands.
    """
    if diagram.ends:
        raise TorsadeError(
            f"the diagram has ends {listed(diagram.ends)}; only closed curves are knots: close it first, "
            "or use `identify_open` on a curve"
        )
    if not handed:
        return _unhanded(diagram, patience)
    simpler = simplify(diagram, patience=0)
    found = identify_pd(to_pd(simpler.without_circles()), simpler.circles)
    if found.certain and not found.reason:
        return found
    fewest = simplify(simpler, patience)
    found = identify_pd(to_pd(fewest.without_circles()), fewest.circles)
    if found.certain or len(found.names) != 1:
        return found
    # One crossing more than the table goes to is all that is often in the way of certainty.
    fewest = simplify(fewest, MORE * patience)
    return identify_pd(to_pd(fewest.without_circles()), fewest.circles)


def _unhanded(diagram: Diagram, patience: int) -> Identity:
    """What a diagram can be whose summands may each be exchanged for its mirror image."""
    found = identify(diagram, patience)
    as_drawn = [
        [set(identify(part, patience).names) for part in tangle.summands(piece)]
        for piece in tangle.split(diagram)
    ]
    ways = [[names | set(map(_mirrored, names)) for names in piece] for piece in as_drawn]
    left_open = [
        (i, k) for i, piece in enumerate(ways) for k, names in enumerate(piece) if names != as_drawn[i][k]
    ]
    if not left_open:
        return found
    if len(left_open) == 1:
        reason = (
            "the code leaves the mirror image open; named is the one whose first crossing is right-handed"
        )
        return replace(found, reason="; ".join(filter(None, (found.reason, reason))))
    i, k = left_open[0]
    ways[i][k] = as_drawn[i][k]
    names = _choices(split_union, [_choices(sum_name, piece) for piece in ways])
    reason = "the code leaves the mirror image of each summand open; one is named as it is drawn"
    if len(names) > MOST_NAMES:
        names, reason = set(found.names), f"{reason}, and of the others one choice out of many"
    return replace(found, names=tuple(sorted(names)), certain=False, reason=reason, factors=())


def _mirrored(name: str) -> str:
    """The name of the mirror image, which is the same where it is that of the table."""
    known = {knot.name for knot in entries()} | {link.name for link in prime_links() if "L" in name}
    pieces = []
    for piece in name.split(" ⊔ "):
        factors = [(factor, mirror_name(factor)) for factor in piece.split("#")]
        pieces.append(sum_name(mirror if mirror in known else factor for factor, mirror in factors))
    return split_union(pieces)


def _choices(combine: Callable[[list[str]], str], ways: Sequence[set[str]]) -> set[str]:
    """The names of what is put together of one of each; not all, if there are more than `MOST_NAMES`."""
    total, *others = ways
    for more in others:
        total = {combine([*one.split(" ⊔ "), other]) for one in total for other in more}
        if len(total) > MOST_NAMES:
            break
    return total


def identify_curves(curves: Sequence[ArrayLike]) -> Identity:
    """Which knot or link closed polylines are, each of shape (n, 3) without repeating its first node."""
    return identify(project(curves, True).diagram)


def identify_strands(diagram: Diagram) -> tuple[Identity, ...]:
    """Which knot each strand is without the others, its ends joined around the outside if it is open.

    >>> from torsade.topology.codes import from_braid
    >>> [str(strand) for strand in identify_strands(from_braid([1, 1, 1, 2, 2]))]
    ['3_1', '0_1']
    """
    found = []
    for strand in diagram.strands:
        at = [q >> 2 for q in strand]
        own = [q for q in strand if at.count(q >> 2) == 2]
        sign = {q >> 2: "+" if diagram.signs[q >> 2] > 0 else "-" for q in own}
        code = " ".join(f"{'UO'[q & 1]}{q >> 2}{sign[q >> 2]}" for q in own)
        found.append(identify(from_gauss(code) if code else Diagram.circle()))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class OpenIdentity:
    """What an open curve is, closed at infinity in many directions.

    Attributes:
        fractions: for each answer, by name, the fraction of directions that give it, most frequent first.
        directions: how many there were.
    """

    fractions: dict[str, float]
    directions: int

    @property
    def name(self) -> str:
        """The most frequent answer."""
        return next(iter(self.fractions))


def identify_open(x: ArrayLike, directions: int = 100, seed: int = 0) -> OpenIdentity:
    """Which knot an open curve is, its ends led to infinity in one direction and joined there.

    An open curve is a knot only as far as the way of closing it does not matter; many directions, evenly
    spread over the sphere and turned at random, show how far it does (Millett, Dobay and Stasiak 2005).

    Args:
        x: nodes [m], shape (n, 3).
        directions: how many.
        seed: of the rotation of the directions.

    Raises:
        TorsadeError: no direction, or nodes that `project` refuses.
    """
    counts = Counter(_closed_in_turn(x, directions, seed))
    return OpenIdentity({name: n / directions for name, n in counts.most_common()}, directions)


def name_open(x: ArrayLike, directions: int = 100, seed: int = 0) -> str:
    """The name that `identify_open` finds, sooner: directions that cannot change it any more are left out."""
    counts: Counter[str] = Counter()
    for k, name in enumerate(_closed_in_turn(x, directions, seed), start=1):
        counts[name] += 1
        (first, most), *others = counts.most_common(2)
        if most - sum(n for _, n in others) > directions - k:
            break
    return first


def _closed_in_turn(x: ArrayLike, directions: int, seed: int) -> Iterator[str]:
    """What nodes (n, 3) of an open curve are, closed in one direction after another."""
    if directions < 1:
        raise TorsadeError(f"{directions} directions are asked for; give at least one")
    nodes = np.asarray(x, dtype=np.float64)
    project([nodes])  # refuses what is no curve
    size = 10.0 * float(np.ptp(nodes, axis=0).max())
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    for u in spiral(directions) @ turn:
        closed = thinned(np.concatenate([nodes, nodes[-1:] + size * u, nodes[:1] + size * u]))
        if len(closed) == 3:
            yield UNKNOT
        else:
            yield str(identify(project([closed], True, direction=_beside(u)).diagram, patience=20))


def _beside(u: NDArray[np.float64]) -> NDArray[np.float64]:
    """A direction near u, along which what is led to infinity is seen to be short."""
    return np.asarray(u + 0.05 * perpendicular(u))


def identify_pd(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> Identity:
    """Which knot or link has this oriented PD code, and this many components that cross nothing.

    >>> print(identify_pd([[1, 5, 2, 4], [3, 1, 4, 6], [5, 3, 6, 2]]))
    3_1
    """
    code = oriented(pd, circles)
    if not code.n_components:
        raise TorsadeError("the diagram is empty; give a PD code, or a number of circles")
    return _identified(code)


@lru_cache(maxsize=1024)
def _identified(code: Code) -> Identity:
    """Which knot or link a code is: curves that move, or are seen from many sides, have few of them."""
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
