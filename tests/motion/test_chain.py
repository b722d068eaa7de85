"""A fiber's Lagrangian in the coordinates of its edges: derivatives, constraints and twist both ways."""

from __future__ import annotations

import numpy as np
import pytest

from motion.still import ACROSS, CLAMP, HINGE, PIVOT, arch, curvature, lagrangian, nodes, waving
from torsade.motion.chain import Chain, Controls, System
from torsade.motion.supports import Fiber, Support, chain, controls_at
from torsade.motion.trust import minimise, newton

KINDS = {
    "pivots": (Fiber(edges=9, C=0.8), (PIVOT, PIVOT), {}),
    "clamps": (Fiber(edges=9, C=0.8), (CLAMP, Support("fixed", ACROSS)), {}),
    "hinges that stretch": (Fiber(edges=9, C=0.8, EA=40.0), (HINGE, HINGE), {}),
    "angles": (Fiber(edges=9, C=0.8), (PIVOT, PIVOT), {"angles": True}),
    "angles and stretch": (Fiber(edges=9, C=0.8, EA=40.0), (CLAMP, PIVOT), {"angles": True}),
    "angles, rotation held": (Fiber(edges=9, C=0.8), (PIVOT, CLAMP), {"angles": True, "rotation_held": True}),
    "a node held": (Fiber(edges=9, C=0.8), (PIVOT, PIVOT), {"nodes": [(4, 1), (6, 2)]}),
}


def given(c: Chain) -> Controls:
    value = tuple(0.1 * np.arange(1, len(c.weight) + 1))
    return controls_at(c, value, force=(0.4, -0.7, 0.2), torque=1.7, rotation=0.3)


@pytest.mark.parametrize("kind", list(KINDS))
def test_derivatives_of_the_lagrangian(kind: str) -> None:
    """Residual and Hessian by fourth-order differences of the Lagrangian along great circles, to 1e-7."""
    fiber, ends, more = KINDS[kind]
    c = chain(fiber, ends, **more)
    shape, controls = waving(c, 3), given(c)
    system = c.system(shape, controls)
    moving = np.abs(system.basis).max(axis=1) > 0

    def at(q: np.ndarray) -> float:
        return lagrangian(c, c.moved(shape, system.lift(q)), controls)

    rng = np.random.default_rng(0)
    for _ in range(5):
        u = (moving * rng.normal(size=moving.shape) * np.sqrt(c.mass)[:, None]).ravel()
        h = 2e-3
        v = {k: at(k * h * u) for k in range(-3, 4)}
        slope = (v[-2] - 8 * v[-1] + 8 * v[1] - v[2]) / (12 * h)
        bend = (2 * v[-3] - 27 * v[-2] + 270 * v[-1] - 490 * v[0] + 270 * v[1] - 27 * v[2] + 2 * v[3]) / 180
        assert slope == pytest.approx(system.residual @ u, rel=1e-7, abs=1e-7)
        assert bend / h**2 == pytest.approx(u @ full(system) @ u, rel=1e-5, abs=1e-5)


def full(system: System) -> np.ndarray:
    n, width = system.band.shape
    out = np.zeros((n, n))
    for i in range(n):
        for k in range(min(width - 1, i) + 1):
            out[i, i - k] = out[i - k, i] = system.band[i, k]
    return out


@pytest.mark.parametrize("kind", list(KINDS))
def test_borders_are_the_gradients_of_what_is_held(kind: str) -> None:
    fiber, ends, more = KINDS[kind]
    c = chain(fiber, ends, **more)
    shape, controls = waving(c, 4), given(c)
    system = c.system(shape, controls)
    u = np.random.default_rng(1).normal(size=len(system.residual)) / 10
    ahead, behind = (c.system(c.moved(shape, system.lift(t * u)), controls).gap for t in (1e-5, -1e-5))
    assert (ahead - behind) / 2e-5 == pytest.approx(system.border.T @ u, abs=1e-8)


def test_edges_keep_their_length_exactly() -> None:
    """Inextensible edges move on spheres: not one part in 1e15 is lost in a hundred moves."""
    c = chain(Fiber(edges=20), (PIVOT, PIVOT))
    shape = waving(c, 5)
    rng = np.random.default_rng(2)
    for _ in range(100):
        system = c.system(shape, given(c))
        shape = c.moved(shape, system.lift(rng.normal(size=len(system.residual))))
    assert np.linalg.norm(shape.edge[1:-1], axis=1) == pytest.approx(1 / 20, rel=1e-13)
    assert np.abs(shape.edge[[0, -1], 2]).max() < 1e-14  # grips stay in their planes


@pytest.mark.parametrize("held", [False, True])
def test_twist_with_angles_and_without_is_the_same(held: bool) -> None:
    """Twist is even in an open fiber (thesis 2.33 at rest), so eliminating it changes nothing: to 1e-9."""
    fiber = Fiber(edges=60, C=1 / 1.3)
    found = []
    for angles in (False, True):
        c = chain(fiber, (PIVOT, PIVOT), angles=angles, rotation_held=held)
        begin = controls_at(c, (0.8, 0.0, 0.0))
        shape = minimise(c, arch(c, 1.0), begin)
        for share in np.linspace(0.1, 1, 10):
            now = controls_at(c, (0.8, 0.0, 0.0), torque=3.0 * share, rotation=4.0 * share)
            out = newton(c, shape, now)
            assert out is not None
            shape = out[0]
        m = c.hinge_twist(shape) / c.assembly.hinge_length
        assert m == pytest.approx(m[0], rel=1e-9)
        torque = shape.torque if held else 3.0
        assert m[0] == pytest.approx(torque / fiber.C, rel=1e-9)
        found.append((nodes(c, shape), curvature(c, shape), shape.reaction, c.rotation(shape)))
    for one, other in zip(*found, strict=True):
        assert one == pytest.approx(other, abs=1e-8)


def test_reactions_are_the_change_of_energy_with_what_is_held() -> None:
    """dE/dD = reaction along x, by central differences of the least energy (envelope theorem), to 1e-6."""
    c = chain(Fiber(edges=80), (PIVOT, PIVOT))

    def solved(d: float) -> tuple[float, float]:
        controls = controls_at(c, (d, 0.0, 0.0))
        shape = minimise(c, arch(c, 1.2), controls)
        return c.potential(shape, controls), float(shape.reaction[0])

    h = 1e-4
    slope = (solved(0.7 + h)[0] - solved(0.7 - h)[0]) / (2 * h)
    assert slope == pytest.approx(solved(0.7)[1], rel=1e-6)
