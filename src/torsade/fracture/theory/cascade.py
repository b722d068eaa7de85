"""The cascade of breaks in linear theory, with or without disorder: how many pieces, how long, when.

The rod is bent until somewhere the stress reaches the strength there, and breaks. From every new end a
bending wave runs towards the gripped end of its half. Where it passes it raises the curvature C times, and
the rod breaks at the first place where that is enough without twist, and which is at least lambda from the
new end and more than lambda from the grip; the wave of the next new end follows. Pieces between two breaks
are left alone. In this picture waves do not add up and nothing comes back from the grips; the full equations
have both.

With C = 1.5 the thesis's rods break into 6 pieces up to 60 degrees of twist, into 4 from 80 to 240 and into 2
from 250.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from torsade.errors import TorsadeError
from torsade.fracture.criteria import stress
from torsade.fracture.rod import Rod
from torsade.fracture.theory.elastica import Elastica, elastica_of_curvature, largest_curvature
from torsade.fracture.theory.scales import bending_time

__all__ = ["Cascade", "disordered_cascades", "linear_cascade"]

Floats = NDArray[np.float64]

AMPLIFIED = 1.5
"""C of the full equations, to one decimal (3.6): above the 1.43 of the linear wave."""

PLACES = 481
"""Places along a rod without disorder where it may break, the middle among them."""


class Cascade(NamedTuple):
    """What came of a rod.

    Attributes
    ----------
    kappa_c : curvature at the middle when it broke [1/m]
    breaks : time since the first break [s] and place [m] of every break, in the order of time
    lengths : of the pieces, from one end of the rod to the other [m]
    """

    kappa_c: float
    breaks: tuple[tuple[float, float], ...]
    lengths: tuple[float, ...]

    @property
    def pieces(self) -> int:
        return len(self.lengths)


def linear_cascade(
    rod: Rod,
    Tw: float,
    sigma_c: float,
    fragment: float,
    C: float = AMPLIFIED,
    name: str = "effective",
    strength: Floats | None = None,
) -> Cascade:
    """Break a rod.

    Parameters
    ----------
    rod : before it breaks, bent in a plane
    Tw : its twist [rad]
    sigma_c : strength [Pa] for the criterion
    fragment : least length lambda of a piece [m]
    C : amplification of the curvature by a wave
    name : of the criterion
    strength : at places spread evenly over the rod, both ends among them, in units of sigma_c; by default 1
    """
    factor = np.ones(PLACES) if strength is None else np.asarray(strength, dtype=np.float64)
    s = np.linspace(0.0, rod.L, len(factor))
    twist = Tw / rod.L

    def load(kappa: Floats) -> Floats:
        return stress(kappa, twist, rod.E, rod.mu, rod.h, name) / (sigma_c * factor)

    shape = _bent(rod, load, s)
    kappa = np.zeros(len(s)) if shape is None else shape.curvature(s)
    first = _worst(load(kappa))
    # Twist has gone when the waves come.
    enough = stress(C * kappa, 0.0, rod.E, rod.mu, rod.h, name) >= sigma_c * factor
    halves = [list(_followed(rod, s, enough, first, step, fragment)) for step in (-1, 1)]
    breaks = sorted([(0.0, float(s[first])), *halves[0], *halves[1]])
    ends = [0.0, *sorted(place for _, place in breaks), rod.L]
    lengths = tuple(b - a for a, b in pairwise(ends))
    return Cascade(0.0 if shape is None else shape.kappa_max, tuple(breaks), lengths)


def disordered_cascades(
    rod: Rod,
    Tw: float,
    sigma_c: float,
    fragment: float,
    scatter: float,
    trials: int,
    seed: int,
    C: float = AMPLIFIED,
    name: str = "effective",
    places: int = 51,
) -> list[Cascade]:
    """Break many rods whose strength scatters from place to place; the k-th depends on seed and k alone.

    Parameters
    ----------
    scatter : standard deviation of the strength over its mean, normal, at each place independently
    trials : number of rods
    seed : of the random numbers
    places : where strengths are drawn, 51 as for the thesis's 50 elements; others as in `linear_cascade`
    """
    found = []
    for k in range(trials):
        draws = np.random.default_rng([seed, k]).normal(1.0, scatter, places)
        strength = np.maximum(draws, 0.05)
        found.append(linear_cascade(rod, Tw, sigma_c, fragment, C, name, strength))
    return found


def _bent(rod: Rod, load: Callable[[Floats], Floats], s: Floats) -> Elastica | None:
    """The planar shape in which the largest load is 1; None where twist alone is as much, without bending."""
    if float(load(np.zeros(len(s))).max()) >= 1.0:
        return None

    def excess(kappa: float) -> float:
        return float(load(elastica_of_curvature(rod.L, kappa).curvature(s)).max()) - 1.0

    most = largest_curvature(rod.L)
    if excess(most) < 0:
        raise TorsadeError(
            f"a rod of {rod.L:g} m does not break before its ends have met and crossed; give less strength, "
            "or more length"
        )
    return elastica_of_curvature(rod.L, brentq(excess, 0.0, most, xtol=1e-9 * most))


def _worst(loads: Floats) -> int:
    """Where the load is largest; of equal ones that nearest to the middle."""
    among = np.flatnonzero(loads >= float(loads.max()) * (1 - 1e-12))
    return int(among[np.argmin(np.abs(2 * among - (len(loads) - 1)))])


def _followed(
    rod: Rod, s: Floats, enough: NDArray[np.bool_], first: int, step: int, fragment: float
) -> Iterator[tuple[float, float]]:
    """Time and place of further breaks on one side of the first."""
    at, time = first, 0.0
    while True:
        ahead = np.arange(at + step, len(s) if step > 0 else -1, step)
        far = np.abs(s[ahead] - s[at]) >= fragment * (1 - 1e-9)
        left = np.abs(s[-1 if step > 0 else 0] - s[ahead]) > fragment * (1 + 1e-9)
        ready = ahead[far & left & enough[ahead]]
        if not len(ready):
            return
        time += bending_time(rod, abs(float(s[ready[0]] - s[at])))
        at = int(ready[0])
        yield time, float(s[at])
