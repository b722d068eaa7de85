"""Newton systems of constrained minimisation: a banded Hessian bordered by a few dense rows.

    [ H  U ] [ dq ]   [ r ]
    [ V' D ] [ ds ] = [ s ]

H (n, n) is banded, U and V (n, k) are the gradients of constraints. With U = V the signs of the pivots
count the negative eigenvalues of the whole (Haynsworth), and these, less one for each constraint, are the
negative eigenvalues of H on the tangent space of the constraints (Gould 1985): stability costs one
factorisation.
"""

from __future__ import annotations

import numpy as np

from torsade.arrays import Floats
from torsade.rod import banded

__all__ = ["Bordered"]

REFINEMENTS = 2


class Bordered:
    """A bordered matrix, factorised; H is given as rows (n, w + 1), see `torsade.rod.banded`.

    Attributes
    ----------
    negative : number of negative eigenvalues when U = V
    """

    def __init__(
        self, band: Floats, right: Floats, corner: Floats, left: Floats | None = None, shift: float = 0.0
    ) -> None:
        self._band, self._shift = band, shift
        self._right, self._left, self._corner = right, right if left is None else left, corner
        self._factor = np.empty_like(band)
        self.negative = int(banded.factorise(band, shift, self._factor))
        self._inner = right.copy()
        banded.solve(self._factor, self._inner)
        self._schur = corner - self._left.T @ self._inner
        if left is None and len(corner):
            self.negative += int((np.linalg.eigvalsh(0.5 * (self._schur + self._schur.T)) < 0).sum())

    def solve(self, r: Floats, s: Floats) -> tuple[Floats, Floats]:
        """Solutions dq (n,) and ds (k,) for right-hand sides r (n,) and s (k,), refined."""
        dq, ds = self._once(r, s)
        product = np.empty((len(r), 1))
        for _ in range(REFINEMENTS):
            banded.multiply(self._band, dq[:, None], product)
            left = r - product[:, 0] - self._shift * dq - self._right @ ds
            below = s - self._left.T @ dq - self._corner @ ds
            more = self._once(left, below)
            dq, ds = dq + more[0], ds + more[1]
        return dq, ds

    def _once(self, r: Floats, s: Floats) -> tuple[Floats, Floats]:
        x = np.ascontiguousarray(r[:, None]).copy()
        banded.solve(self._factor, x)
        ds = np.linalg.solve(self._schur, s - self._left.T @ x[:, 0]) if len(s) else np.zeros(0)
        return np.asarray(x[:, 0] - self._inner @ ds), np.asarray(ds)
