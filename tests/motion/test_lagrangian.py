"""Coordinates and changes of edges belong together; Newton's method says when it finds nothing."""

from __future__ import annotations

import numpy as np
import pytest

from motion.still import PIVOT, arch, waving
from torsade.motion import lagrangian
from torsade.motion.branches import Path
from torsade.motion.chain import Chain
from torsade.motion.newton_kernels import Tangent, Way, newton
from torsade.motion.supports import Fiber, Support, chain, controls_at
from torsade.motion.trust import as_modes, minimise, upwards

CHAINS = (
    chain(Fiber(edges=30), (PIVOT, PIVOT)),
    chain(Fiber(edges=30), (PIVOT, PIVOT), rotation_held=True),
    chain(Fiber(edges=12, EA=50.0, C=0.7), (PIVOT, Support("fixed")), angles=True),
)


@pytest.mark.parametrize("c", CHAINS)
def test_lowering_undoes_lifting(c: Chain) -> None:
    system = c.system(waving(c, 1), controls_at(c, (0.7, 0.0, 0.0)))
    q = np.random.default_rng(2).normal(size=len(system.residual))
    moves = (system.basis != 0.0).any(axis=1).ravel()
    assert lagrangian.lower(system.basis, system.lift(q)) == pytest.approx(np.where(moves, q, 0.0), abs=1e-12)


@pytest.mark.parametrize("c", CHAINS)
def test_coordinates_are_those_of_numpy(c: Chain) -> None:
    system = c.system(waving(c, 1), controls_at(c, (0.7, 0.0, 0.0)))
    basis, rng = system.basis, np.random.default_rng(3)
    q, change = rng.normal(size=len(system.residual)), rng.normal(size=(len(basis), 4))
    lifted = np.einsum("ecd,ed->ec", basis, q.reshape(len(basis), -1))
    assert system.lift(q) == pytest.approx(lifted, rel=1e-14, abs=1e-15)
    size = np.maximum(np.einsum("ecd,ecd->ed", basis, basis), 1e-300)
    lowered = (np.einsum("ecd,ec->ed", basis, change) / size).ravel()
    assert lagrangian.lower(basis, change) == pytest.approx(lowered, rel=1e-13, abs=1e-15)


@pytest.mark.parametrize("c", CHAINS)
def test_rates_of_residuals_and_gaps(c: Chain) -> None:
    """Residual and gap are linear in the controls, so differences of any size give their rates."""
    shape = waving(c, 4)
    begin = controls_at(c, (0.7, 0.0, 0.0), torque=0.3, rotation=0.1)
    end = controls_at(c, (0.5, 0.1, 0.0), force=(1.0, 2.0, 3.0), torque=1.1, rotation=0.6)
    before, after = (c.system(shape, controls) for controls in (begin, end))
    residual, gap = lagrangian.by_path(c, shape, before, Path(begin, end).rate)
    assert residual == pytest.approx(after.residual - before.residual, abs=1e-11)
    assert gap == pytest.approx(after.gap - before.gap, abs=1e-13)


def test_no_point_is_found_where_numbers_are_none() -> None:
    c = CHAINS[0]
    shape, path = arch(c, 1.0), Path(controls_at(c, (0.7, 0.0, 0.0)), controls_at(c, (0.5, 0.0, 0.0)))
    nowhere = Tangent(np.full((len(shape.edge), 4), np.nan), np.zeros(c.held), 1.0)
    way = Way(path.start, path.rate, 1.0, free=True, onwards=True)
    assert newton(c, way, shape, 0.0, nowhere, 0.1, as_modes((), c), 9)[0] == -1
    lost = Way(path.start._replace(value=np.full(3, np.nan)), path.rate, 1.0, free=False, onwards=False)
    assert newton(c, lost, shape, 0.0, upwards(c), 0.0, as_modes((), c), 12)[0] == -1


def test_directions_are_those_of_differences() -> None:
    """Two points on a branch differ by the step along its direction, to first order."""
    c, step = CHAINS[0], 1e-4
    path = Path(controls_at(c, (0.7, 0.0, 0.0)), controls_at(c, (0.5, 0.0, 0.0)))
    way = Way(path.start, path.rate, path.size(c), free=False, onwards=True)
    shape = minimise(c, arch(c, 1.0), path.start)
    found, _, before, _, along = newton(c, way, shape, 0.0, upwards(c), 0.0, as_modes((), c), 12)
    other = way._replace(free=True)
    corrections, p, after, _, _ = newton(c, other, before, 0.0, along, step, as_modes((), c), 9)
    assert found >= 0
    assert 0 <= corrections <= 2
    assert p == pytest.approx(step * along.p, rel=1e-3)
    assert after.edge - before.edge == pytest.approx(step * along.change[:, :3], abs=10 * step**2)
    assert after.reaction - before.reaction == pytest.approx(step * along.multipliers, rel=1e-2)
