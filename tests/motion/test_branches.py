"""Paths through folds, bifurcations and onto other branches."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from motion.still import ACROSS, PIVOT, arch, nodes, straight
from torsade.motion.branches import Path, Point, bifurcation, carry, fold, follow, switch
from torsade.motion.chain import Chain
from torsade.motion.supports import Fiber, Support, chain, controls_at
from torsade.motion.trust import minimise, newton


def column(edges: int = 100) -> tuple[Chain, Path]:
    """A hinged column under thrust, from 0.8 to 1.5 times its Euler load."""
    c = chain(Fiber(edges=edges), (PIVOT, Support("plane", ACROSS)))
    thrusts = [controls_at(c, force=(-P * np.pi**2, 0.0, 0.0)) for P in (0.8, 1.5)]
    return c, Path(*thrusts)


def crossing(c: Chain, path: Path) -> tuple[Point, np.ndarray]:
    """Where the straight column becomes unstable."""
    points = list(follow(c, straight(c), path))
    assert points[-1].p == 1.0
    assert [p.unstable for p in points] == sorted(p.unstable for p in points)
    pair = next(k for k in range(len(points)) if points[k + 1].unstable)
    found = bifurcation(c, path, points[pair], points[pair + 1])
    assert found is not None
    return found


def test_the_euler_load_is_a_bifurcation() -> None:
    """At P = pi^2 B/L^2 of the discrete column, 1.4e-4 off with 50 edges a side; its mode is a cosine."""
    c, path = column()
    at, mode = crossing(c, path)
    P = -path.at(at.p).load[1, 0] / np.pi**2
    assert pytest.approx(1.0, abs=2e-4) == P
    s = (np.arange(100) + 0.5) / 100
    turn = mode[1:-1, 1] / np.abs(mode[1:-1, 1]).max()
    assert np.abs(np.abs(turn) - np.abs(np.cos(np.pi * s))).max() < 1e-3
    assert np.abs(mode[:, [0, 2]]).max() < 1e-9


@pytest.mark.parametrize("side", [1, -1])
def test_the_buckled_branch(side: int) -> None:
    """Switched onto and followed to 1.5 P_Euler: end distance of the elastica to 1e-3; stable all the way."""
    c, path = column(200)
    at, mode = crossing(c, path)
    begun = switch(c, path, at, mode, side * 0.05)
    assert begun is not None
    branch = list(follow(c, begun.shape, path, p=begun.p, tangent=begun.tangent))
    assert branch[-1].p == 1.0
    assert all(point.unstable == 0 for point in branch)
    heights = [nodes(c, point.shape)[100, 1] for point in branch]
    assert np.sign(heights[-1]) == np.sign(heights[0])
    m = brentq(lambda m: ellipk(m) - np.pi / 2 * np.sqrt(1.5), 1e-6, 0.99)
    assert nodes(c, branch[-1].shape)[-1, 0] == pytest.approx(2 * ellipe(m) / ellipk(m) - 1, rel=1e-3)


def test_the_two_sides_of_a_pitchfork_mirror_each_other() -> None:
    c, path = column(60)
    at, mode = crossing(c, path)
    up, down = (switch(c, path, at, mode, a) for a in (0.1, -0.1))
    assert up is not None
    assert down is not None
    assert up.p == pytest.approx(down.p, abs=1e-9)
    mirrored = nodes(c, down.shape) * [1, -1, 1]
    assert nodes(c, up.shape) == pytest.approx(mirrored, abs=1e-8)


def twisted(d: float) -> tuple[Chain, Path, list[Point]]:
    """An arch over the distance d whose torque is raised until it snaps, and beyond."""
    c = chain(Fiber(edges=100), (PIVOT, PIVOT))
    path = Path(controls_at(c, (d, 0.0, 0.0)), controls_at(c, (d, 0.0, 0.0), torque=20.0))
    points = []
    for point in follow(c, minimise(c, arch(c, 1.5), path.start), path):
        points.append(point)
        if len(points) > 2 and points[-2].p > point.p + 0.03:
            break
    return c, path, points


def test_a_fold_is_passed_and_found() -> None:
    """The torque of an arch has a largest value: beyond it the branch goes on with less.

    At the fold p is least sensitive: p falls off with the square of the way along the branch, and the tangent
    has no p. There one more motion, at torque held, becomes unstable.
    """
    c, path, points = twisted(0.3)
    turn = next(k for k, point in enumerate(points) if point.tangent.p < 0)
    last = fold(c, path, points[turn - 1], points[turn])
    assert last.p >= max(point.p for point in points) - 1e-9
    assert 0 < last.tangent.p * path.size(c) < 0.05
    assert points[turn].unstable == points[turn - 1].unstable + 1
    assert newton(c, last.shape, path.at(1.02 * last.p)) is None


def test_a_path_and_its_steps_agree_with_one_step() -> None:
    """A short path in one step ends where a long one does that is followed in many."""
    c = chain(Fiber(edges=50), (PIVOT, PIVOT))
    begin = controls_at(c, (0.8, 0.0, 0.0))
    path = Path(begin, controls_at(c, (0.79, 0.0, 0.0), torque=0.4))
    shape = minimise(c, arch(c, 1.0), begin)
    at_once = carry(c, shape, path)
    assert at_once is not None
    *_, last = follow(c, shape, path, first=0.02, largest=0.05)
    assert last.p == 1.0
    assert at_once.edge == pytest.approx(last.shape.edge, abs=1e-9)
    assert carry(c, shape, Path(begin, controls_at(c, (0.8, 0.0, 0.0), torque=5.0))) is None


def test_there_and_back_is_the_same_shape() -> None:
    """Equilibria do not depend on the way: twist up and down again gives the planar arch, to 1e-8."""
    c = chain(Fiber(edges=50), (PIVOT, PIVOT))
    begin = controls_at(c, (0.7, 0.0, 0.0))
    end = controls_at(c, (0.7, 0.0, 0.0), torque=4.0)
    shape = minimise(c, arch(c, 1.0), begin)
    *_, up = follow(c, shape, Path(begin, end))
    *_, down = follow(c, up.shape, Path(end, begin))
    assert down.p == up.p == 1.0
    assert down.shape.edge == pytest.approx(shape.edge, abs=1e-8)
    assert abs(down.shape.turned) < 1e-8
