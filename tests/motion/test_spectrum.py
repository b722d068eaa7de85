"""Eigenvalues of the constrained Hessian against closed forms and a dense computation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigvalsh, null_space

from motion.still import ACROSS, HINGE, PIVOT, arch, straight
from motion.test_chain import full
from torsade.motion.spectrum import lowest, unstable_modes
from torsade.motion.supports import Fiber, Support, chain, controls_at
from torsade.motion.trust import minimise


def test_a_straight_column() -> None:
    """B n^2 pi^2/L^2 - P, twice each (two directions across); in SI units, second order in the edges."""
    B, L, P = 3e-4, 0.2, 0.05
    exact = np.repeat([B * n**2 * np.pi**2 / L**2 - P for n in (1, 2, 3)], 2)
    off = []
    for edges in (100, 200):
        c = chain(Fiber(L, edges, B, B), (HINGE, Support("free", ACROSS)))
        off.append(lowest(c, c.system(straight(c), controls_at(c, force=(-P, 0.0, 0.0))), 6)[0] - exact)
    assert np.abs(off[1]).max() < 1e-3 * exact[-1]
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("held", [False, True])
def test_a_twisted_arch_against_all_eigenvalues(held: bool) -> None:
    """Dense: the null space of the constraints, the Hessian projected on it, the rotation as a rank one."""
    c = chain(Fiber(edges=30, C=0.8), (PIVOT, PIVOT), rotation_held=held)
    controls = controls_at(c, (0.75, 0.0, 0.0), torque=2.0, rotation=2.5)
    shape = minimise(c, arch(c, 1.0), controls)
    system = c.system(shape, controls)
    hessian, border = full(system), system.border[:, :3]
    if held:
        row = system.border[:, 3]
        hessian = hessian + np.outer(row, row) * c.C / c.twisted_length
    moving = np.abs(system.basis).max(axis=1).ravel() > 0
    free = null_space(border[moving].T)
    dense = eigvalsh(free.T @ hessian[np.ix_(moving, moving)] @ free)
    values, modes = lowest(c, system, 4)
    assert values == pytest.approx(dense[:4], rel=1e-7)
    for bound in (0.0, dense[1] + 1e-3, dense[3] - 1e-3):
        assert unstable_modes(c, system, bound) == (dense < bound).sum()
    angle = modes[:, :, :3] / np.linalg.norm(shape.edge, axis=1)[None, :, None]
    norms = np.einsum("e,iec,iec->i", c.mass, angle, angle)
    assert norms == pytest.approx(1.0, rel=1e-9)
