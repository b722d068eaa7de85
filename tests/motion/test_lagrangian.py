"""What kernels do in place of numpy gives the same bits; coordinates and changes of edges belong together."""

from __future__ import annotations

import math

import numpy as np
import pytest

from motion.still import PIVOT, arch, waving
from torsade.motion import lagrangian, newton_kernels
from torsade.motion.branches import Path
from torsade.motion.chain import Chain
from torsade.motion.supports import Fiber, Support, chain, controls_at

CHAINS = (
    chain(Fiber(edges=30), (PIVOT, PIVOT)),
    chain(Fiber(edges=30), (PIVOT, PIVOT), rotation_held=True),
    chain(Fiber(edges=12, EA=50.0, C=0.7), (PIVOT, Support("fixed")), angles=True),
)


@pytest.mark.parametrize("n", [0, 1, 7, 8, 9, 50, 127, 128, 129, 300, 1001])
def test_sums_are_those_of_numpy(n: int) -> None:
    values = np.random.default_rng(n).normal(size=n)
    assert lagrangian.total(values) == values.sum()


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
    assert np.array_equal(lagrangian.lower(basis, change), lowered)


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


def test_hypotenuses_are_those_of_python() -> None:
    pairs = np.random.default_rng(5).lognormal(0.0, 3.0, size=(20_000, 2))
    assert newton_kernels.hypotenuse(3.0, 4.0) == 5.0
    assert all(newton_kernels.hypotenuse(a, b) == math.hypot(a, b) for a, b in pairs.tolist())


def test_no_point_is_found_where_numbers_are_none() -> None:
    c = CHAINS[0]
    shape, path = arch(c, 1.0), Path(controls_at(c, (0.7, 0.0, 0.0)), controls_at(c, (0.5, 0.0, 0.0)))
    still = newton_kernels.Tangent(np.full((len(shape.edge), 4), np.nan), np.zeros(c.held), 1.0)
    assert newton_kernels.correct(c, path.start, path.rate, 1.0, 1.0, shape, 0.0, still, 0.1)[0] == -1
    lost = path.start._replace(value=np.full(3, np.nan))
    assert not newton_kernels.newton(c, shape, lost, 12, np.empty((0, len(shape.edge), 4)))[0]
