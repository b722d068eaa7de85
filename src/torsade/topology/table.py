"""The table of knots and links that `identify` looks into, from a file that ships with the package.

It holds a PD code and invariants of each of the 249 prime knots through 10 crossings, and PD codes of the
prime links through 8 crossings. A name stands for the knot that its code draws, and m before it for the
mirror image, unless the two are the same. The codes of knots are KnotInfo's (C. Livingston, A. H. Moore,
knotinfo.org), in whose pictures 3_1 is the right-handed trefoil. Numbers are KnotInfo's too: in SnapPy's
census 10_83 and 10_86 change places, and 10_162 to 10_165 are one higher. Links are numbered as in
Thistlethwaite's table, with the codes of Spherogram. `tools/make_knot_table.py` makes the file from codes.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from torsade.topology.invariants import (
    QUANDLES,
    Code,
    Laurent,
    alexander,
    colouring_polynomial,
    jones,
    oriented,
    signature,
)
from torsade.topology.names import mirror_name

__all__ = [
    "LINK_CROSSINGS",
    "TABLE_CROSSINGS",
    "TIE_BREAKERS",
    "KnotEntry",
    "Polynomial",
    "contents",
    "entries",
    "link_codes",
    "mirror_polynomial",
    "record",
]

TIE_BREAKERS = ("PSL(2,7) order 7", "A5 order 3")
"""The `QUANDLES` that tell apart what Alexander and Jones polynomial and signature do not.

Among prime knots through 10 crossings, their mirror images and their sums through 10 crossings, 14 pairs
agree in those three: 8_8 and m10_129, 8_16 and 10_156, 9_12 and 4_1#5_2, 10_25 and 10_56, 10_40 and
10_103, their mirror images, and 10_48, 10_71, 10_91 and 10_104 and theirs. The first of these quandles
separates all but 10_48 and its mirror image, which the second does.
"""

TABLE_CROSSINGS = 10
"""Prime knots are tabulated through this number of crossings."""

LINK_CROSSINGS = 8
"""Prime links are tabulated through this number of crossings."""

Polynomial = tuple[int, ...]


@dataclass(frozen=True)
class KnotEntry:
    """A prime knot of the table, or the mirror image of one.

    Attributes:
        name: as in "8_19" or "m8_19".
        crossings: the least number of crossings, as in the name.
        alexander, jones, signature: see `invariants`.
        colourings: its colouring polynomial with each of `TIE_BREAKERS`.
    """

    name: str
    crossings: int
    alexander: Laurent
    jones: Laurent
    signature: int
    colourings: Mapping[str, Polynomial]

    @cached_property
    def determinant(self) -> int:
        return self.alexander.alternating_sum

    def mirrored(self) -> KnotEntry:
        """The entry of the mirror image, as if it were another knot."""
        return KnotEntry(
            mirror_name(self.name),
            self.crossings,
            self.alexander,
            self.jones.mirrored(),
            -self.signature,
            MappingProxyType({name: mirror_polynomial(row) for name, row in self.colourings.items()}),
        )


def mirror_polynomial(row: Polynomial) -> Polynomial:
    """The colouring polynomial of the mirror image: entries k and -k change places."""
    return row[:1] + row[:0:-1]


def record(pd: Sequence[Sequence[int]]) -> dict[str, Any]:
    """What the file says about the knot with this PD code."""
    code = oriented(pd)
    v = jones(code)
    return {
        "pd": [list(row) for row in pd],
        "alexander": list(alexander(code).coefficients),
        "jones": [int(v.lowest), *v.coefficients],
        "signature": signature(code),
        "colourings": [list(colouring_polynomial(code, QUANDLES[name])) for name in TIE_BREAKERS],
    }


@lru_cache(maxsize=1)
def contents() -> Mapping[str, Any]:
    """The file as it is."""
    text = files("torsade.topology").joinpath("data/knots.json").read_text(encoding="utf-8")
    found: Mapping[str, Any] = json.loads(text)
    return found


@lru_cache(maxsize=1)
def entries() -> tuple[KnotEntry, ...]:
    """The prime knots through 10 crossings in the table's order, a chiral one before its mirror image.

    A knot is taken for chiral when an invariant here tells it from its mirror image, which agrees with
    KnotInfo for all of them.
    """
    found = []
    for name, row in contents()["knots"].items():
        knot = KnotEntry(
            name,
            int(name.split("_")[0]),
            Laurent.of(0, row["alexander"]).centred(),
            Laurent.of(row["jones"][0], row["jones"][1:]),
            row["signature"],
            MappingProxyType(dict(zip(TIE_BREAKERS, map(tuple, row["colourings"]), strict=True))),
        )
        mirror = knot.mirrored()
        same = (knot.jones, knot.signature, knot.colourings) == (
            mirror.jones,
            mirror.signature,
            mirror.colourings,
        )
        found += [knot] if same else [knot, mirror]
    return tuple(found)


@lru_cache(maxsize=1)
def link_codes() -> Mapping[str, Code]:
    """The prime links through 8 crossings in the order of the table."""
    return MappingProxyType({name: oriented(pd) for name, pd in contents()["links"].items()})
