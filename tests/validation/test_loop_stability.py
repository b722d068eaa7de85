"""Where a planar loop turns out of its plane: a linear stability analysis beside the run of R1.

Tilt the tangent of the planar loop theta(s) out of the plane by a small angle zeta(s). To second order the
energy, with the work of the tension T, changes by

    ½ ∫ (B zeta'² + (T cos theta - B theta'²) zeta²) ds + ½ (C/L) (∫ theta' zeta ds)²

where the last term is the twist that gripped ends put in for the writhe that is lost; it is absent when an
end may spin. zeta vanishes at both grips, and so does ∫ zeta ds, since both lie in the plane.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipj

from torsade.protocols import Reidemeister
from torsade.protocols.moves import LOOP, planar_loop

pytestmark = pytest.mark.slow

C_OVER_B = {"gripped": 1 / 1.3, "swivel": 0.0}
"""Of a fiber with nu = 0.3; a free end holds no twist."""


def stiffness(distance: float, twist: float, n: int = 300) -> float:
    """Least eigenvalue of the second variation in units of B/L², over tilts even about the middle."""
    loop = planar_loop(distance)
    s = np.arange(1, n) / n
    sn, cn, dn, _ = ellipj((2 * s - 1) * loop.K, loop.m)
    theta, turn = np.pi + 2 * np.arctan2(sn, cn), 4 * loop.K * dn
    operator = np.diag(2 * n**2 + loop.tension * np.cos(theta) - turn**2)
    operator -= n**2 * (np.eye(n - 1, k=1) + np.eye(n - 1, k=-1))
    operator += twist * np.outer(turn, turn) / n
    # Odd tilts hold the rotation about the line of the ends, which costs nothing.
    middle = n // 2
    basis = np.zeros((n - 1, middle))
    basis[np.arange(middle), np.arange(middle)] = 1
    basis[n - 2 - np.arange(middle), np.arange(middle)] = 1
    basis /= np.linalg.norm(basis, axis=0)
    level = basis.T @ np.ones(n - 1)
    allowed = np.linalg.svd(level[None])[2][1:].T
    reduced = basis @ allowed
    return float(np.linalg.eigvalsh(reduced.T @ operator @ reduced)[0])


@pytest.mark.parametrize(("ends", "onset"), [("swivel", 0.302), ("gripped", 0.325)])
def test_the_loop_leaves_its_plane_where_it_becomes_unstable(ends: str, onset: float) -> None:
    """Before that it is as flat as its own thickness lets it be; soon after it stands out of the plane."""
    found = brentq(lambda d: stiffness(d, C_OVER_B[ends]), 0.2, 0.4, xtol=1e-4)
    assert found == pytest.approx(onset, abs=2e-3)
    length = 40e-3
    spec = Reidemeister(move="R1", ends=ends, length=length, spacing=2e-4, duration=2400, frames=240)
    data = spec.run().dataset
    distance = LOOP[0] + data["displacement"].values / length
    height = np.abs(data["position"].values[:, :, 2]).max(axis=1)
    thickness = 2 * 2e-4
    assert height[distance < found].max() < 2 * thickness
    assert height[(distance < found) & (distance > found - 0.03)].max() < 1.2 * thickness
    assert height[distance > found + 0.04].max() > 10 * thickness
    after = height[(distance > found + 0.03) & (distance < 0.4)]
    assert (np.diff(after) > 0).all()
    assert after[0] > 4 * thickness
