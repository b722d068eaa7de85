"""Stability: the lowest eigenvalues of the energy's second variation among the motions that are allowed."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from torsade.arrays import Floats
from torsade.motion.bordered import Bordered
from torsade.motion.chain import Chain, System

__all__ = ["lowest", "unstable_modes"]


def unstable_modes(chain: Chain, system: System, below: float = 0.0) -> int:
    """How many eigenvalues of the constrained Hessian are less than `below` [N]."""
    return Bordered(system.band, system.border, system.corner, shift=-below).negative - chain.held


def lowest(chain: Chain, system: System, count: int = 1) -> tuple[Floats, Floats]:
    """The least eigenvalues (count,) [N], and their modes (count, n_edges, 4), each of norm sum l |dt|^2 = 1.

    d2E = sum l dt . H dt among motions that what is held allows; they are found by Lanczos iteration around a
    value below all of them, which the inertia of the shifted matrix tells.
    """
    shift = -chain.B / chain.twisted_length**2
    while unstable_modes(chain, system, shift) > 0:
        shift *= 4.0
    solver = Bordered(system.band, system.border, system.corner, shift=-shift)
    n, none = len(system.residual), np.zeros(len(system.gap))
    inverse = LinearOperator((n, n), matvec=lambda r: solver.solve(np.ravel(r), none)[0], dtype=np.float64)
    start = np.cos(np.arange(n) ** 1.5)  # anything that is not orthogonal to a mode
    values, vectors = eigsh(inverse, k=count, which="LA", v0=start, tol=1e-12)
    order = np.argsort(values)[::-1]
    modes = np.array([system.lift(vectors[:, i]) for i in order])
    return shift + 1.0 / values[order], modes
