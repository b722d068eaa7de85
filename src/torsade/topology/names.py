"""Names of knots and links: their order, sums and split unions."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["UNKNOT", "mirror_name", "name_order", "prime_factors", "split_union", "sum_name"]

UNKNOT = "0_1"

_NAME = re.compile(r"(?P<mirror>m?)(?P<link>L?)(?P<crossings>\d+)(?P<kind>[_an])(?P<number>\d+)")


def name_order(name: str) -> list[tuple[bool, int, str, int, bool]]:
    """A key that sorts names as the tables have them: knots, then links, a knot before its mirror image."""
    found = (_NAME.fullmatch(factor) for factor in name.split("#"))
    return [
        (bool(part["link"]), int(part["crossings"]), part["kind"], int(part["number"]), bool(part["mirror"]))
        for part in found
        if part
    ]


def mirror_name(name: str) -> str:
    """The name of the mirror image of a chiral prime knot or link."""
    return name[1:] if name.startswith("m") else "m" + name


def prime_factors(names: Iterable[str]) -> tuple[str, ...]:
    """The prime factors of these, and of sums among them, in order: none of unknots."""
    factors = (factor for name in names for factor in name.split("#"))
    return tuple(sorted((factor for factor in factors if factor != UNKNOT), key=name_order))


def sum_name(names: Iterable[str]) -> str:
    """The name of a connected sum, such as "3_1#m3_1"."""
    return "#".join(prime_factors(names)) or UNKNOT


def split_union(names: Iterable[str]) -> str:
    """The name of a split link of these, such as "0_1 ⊔ 3_1"."""
    return " ⊔ ".join(sorted(names, key=name_order))
