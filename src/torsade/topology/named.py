"""Diagrams by name: knots and links of the table, their mirror images and their sums."""

from __future__ import annotations

import re
from functools import reduce
from types import MappingProxyType

from torsade.errors import TorsadeError, quoted
from torsade.topology.codes import from_pd
from torsade.topology.codes._limits import limited
from torsade.topology.diagram import Diagram
from torsade.topology.names import UNKNOT
from torsade.topology.table import LINK_CROSSINGS, TABLE_CROSSINGS, contents
from torsade.topology.tangle import connected_sum

__all__ = ["COMMON_NAMES", "looks_like_a_name", "named_diagram"]

COMMON_NAMES = MappingProxyType(
    {
        "unknot": UNKNOT,
        "trefoil": "3_1",
        "figure-eight": "4_1",
        "hopf": "L2a1",
        "cinquefoil": "5_1",
        "three-twist": "5_2",
        "carrick mat": "8_18",
        "solomon": "L4a1",
        "whitehead": "L5a1",
        "borromean": "L6a4",
    }
)
"""Words for some knots and links, with or without "knot", "link" or "rings" behind them."""

_FACTOR = re.compile(r"m?(\d+[an]?_\d+|K?\d+[an]\d+|L\d+[an]\d+)")


def looks_like_a_name(text: str) -> bool:
    """Whether a text has the form of a name such as "3_1#m4_1", or is one of `COMMON_NAMES`."""
    parts = [_plain(part) for part in text.split("#")]
    return all(part in COMMON_NAMES or _FACTOR.fullmatch(part) for part in parts)


def named_diagram(name: str) -> Diagram:
    """The diagram of a knot or link by its name; m before it takes the mirror image, # joins summands.

    Codes and chirality are those of the table: 3_1 is the right-handed trefoil. A sum of links is made at the
    first strand of each.

    >>> named_diagram("3_1#m3_1").signs
    (1, 1, 1, -1, -1, -1)

    Raises:
        TorsadeError: a name that is not in the table, or a sum of more than 500 crossings.
    """
    parts = name.split("#")
    limited(len(parts), "summands", "sum")
    factors = [_factor(_plain(part), name) for part in parts]
    limited(sum(factor.n_crossings for factor in factors), "crossings", "sum")
    return reduce(connected_sum, factors)


def _plain(part: str) -> str:
    """A word of `COMMON_NAMES` without what may follow it, or the part as it is."""
    word = re.sub(r"(?<![\s_-])[\s_-]+(knot|link|rings)$", "", part.strip().lower())
    return word if word in COMMON_NAMES else part.strip()


def _factor(part: str, name: str) -> Diagram:
    plain = COMMON_NAMES.get(part, part)
    if plain.removeprefix("m") == UNKNOT:
        return Diagram.circle()
    codes = contents()["knots"] | contents()["links"]
    base = plain.removeprefix("m")
    if base in codes:
        pd = codes[base]["pd"] if base in contents()["knots"] else codes[base]
        diagram = from_pd(pd)
        return diagram.mirror() if plain.startswith("m") else diagram
    what = "" if part == name.strip() else f" in {quoted(name)}"
    perko = "10_161 and 10_162 of older tables are one knot (Perko), so 10_165 is the last; "
    raise TorsadeError(
        f"no knot or link is called {quoted(part)}{what}; {perko if base == '10_166' else ''}known are the "
        f"prime knots through {TABLE_CROSSINGS} crossings, such as 3_1 or m3_1, and links through "
        f"{LINK_CROSSINGS}, such as L5a1"
    )
