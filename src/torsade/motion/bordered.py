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
        self._border = right, right if left is None else left, corner
        self._factor = np.empty_like(band)
        self._reduced = np.empty_like(right), np.empty_like(corner)
        self.negative = int(banded.condense(band, shift, self._border, self._factor, self._reduced))
        if left is None and len(corner):
            schur = self._reduced[1]
            self.negative += int((np.linalg.eigvalsh(0.5 * (schur + schur.T)) < 0).sum())

    def solve(self, r: Floats, s: Floats) -> tuple[Floats, Floats]:
        """Solutions dq (n,) and ds (k,) for right-hand sides r (n,) and s (k,), refined.

        Raises
        ------
        numpy.linalg.LinAlgError
            When constraints depend on each other.
        """
        dq, ds, regular = banded.solve_bordered(
            self._band, self._shift, self._factor, self._border, self._reduced, r, s, REFINEMENTS
        )
        if not regular:
            raise np.linalg.LinAlgError("constraints depend on each other")
        return dq, ds
