"""A long fiber under tension T and torque M buckles at m = M/sqrt(B T) = 2, and into one place.

Coyne (1990), Thompson and Champneys (1996): with m given, end shortening D sqrt(T/B) = 4 sqrt(1 - m^2/4), end
rotation beyond twist R = 4 arccos(m/2), largest curvature kappa sqrt(B/T) = 2 sqrt(1 - m^2/4).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from motion.still import ACROSS, CLAMP, curvature, nodes, straight
from torsade.motion.branches import Path, Point, Tangent, follow, switch
from torsade.motion.chain import Chain
from torsade.motion.spectrum import lowest
from torsade.motion.supports import Fiber, Support, chain, controls_at

TABLE = np.array(
    [
        (0.5, 3.8729833462, 5.2724645666, 1.9364916731),
        (1.0, 3.4641016151, 4.1887902048, 1.7320508076),
        (1.5, 2.6457513111, 2.8909369913, 1.3228756555),
        (1.8, 1.7435595774, 1.8041072472, 0.8717797887),
        (1.9, 1.2489995997, 1.2702417172, 0.6244997998),
    ]
)
"""m, shortening, rotation and largest curvature."""

LENGTH = 60.0
"""In units of sqrt(B/T), in which all that follows is."""


def buckled(edges: int) -> tuple[Chain, Path, Point]:
    """A clamped fiber whose one end slides along x, its path from where it buckles to m = 0.4, a point on it.

    The middle is held in z: nothing else would keep the fiber from turning about its axis.
    """
    c = chain(Fiber(LENGTH, edges), (CLAMP, Support("fixed", ACROSS)), nodes=[(edges // 2, 2)])
    begin = straight(c)

    def least(m: float) -> float:
        controls = controls_at(c, force=(1.0, 0.0, 0.0), torque=m)
        return float(lowest(c, c.system(begin, controls))[0][0])

    m = brentq(least, 1.8, 2.2)
    assert pytest.approx(2.0, abs=0.01) == m
    path = Path(*(controls_at(c, force=(1.0, 0.0, 0.0), torque=t) for t in (m, 0.4)))
    here = c.system(begin, path.start)
    mode = lowest(c, here)[1][0]
    still = Tangent(np.zeros((edges + 2, 4)), np.zeros(3), 1.0)
    point = switch(c, path, Point(c, 0.0, begin._replace(torque=m), here, still), mode, 0.05)
    assert point is not None
    return c, path, point


def followed(edges: int) -> np.ndarray:
    """(n, 4) m, shortening, rotation beyond twist and largest curvature, all the way."""
    c, path, point = buckled(edges)
    rows = []
    for now in follow(c, point.shape, path, p=point.p, tangent=point.tangent, first=0.1, largest=2.0):
        m, x = path.at(now.p).torque, nodes(c, now.shape)
        rotation = c.rotation(now.shape) - m * LENGTH
        rows.append((m, LENGTH - x[-1, 0], rotation, curvature(c, now.shape).max()))
    assert now.p == 1.0
    return np.array(rows)


def test_localised_buckling() -> None:
    """The branch from the straight fiber, by its critical mode, down to m = 0.4: all numbers to 0.6 %."""
    rows = followed(1000)[::-1]
    for m, *exact in TABLE:
        for column, number in enumerate(exact, 1):
            assert np.interp(m, rows[:, 0], rows[:, column]) == pytest.approx(number, rel=6e-3)
