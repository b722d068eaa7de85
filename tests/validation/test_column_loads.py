"""Loads and torques under which straight fibers buckle: closed forms, by the lowest eigenvalue alone."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from motion.still import ACROSS, CLAMP, HINGE, NOWHERE, PIVOT, order, straight
from torsade.motion.chain import Controls
from torsade.motion.spectrum import lowest
from torsade.motion.supports import Fiber, Support, chain, controls_at

FIXED_HINGED = brentq(lambda x: np.tan(x) - x, 4.4, 4.6)

EULER = {
    "hinged": (HINGE, Support("free", ACROSS), np.pi**2),
    "one end free": (CLAMP, Support("free", NOWHERE), np.pi**2 / 4),
    "clamped": (CLAMP, Support("fixed", ACROSS), 4 * np.pi**2),
    "clamped and hinged": (CLAMP, Support("free", ACROSS), FIXED_HINGED**2),
}
"""Ends and P L^2/B (Euler 1744; the last is the square of the least root of tan x = x)."""


def critical(ends: tuple[Support, Support], edges: int, given: str, near: float) -> float:
    """Thrust or torque at which the least eigenvalue vanishes, in units of B and L."""
    c = chain(Fiber(edges=edges), ends)

    def at(load: float) -> Controls:
        return controls_at(c, torque=load) if given == "torque" else controls_at(c, force=(-load, 0.0, 0.0))

    return float(
        brentq(lambda load: lowest(c, c.system(straight(c), at(load)))[0][0], 0.6 * near, 1.2 * near)
    )


@pytest.mark.parametrize("name", list(EULER))
def test_euler_loads(name: str) -> None:
    """To 1e-4 with 200 edges, second order by regression."""
    first, last, exact = EULER[name]
    sizes = [50, 100, 200]
    off = np.array([critical((first, last), n, "thrust", exact) / exact - 1 for n in sizes])
    assert abs(off[-1]) < 1e-4
    assert order(sizes, off) == pytest.approx(2.0, abs=0.01)


GREENHILL = {
    "pivots": (PIVOT, 2 * np.pi),
    "clamps": (CLAMP, 2 * brentq(lambda x: np.tan(x) - x, 4.4, 4.6)),
}
"""Ends and M L/B (Greenhill 1883): 2 pi and 8.9868, twice the least root of tan x = x.

The mode of the first is w = 1 - exp(2 pi i s), with a moment along the axis; pivots allow it in one phase.
"""


@pytest.mark.parametrize("name", list(GREENHILL))
def test_greenhill_torques(name: str) -> None:
    """To 2e-4 with 200 edges, second order by regression."""
    end, exact = GREENHILL[name]
    assert pytest.approx(exact, abs=1e-4) in (2 * np.pi, 8.9868)
    sizes = [50, 100, 200]
    ends = (end, Support(end.tangent, ACROSS))
    off = np.array([critical(ends, n, "torque", exact) / exact - 1 for n in sizes])
    assert abs(off[-1]) < 2e-4
    assert order(sizes, off) == pytest.approx(2.0, abs=0.02)


def test_torque_and_thrust_together() -> None:
    """Between pivots a straight fiber of M L/B > 4.8 buckles on the line P = 4 pi^2 - 2 pi M.

    Hinges whose moments stay along the axis have Greenhill's ellipse P/pi^2 + (M/2 pi)^2 = 1. Its mode would
    take the ends out of their planes, so that pivots carry more: on the ellipse they are still stable.
    """
    c = chain(Fiber(edges=200), (PIVOT, Support("plane", ACROSS)))
    for M in (5.2, 5.8):
        P = 4 * np.pi**2 - 2 * np.pi * M
        values = [
            lowest(c, c.system(straight(c), controls_at(c, force=(-share * P, 0.0, 0.0), torque=M)))[0][0]
            for share in (0.98, 1.02)
        ]
        assert values[0] > 0 > values[1]
        ellipse = np.pi**2 * (1 - (M / (2 * np.pi)) ** 2)
        inside = c.system(straight(c), controls_at(c, force=(-ellipse, 0.0, 0.0), torque=M))
        assert lowest(c, inside)[0][0] > 0
