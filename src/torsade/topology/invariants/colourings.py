"""Colourings: homomorphisms of the knot group that send meridians into one conjugacy class.

A colouring gives every arc an element of the class such that u = over^-1 v over at every crossing (see
`wirtinger`). How many there are does not depend on the diagram. The longitude of a knot goes to an element
that commutes with the first arc's, and says more: it tells mirror images apart (M. Eisermann, Knot colouring
polynomials, Pacific J. Math. 231 (2007) 305).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

from torsade.errors import TorsadeError
from torsade.topology.invariants.code import Code, oriented
from torsade.topology.invariants.goeritz import goeritz_matrix
from torsade.topology.invariants.wirtinger import Plan, Relation, plan, relations

__all__ = ["QUANDLES", "Quandle", "colouring_polynomial", "dihedral_colourings"]

Permutation = tuple[int, ...]


@dataclass(frozen=True)
class Quandle:
    """The conjugacy class of a permutation in the group that some permutations generate."""

    representative: Permutation
    generators: tuple[Permutation, ...]

    @cached_property
    def elements(self) -> tuple[Permutation, ...]:
        """The class, its representative first."""
        found = {self.representative: None}
        todo = [self.representative]
        while todo:
            x = todo.pop()
            for g in self.generators:
                y = _times(_times(_inverse(g), x), g)
                if y not in found:
                    found[y] = None
                    todo.append(y)
        return tuple(found)

    @cached_property
    def under(self) -> list[list[int]]:
        """under[y][x] numbers y^-1 x y."""
        number = {x: k for k, x in enumerate(self.elements)}
        inverses = [_inverse(y) for y in self.elements]
        return [
            [number[_times(_times(y_inverse, x), y)] for x in self.elements]
            for y, y_inverse in zip(self.elements, inverses, strict=True)
        ]

    @cached_property
    def back(self) -> list[list[int]]:
        """back[y] undoes under[y]."""
        return [list(_inverse(tuple(row))) for row in self.under]

    @cached_property
    def powers(self) -> dict[Permutation, int]:
        """The powers of the representative, and their exponents from 0 up."""
        found: dict[Permutation, int] = {}
        x = tuple(range(len(self.representative)))
        while x not in found:
            found[x] = len(found)
            x = _times(x, self.representative)
        return found


def _times(p: Permutation, q: Permutation) -> Permutation:
    """First p, then q."""
    return tuple(q[k] for k in p)


def _inverse(p: Permutation) -> Permutation:
    found = [0] * len(p)
    for k, image in enumerate(p):
        found[image] = k
    return tuple(found)


_A5 = ((1, 2, 3, 4, 0), (1, 2, 0, 3, 4))
_PSL27 = ((1, 2, 3, 4, 5, 6, 0), (0, 2, 1, 5, 4, 3, 6))

QUANDLES = MappingProxyType(
    {
        "S4 order 4": Quandle((1, 2, 3, 0), ((1, 2, 3, 0), (1, 0, 2, 3))),
        "A5 order 3": Quandle((1, 2, 0, 3, 4), _A5),
        "A5 order 5": Quandle((1, 2, 3, 4, 0), _A5),
        "PSL(2,7) order 7": Quandle((1, 2, 3, 4, 5, 6, 0), _PSL27),
    }
)
"""Classes whose elements commute with their own powers only, so that the longitude is one of these."""


def dihedral_colourings(pd: Sequence[Sequence[int]] | Code, p: int, circles: int = 0) -> int:
    """Fox's p-colourings for a prime p: the solutions of u + v = 2 over mod p, trivial ones included.

    p to the power 1 + (nullity mod p of a Goeritz matrix), for a diagram in one piece.
    """
    if p < 2 or any(p % k == 0 for k in range(2, int(p**0.5) + 1)):
        raise TorsadeError(f"p is {p}; give a prime")
    code = oriented(pd, circles)
    matrices = [goeritz_matrix(code, piece)[0] for piece in code.pieces]
    return int(p ** (code.circles + sum(1 + _nullity(matrix, p) for matrix in matrices)))


def _nullity(matrix: list[list[int]], p: int) -> int:
    """Rows minus rank of a square matrix mod a prime."""
    rows, n_columns, rank = [[x % p for x in row] for row in matrix], len(matrix), 0
    for k in range(n_columns):
        pivot = next((row for row in rows if row[k]), None)
        if pivot is None:
            continue
        rows.remove(pivot)
        rank += 1
        scale = pow(pivot[k], -1, p)
        rows = [
            [(x - row[k] * scale * up) % p for x, up in zip(row, pivot, strict=True)] if row[k] else row
            for row in rows
        ]
    return n_columns - rank


def colouring_polynomial(pd: Sequence[Sequence[int]] | Code, quandle: Quandle) -> tuple[int, ...]:
    """Of a knot, how many colourings send the first meridian to x and the longitude to x^k, for each k.

    x is the quandle's representative and k goes from 0 to its order less one; the colouring in one colour
    counts at k = 0, and the number of all colourings is the sum times the size of the class. Read as an
    element of the group ring of the cyclic group, it is multiplicative under connected sum; of the mirror
    image, entries k and -k change places. Reversing the knot changes nothing where an automorphism of the
    group sends x to 1/x, as in all of `QUANDLES`.
    """
    code = oriented(pd)
    if code.n_components != 1:
        raise TorsadeError(f"the link has {code.n_components} components; give a knot for its longitude")
    counts = [0] * len(quandle.powers)
    rows = relations(code)
    if not rows:
        counts[0] = 1
        return tuple(counts)
    order = plan(rows)
    passages = _passages(code, rows, order.seeds[0])
    inverses = [_inverse(y) for y in quandle.elements]
    for colours in _colourings(rows, order, quandle):
        longitude = tuple(range(len(quandle.representative)))
        for arc, sign in passages:
            y = colours[arc]
            longitude = _times(longitude, quandle.elements[y] if sign > 0 else inverses[y])
        if longitude not in quandle.powers:
            raise TorsadeError("the longitude is no power of the meridian; give a class of `QUANDLES`")
        counts[(quandle.powers[longitude] + code.writhe) % len(counts)] += 1
    return tuple(counts)


def _passages(code: Code, rows: list[Relation], first: int) -> list[tuple[int, int]]:
    """The longitude along the knot from the start of arc `first`, framing aside: arcs and exponents.

    Where the knot goes under an arc at a crossing of sign s, out = over^s in over^-s, so the product of all
    over^-s, in order, commutes with the first arc.
    """
    (edges,) = code.components
    ends = [code.ends[edge][1] for edge in edges]
    under = [c for c, slot in ends if slot == 0]
    at = under.index(first) + 1
    return [(rows[c].over, -code.signs[c]) for c in under[at:] + under[:at]]


def _colourings(rows: list[Relation], order: Plan, quandle: Quandle) -> Iterator[list[int]]:
    """The colourings that give the first seed element 0: numbers of elements, the same list every time."""
    checks = _checks(rows, order)
    colours = [0] * len(rows)
    under, back = quandle.under, quandle.back

    def descend(stage: int) -> Iterator[list[int]]:
        if stage == len(order.seeds):
            yield colours
            return
        for colour in range(len(quandle.elements) if stage else 1):
            colours[order.seeds[stage]] = colour
            for step in order.steps[stage]:
                row = rows[step.row]
                if step.forwards:
                    colours[row.u] = under[colours[row.over]][colours[row.v]]
                else:
                    colours[row.v] = back[colours[row.over]][colours[row.u]]
            if all(under[colours[row.over]][colours[row.v]] == colours[row.u] for row in checks[stage]):
                yield from descend(stage + 1)

    return descend(0)


def _checks(rows: list[Relation], order: Plan) -> list[list[Relation]]:
    """The relations that no step uses, by the seed after which all their arcs are known."""
    known_after: dict[int, int] = {}
    used = set()
    for stage, (seed, steps) in enumerate(zip(order.seeds, order.steps, strict=True)):
        known_after[seed] = stage
        for step in steps:
            known_after[step.target] = stage
            used.add(step.row)
    checks: list[list[Relation]] = [[] for _ in order.seeds]
    for k, row in enumerate(rows):
        if k not in used:
            checks[max(known_after[arc] for arc in (row.u, row.v, row.over))].append(row)
    return checks
