"""Closed knots as loops to begin with: tight shapes, shipped for the smallest knots and made for others."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

import numpy as np

from torsade.arrays import Floats
from torsade.curve import length, resample
from torsade.knots.finding import interpret, known_closed
from torsade.knots.loose import loose_diagram, loose_knot
from torsade.knots.tied import tie
from torsade.knots.tight import TightKnot, tighten
from torsade.topology.named import looks_like_a_name
from torsade.topology.names import UNKNOT

__all__ = ["MIRROR", "SPACING", "TightLoop", "tight_loop", "tightest"]

SPACING = 0.4
"""Of nodes of the loops that are shipped [radii]."""


MIRROR = np.array([1.0, 1.0, -1.0])
"""Factors of coordinates in a mirror at z = 0."""


@dataclass(frozen=True, eq=False)
class TightLoop:
    """A closed knot in its tight shape.

    Attributes:
        name: of the knot, or the code that it was asked for by.
        nodes: shape (n, 3), in radii of the fiber: read-only.
        mirrored: whether they are those of the shape that is shipped, seen in a mirror at z = 0.
    """

    name: str
    nodes: Floats
    mirrored: bool = False

    @property
    def ropelength(self) -> float:
        """L/h."""
        return length(self.nodes, True)

    def fiber(self, fiber_length: float, n: int) -> Floats:
        """The loop in n nodes evenly spaced, scaled to a length [m]; shape (n, 3)."""
        x = resample(self.nodes, n=n, closed=True)
        return np.asarray(x * (fiber_length / length(x, True)))


@lru_cache(maxsize=64)
def tight_loop(name: str) -> TightLoop:
    """A closed knot in its tight shape: shipped, or its mirror image, or made now, which takes seconds.

    >>> round(tight_loop("3_1").ropelength, 1)
    32.7

    Raises:
        TorsadeError: as `known_closed` does.
    """
    name = known_closed(name)
    plain, mirrored = name.removeprefix("m"), False
    if plain == UNKNOT:
        nodes = _circle()
    elif plain in _shipped():
        nodes = np.array(_shipped()[plain]["nodes"])
        mirrored = name != plain
        if mirrored:
            nodes = nodes * MIRROR
    else:
        nodes = np.array(_tightened(name).strands[0])
    nodes.flags.writeable = False
    return TightLoop(name, nodes, mirrored)


def tightest(name: str) -> TightKnot:
    """The shorter of two tight shapes: from the closed braid of a knot, and from the fiber of its drawing."""
    drawn = tie(name, 1.0).strands
    return min(_tightened(name), tighten(drawn), key=lambda knot: knot.ropelength)


def _tightened(name: str) -> TightKnot:
    loose = loose_knot(name) if looks_like_a_name(name) else loose_diagram(interpret(name).diagram)
    return tighten(loose)


def _circle() -> Floats:
    """The tight unknot, a circle of radius 1."""
    phi = np.linspace(0.0, 2 * math.pi, 64, endpoint=False)
    return np.stack([np.cos(phi), np.sin(phi), np.zeros_like(phi)], axis=1)


@lru_cache(maxsize=1)
def _shipped() -> dict[str, Any]:
    text = files("torsade.knots").joinpath("catalogue/tight.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(text)
    return found
