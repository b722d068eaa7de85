"""A closed ring buckles out of its plane at total twist 2 pi sqrt(3) B/C (Michell 1889, Zajac 1962)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from motion.still import CLAMP, order
from rod.helpers import circle, total_twist, twist_closed
from torsade.assembly import assemble, initial_state
from torsade.material import Material, Section
from torsade.motion import ends
from torsade.motion.overdamped import Motion, Stepping, model
from torsade.motion.spectrum import lowest
from torsade.motion.supports import Fiber, chain, controls_at, shape_along

CRITICAL = 2 * np.pi * np.sqrt(3) * 1.3
"""14.1476 rad for Poisson's ratio 0.3, B/C = 1 + nu (ERRATA chapter 5)."""


def growth(twist, link, n=120, R=1.0, h=0.02):
    """Growth rate of the two-lobed mode out of the plane, in units of its bending rate B n^2/(eta A R^2).

    A closed fiber holds whole turns only. What buckles the ring is its twisting moment C Tw/L, so a ring
    with Lk turns stands for one of nu = 0.3 with any twist when C is scaled: C = twist B/(1.3 2 pi Lk).
    The rate is read late, when what is left of the in-plane mode it is mixed with has died out.
    """
    material = Material("ring", E=1e3, E_b=1e3, nu=0.3, rho=1.0, eta=10.0)
    m = model(material, Section(h))
    m = m._replace(C=m.B * twist / (1.3 * 2 * np.pi * link))
    x = circle(n, R)
    a = assemble([x], [True])
    phi = np.arctan2(x[:, 1], x[:, 0])
    x = x + 1e-3 * h * np.cos(2 * phi)[:, None] * np.array([0, 0, 1.0])
    state = twist_closed(initial_state(a, [x]), slice(0, n), link)
    assert total_twist(a, state) == pytest.approx(2 * np.pi * link, abs=1e-6)
    motion = Motion(a, m, ends.free(a), state, Stepping(tolerance=1e-6, solver_tolerance=1e-8))
    unit = m.B * (2 / R) ** 2 / m.eta_A

    def amplitude():
        z = motion.state.x[:, 2]
        return abs(np.sum(z * np.exp(2j * phi)))

    times, logs = [], []
    for t in np.linspace(6.0, 9.0, 5) / unit:
        motion.advance(t)
        times.append(t * unit)
        logs.append(np.log(amplitude()))
    slope, offset = np.polyfit(times, logs, 1)
    assert np.abs(np.polyval([slope, offset], times) - logs).max() < 1e-3
    return slope


def buckling_twist(link, n=120):
    """Where the growth rate vanishes, between 3 % below and 3 % above the critical twist."""
    twists = CRITICAL * np.array([0.97, 1.03])
    rates = np.array([growth(np.sign(link) * t, link, n) for t in twists])
    assert rates[0] < 0 < rates[1]
    return twists[0] - rates[0] * (twists[1] - twists[0]) / (rates[1] - rates[0])


@pytest.mark.parametrize("link", [1, 2, -3])
def test_ring_buckles_at_the_critical_twist(link):
    """Growth rates just below and above 14.1476 rad have opposite signs; their zero is there to 1 %."""
    assert pytest.approx(14.1476, abs=1e-4) == CRITICAL
    assert buckling_twist(link) == pytest.approx(14.1476, rel=0.01)


def test_buckling_twist_converges_with_the_square_of_the_mesh():
    """60, 120, 240 nodes: the error falls by four, and extrapolates to 14.1476 rad to 0.02 %."""
    found = np.array([buckling_twist(2, n) for n in (60, 120, 240)])
    errors = found / CRITICAL - 1
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert found[2] - (found[1] - found[2]) / 3 == pytest.approx(CRITICAL, rel=2e-4)


def test_untwisted_ring_returns_at_the_rate_of_bending_and_twist():
    """Without twist the same mode decays: stable, at a rate of order one in its own unit."""
    assert -1.5 < growth(1e-6, 1) < -0.3


def least_stiffness(n, twist, C=1 / 1.3):
    """Least eigenvalue of a ring of n edges, clamped to itself at its seam, with its end rotation held.

    The node across is held in z: else the whole could turn about the tangent at the seam. Reactions are those
    that balance the round polygon best.
    """
    ring = Fiber(edges=n, C=C)
    c = chain(ring, (CLAMP, CLAMP), nodes=[(n // 2, 2)], rotation_held=True)
    phi = np.concatenate([[0], 2 * np.pi * (np.arange(n) + 0.5) / n, [2 * np.pi]])
    shape = shape_along(c, np.column_stack([np.cos(phi), np.sin(phi), 0 * phi]))._replace(torque=C * twist)
    controls = controls_at(c, rotation=twist)
    system = c.system(shape, controls)
    reaction = np.linalg.lstsq(system.border[:, :4], -system.residual, rcond=None)[0]
    return lowest(c, c.system(shape._replace(reaction=reaction), controls))[0][0]


def test_ring_buckles_where_its_stiffness_vanishes():
    """Statics alone: 14.1476 rad to 0.06 % with 240 edges, second order, to 1e-5 when extrapolated."""
    sizes = [60, 120, 240]
    found = np.array([brentq(lambda t, n=n: least_stiffness(n, t), 13.0, 15.0) for n in sizes])
    assert found[-1] == pytest.approx(CRITICAL, rel=6e-4)
    assert order(sizes, found / CRITICAL - 1) == pytest.approx(2.0, abs=0.02)
    assert found[2] - (found[1] - found[2]) / 3 == pytest.approx(CRITICAL, rel=1e-5)
