"""Which link of the table a prime diagram of a link can be.

What is compared does not depend on how components are oriented: with V the Jones polynomial, sigma the
signature and Lk the sum of linking numbers,

    t^(-3 Lk/2) V    and    sigma + Lk,

for reversing a component whose linking with the rest is lambda multiplies V by t^(-3 lambda), adds
2 lambda to sigma and takes it twice from Lk (K. Murasugi, On the signature of links, Topology 9 (1970) 283);
what each component is on its own, with its linking numbers up to sign; and of three components the product
of their linking numbers, in which the signs cancel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import combinations

from torsade.topology.invariants import Code, Laurent, jones, signature
from torsade.topology.invariants.laurent import ONE
from torsade.topology.lookup import Match, knot_name
from torsade.topology.names import UNKNOT, mirror_name, split_union, sum_name
from torsade.topology.table import LINK_CROSSINGS, entries, link_codes

__all__ = ["LinkType", "link_type", "match_link", "prime_links"]

_LOOP = Laurent.of(Fraction(-1, 2), [-1, -1])


Profile = tuple[tuple[str, tuple[int, ...]], ...]
"""Of each component, its name and the sizes of its linking numbers other than 0; in order."""


@dataclass(frozen=True, slots=True)
class LinkType:
    """An unoriented link: its name, size, and what is compared.

    `triangles` are the products of linking numbers of three components, other than 0, in order.
    A sum is named without saying which components are joined, so it has several `profiles`.
    """

    name: str
    crossings: int
    n_components: int
    polynomial: Laurent
    signature: int
    triangles: tuple[int, ...]
    profiles: frozenset[Profile]


def link_type(name: str, code: Code) -> LinkType | None:
    """A diagram's invariants as of an unoriented link; None if a component has no name of its own."""
    table = code.linking
    profile = []
    for k, row in enumerate(table):
        component = knot_name(code.sublink([k]))
        if component is None:
            return None
        profile.append((component, tuple(sorted(abs(x) for x in row if x))))
    total = sum(sum(row) for row in table) // 2
    products = (table[i][j] * table[j][k] * table[k][i] for i, j, k in combinations(range(len(table)), 3))
    return LinkType(
        name,
        len(code.crossings),
        code.n_components,
        jones(code).shifted(Fraction(-3 * total, 2)),
        signature(code) + total,
        tuple(sorted(product for product in products if product)),
        frozenset([tuple(sorted(profile))]),
    )


def match_link(code: Code) -> Match:
    """The links with the invariants of this diagram of several components: prime ones, sums, split ones."""
    n, m = len(code.crossings), code.n_components
    wanted = link_type("", code)
    names: tuple[str, ...] = ()
    if wanted is not None:
        close = (link for link in _all_links(m) if link.crossings <= n)
        names = tuple(link.name for link in close if _may_be(link, wanted))
    if n <= LINK_CROSSINGS and len(names) == 1:
        return Match(names, True)
    known = f"links through {LINK_CROSSINGS} crossings"
    if not names:
        return Match((), False, f"none of the {known} has the invariants of this diagram of {n} crossings")
    if len(names) > 1:
        return Match(names, False, f"{' and '.join(names)} share the invariants compared")
    doubt = (
        f"the invariants are those of {names[0]} alone among {known}, but the diagram has {n} crossings, "
        "and a link beyond the table may share them"
    )
    return Match(names, False, doubt)


def _may_be(one: LinkType, two: LinkType) -> bool:
    """Have both the same invariants?"""
    numbers = one.polynomial, one.signature, one.triangles
    same = numbers == (two.polynomial, two.signature, two.triangles)
    return same and not one.profiles.isdisjoint(two.profiles)


@lru_cache(maxsize=1)
def prime_links() -> tuple[LinkType, ...]:
    """The links of the table, each before its mirror image where its invariants tell the two apart."""
    found = []
    for name, code in link_codes().items():
        link, mirror = link_type(name, code), link_type(mirror_name(name), code.mirrored())
        if link is not None and mirror is not None:
            found += [link] if _may_be(link, mirror) else [link, mirror]
    return tuple(found)


@lru_cache(maxsize=8)
def _all_links(n_components: int) -> tuple[LinkType, ...]:
    """Every link of so many components, split ones too, through `LINK_CROSSINGS` crossings."""
    primes = [
        LinkType(knot.name, knot.crossings, 1, knot.jones, knot.signature, (), _alone(knot.name))
        for knot in entries()
        if knot.crossings <= LINK_CROSSINGS
    ]
    unknot = LinkType(UNKNOT, 0, 1, ONE, 0, (), _alone(UNKNOT))
    sums = list(_sums([*primes, *prime_links()], n_components, LINK_CROSSINGS))
    return tuple(_unions([unknot, *sums], n_components, LINK_CROSSINGS))


def _alone(name: str) -> frozenset[Profile]:
    """The profiles of a knot."""
    return frozenset([((name, ()),)])


def _sums(primes: list[LinkType], components: int, crossings: int, first: int = 0) -> Iterator[LinkType]:
    """Sums of one or more of these, with at most so many components and crossings."""
    for k, one in enumerate(primes[first:], first):
        if one.crossings <= crossings and one.n_components <= components:
            yield one
            for rest in _sums(primes, components - one.n_components + 1, crossings - one.crossings, k):
                yield LinkType(
                    sum_name([one.name, rest.name]),
                    one.crossings + rest.crossings,
                    one.n_components + rest.n_components - 1,
                    one.polynomial * rest.polynomial,
                    one.signature + rest.signature,
                    tuple(sorted(one.triangles + rest.triangles)),
                    frozenset(p for a in one.profiles for b in rest.profiles for p in _joined(a, b)),
                )


def _joined(one: Profile, two: Profile) -> Iterator[Profile]:
    """The profiles of the sums that join a component of one to a component of the other."""
    for i, (a, links_a) in enumerate(one):
        for k, (b, links_b) in enumerate(two):
            component = sum_name([a, b]), tuple(sorted(links_a + links_b))
            yield tuple(sorted([component, *one[:i], *one[i + 1 :], *two[:k], *two[k + 1 :]]))


def _unions(parts: list[LinkType], components: int, crossings: int, first: int = 0) -> Iterator[LinkType]:
    """Split unions of one or more of these, with so many components and at most so many crossings."""
    for k, one in enumerate(parts[first:], first):
        left = components - one.n_components
        if one.crossings > crossings or left < 0:
            continue
        if left == 0:
            yield one
            continue
        for rest in _unions(parts, left, crossings - one.crossings, k):
            yield LinkType(
                split_union([one.name, *rest.name.split(" ⊔ ")]),
                one.crossings + rest.crossings,
                components,
                one.polynomial * rest.polynomial * _LOOP,
                one.signature + rest.signature,
                tuple(sorted(one.triangles + rest.triangles)),
                frozenset(tuple(sorted(a + b)) for a in one.profiles for b in rest.profiles),
            )
