"""Bends as diagrams: two-strand tangles by name. What is known of each lies in `catalogue/bends.json`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from types import MappingProxyType

from torsade.topology.codes import from_gauss
from torsade.topology.diagram import Diagram

__all__ = ["PULLS", "Bend", "bends"]

PULLS = ("A1B1", "A1B0", "A0B1", "A0B0")
"""Pairs of ends: the first is clamped, the second pulled."""


@dataclass(frozen=True)
class Bend:
    """A bend of the catalogue.

    Attributes:
        name: its name in the catalogue, such as "alpine_butterfly".
        title: its name in full.
        aliases: other names.
        diagram: strand A from A0 to A1, strand B from B0 to B1; A1 and B1 are the standing ends.
        pulls: what it is called when pulled by each two ends.
        other_pulls: names that stand for it pulled otherwise than by A1 and B1, and by which ends.
        abok: its numbers in The Ashley Book of Knots.
        source: how its code was found.
        certainty: how sure it is that the code is this bend.
    """

    name: str
    title: str
    aliases: tuple[str, ...]
    diagram: Diagram
    pulls: Mapping[str, str]
    other_pulls: Mapping[str, str]
    abok: tuple[str, ...]
    source: str
    certainty: str


@lru_cache(maxsize=1)
def bends() -> Mapping[str, Bend]:
    """The bends by name."""
    text = files("torsade.knots").joinpath("catalogue/bends.json").read_text(encoding="utf-8")
    return MappingProxyType(
        {
            name: Bend(
                name,
                row["title"],
                tuple(row["aliases"]),
                from_gauss(row["gauss"], closed=False, boundary=row["boundary"].split()),
                MappingProxyType(row["pulls"]),
                MappingProxyType(row.get("other_pulls", {})),
                tuple(row.get("abok", ())),
                row["source"],
                row["certainty"],
            )
            for name, row in json.loads(text).items()
        }
    )
