"""Least energy from far away, and what stretches."""

from __future__ import annotations

import numpy as np
import pytest

from motion.still import ACROSS, CLAMP, HINGE, NOWHERE, PIVOT, arch, curvature, nodes, straight
from torsade.errors import TorsadeError
from torsade.motion.spectrum import lowest, unstable_modes
from torsade.motion.supports import Fiber, Support, chain, controls_at, shape_along
from torsade.motion.trust import minimise, newton


def test_a_tangle_of_edges_straightens() -> None:
    """From directions at random a clamped fiber without loads finds its only minimum: straight."""
    c = chain(Fiber(edges=40), (CLAMP, Support("free", NOWHERE)))
    rng = np.random.default_rng(3)
    tangent = np.array([1.0, 0.0, 0.0]) + 0.9 * rng.normal(size=(41, 3))
    tangent[0] = 1.0, 0.0, 0.0
    shape = minimise(c, shape_along(c, tangent / np.linalg.norm(tangent, axis=1)[:, None]), controls_at(c))
    assert nodes(c, shape)[-1] == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


def test_a_column_leaves_its_unstable_straight_state() -> None:
    """Euler: above pi^2 the straight column is no minimum; disturbed a little it ends in the buckled one.

    End distance of the elastica under 1.1 P_Euler: 2 E(k)/K(k) - 1 with K(k) = pi/2 sqrt(1.1).
    """
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipk

    c = chain(Fiber(edges=100), (PIVOT, Support("plane", ACROSS)))
    controls = controls_at(c, force=(-1.1 * np.pi**2, 0.0, 0.0))
    begin = arch(c, 1e-3)
    assert unstable_modes(c, c.system(straight(c), controls)) == 1
    shape = minimise(c, begin, controls)
    assert unstable_modes(c, c.system(shape, controls)) == 0
    m = brentq(lambda m: ellipk(m) - np.pi / 2 * np.sqrt(1.1), 1e-6, 0.9)
    assert nodes(c, shape)[-1, 0] == pytest.approx(2 * ellipe(m) / ellipk(m) - 1, rel=1e-3)


def test_energy_falls_to_the_same_shape_from_many_starts() -> None:
    """Arches of any slope, even with folds in space, relax to one energy, within 1e-10."""
    c = chain(Fiber(edges=60), (PIVOT, PIVOT))
    controls = controls_at(c, (0.6, 0.0, 0.0))
    found = []
    for slope, out in ((0.2, 0.3), (1.3, 0.0), (1.8, -0.6)):
        shape = arch(c, slope)
        lift = out * np.sin(2 * np.pi * np.clip(c.assembly.edge_arclength, 0, 1))
        edge = shape.edge + np.linalg.norm(shape.edge, axis=1)[:, None] * np.outer(lift, [0, 0, 1.0])
        edge *= (np.linalg.norm(shape.edge, axis=1) / np.linalg.norm(edge, axis=1))[:, None]
        now = minimise(c, shape._replace(edge=edge), controls)
        found.append(c.potential(now, controls))
        assert abs(nodes(c, now)[:, 2]).max() < 1e-8
    assert np.array(found) == pytest.approx(found[0], rel=1e-10)


def test_a_pulled_fiber_stretches_by_force_over_stiffness() -> None:
    c = chain(Fiber(edges=10, EA=50.0), (HINGE, Support("free", NOWHERE)))
    shape = minimise(c, straight(c), controls_at(c, force=(4.0, 0.0, 0.0)))
    assert nodes(c, shape)[-1, 0] == pytest.approx(1 + 4.0 / 50.0, rel=1e-12)


def test_a_column_that_shortens_buckles_later() -> None:
    """P (1 - P/EA) = pi^2 B/L^2, bending counted per rest length: lowest eigenvalue zero there, to 1e-4."""
    from scipy.optimize import brentq

    EA = 200.0
    c = chain(Fiber(edges=200, EA=EA), (HINGE, Support("free", ACROSS)))

    def least(P: float) -> float:
        found = newton(c, straight(c), controls_at(c, force=(-P, 0.0, 0.0)))
        assert found is not None
        return float(lowest(c, found[1])[0][0])

    exact = (1 - np.sqrt(1 - 4 * np.pi**2 / EA)) * EA / 2
    assert brentq(least, 9.0, 12.0) == pytest.approx(exact, rel=1e-4)


def test_stiff_fibers_tend_to_inextensible_ones() -> None:
    """Curvature of the arch: the difference falls as 1/EA."""
    rigid = chain(Fiber(edges=50), (PIVOT, PIVOT))
    controls = controls_at(rigid, (0.7, 0.0, 0.0))
    exact = curvature(rigid, minimise(rigid, arch(rigid, 1.0), controls)).max()
    off = []
    for EA in (1e3, 1e4):
        c = chain(Fiber(edges=50, EA=EA), (PIVOT, PIVOT))
        off.append(curvature(c, minimise(c, arch(c, 1.0), controls)).max() - exact)
    assert off[0] / off[1] == pytest.approx(10, rel=0.1)


def test_no_equilibrium_is_said_so() -> None:
    """An end held farther away than the fiber is long."""
    c = chain(Fiber(edges=20), (PIVOT, PIVOT))
    with pytest.raises(TorsadeError, match="no equilibrium was found"):
        minimise(c, arch(c, 1.0), controls_at(c, (1.2, 0.0, 0.0)))
