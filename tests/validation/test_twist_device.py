"""The twist device of thesis 3.4: a rod that is bent and twisted between pivots."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from motion.still import PIVOT, curvature, nodes
from torsade.material import preset
from torsade.motion.equilibrium import Bent, bent
from torsade.motion.spectrum import lowest
from torsade.motion.supports import Fiber, chain, controls_at
from torsade.motion.trust import minimise

ROD = np.array(
    [
        (17.595, 0, 14.28572, 0.0, 1.15717, 0.0),
        (17.595, 90, 14.38332, 0.0845, 1.15309, 1.3819),
        (17.595, 180, 14.70785, 0.1809, 1.13963, 2.8809),
        (17.595, 250, 15.19073, 0.2758, 1.1198, 4.2371),
        (17.595, 300, 15.73641, 0.3639, 1.09749, 5.3971),
        (17.595, 360, 16.78441, 0.5124, 1.05428, 7.179),
        (19, 0, 12.46022, 0.0, 1.11807, 0.0),
        (19, 90, 12.54246, 0.0714, 1.11445, 1.1865),
        (19, 180, 12.81478, 0.1525, 1.1026, 2.4692),
        (19, 250, 13.21643, 0.2317, 1.08533, 3.6217),
        (19, 300, 13.66451, 0.3044, 1.0662, 4.5969),
        (19, 360, 14.50412, 0.4239, 1.03026, 6.0646),
        (20.5, 0, 10.28844, 0.0, 1.07946, 0.0),
        (20.5, 90, 10.35405, 0.0571, 1.07626, 0.9647),
        (20.5, 180, 10.57047, 0.1218, 1.06583, 2.0046),
        (20.5, 250, 10.88716, 0.1844, 1.05078, 2.933),
        (20.5, 300, 11.2365, 0.2413, 1.03434, 3.7112),
        (20.5, 360, 11.87805, 0.3331, 1.00424, 4.8631),
        (21.272, 0, 9.02374, 0.0, 1.06073, 0.0),
        (21.272, 90, 9.08033, 0.0493, 1.05772, 0.8399),
        (21.272, 180, 9.26665, 0.1051, 1.04793, 1.744),
        (21.272, 250, 9.53832, 0.1589, 1.03386, 2.5488),
        (21.272, 300, 9.8365, 0.2075, 1.01859, 3.2207),
        (21.272, 360, 10.37942, 0.2854, 0.99093, 4.2081),
        (22.842, 0, 5.80372, 0.0, 1.0248, 0.0),
        (22.842, 90, 5.83896, 0.0308, 1.02213, 0.5327),
        (22.842, 180, 5.95458, 0.0655, 1.01347, 1.1046),
        (22.842, 250, 6.12207, 0.0988, 1.00112, 1.611),
        (22.842, 300, 6.3043, 0.1286, 0.98787, 2.0307),
        (22.842, 360, 6.63123, 0.1757, 0.96433, 2.64),
    ]
)
"""End distance [cm] and total twist [deg] of a rod of 24 cm with C/B = 1/1.3; largest curvature [1/m],
largest distance from the plane [cm], thrust over the Euler load, curvature at the ends [1/m]: a
boundary-value solution of the Kirchhoff equations."""


def rod(edges: int = 200, L: float = 0.24) -> Fiber:
    """Spaghetti (thesis 3.2), 1.4 mm thick."""
    spaghetti = preset("spaghetti")
    material, section = spaghetti.material, spaghetti.section
    return Fiber(L, edges, material.E_b * section.I, material.mu * section.J)


def measured(b: Bent) -> tuple[float, float, float, float]:
    """What the columns of the table hold."""
    euler = np.pi**2 * b.fiber.B / b.fiber.length**2
    return b.kappa_max, 1e2 * b.out_of_plane, b.thrust / euler, float(b.kappa[0])


def test_bent_and_twisted_rods() -> None:
    """Curvature and thrust to 1e-4, way out of the plane to 2e-4 cm, end curvature to 2e-3 1/m."""
    for d, twist, *exact in ROD:
        kappa, out, thrust, end = measured(bent(rod(), d / 100, np.radians(twist)))
        assert kappa == pytest.approx(exact[0], rel=1e-4)
        assert out == pytest.approx(exact[1], abs=2e-4)
        assert thrust == pytest.approx(exact[2], rel=1e-4)
        assert end == pytest.approx(exact[3], abs=2e-3)


@pytest.mark.parametrize("sense", [1, -1])
def test_mirrored_twist_mirrors_the_shape(sense: int) -> None:
    """Twist of either hand: z and the couple of the grips change sign, nothing else; the middle is an axis.

    A half turn about the y axis through the middle maps the rod on itself.
    """
    b = bent(rod(), 0.19, sense * np.radians(270))
    ours = measured(b)
    assert ours[0] == pytest.approx(13.37549, rel=1e-4)
    turned = b.x[::-1] * [-1, 1, -1] + [0.19, 0, 0]
    assert b.x == pytest.approx(turned, abs=1e-9)
    assert np.sign(b.x[50, 2]) == -sense
    assert b.rotation / sense > np.radians(270)


def test_moments_balance() -> None:
    """Kirchhoff: M' + t x F = 0 with M = B t x t' + M_t t all along; pivots feel no moment about z."""
    f = Fiber(1.0, 800, 1.0, 1 / 1.3)
    b = bent(f, 0.75, 4.0)
    t = np.diff(b.x, axis=0) * f.edges
    a, c = t[:-1], t[1:]
    kb = 2 * np.cross(a, c) / (1 + np.einsum("ij,ij->i", a, c))[:, None]
    middle = (a + c) / np.linalg.norm(a + c, axis=1)[:, None]
    moment = kb * f.edges + b.torque * middle
    balance = moment + np.cross(b.x[1:-1], b.force)
    spread = np.abs(balance - balance.mean(axis=0)).max()
    assert spread < 1e-4 * np.abs(moment).max()
    assert abs(moment[0, 2]) < 0.01 * np.abs(moment[:, 2]).max()  # an edge away from the pivot
    assert b.torque == pytest.approx(4.0 / 1.3, rel=1e-9)


def critical(M: float, P: float) -> float:
    """Determinant that vanishes where a straight rod between pivots buckles under torque M and thrust P.

    w = y + i z obeys w''' - i M w'' + P w' = const: w = c_0 + c_1 s + c_2 exp(i k_1 s) + c_3 exp(i k_2 s),
    with k^2 - M k - P = 0. At both ends y = z = z' = y'' = 0 (no moment about z, to first order).
    """
    root = np.sqrt(M * M / 4 + P)
    columns = []
    for k in (None, 0.0, M / 2 + root, M / 2 - root):
        for c in (1, 1j):
            column = []
            for s in (0.0, 1.0):
                if not k:
                    w, w1, w2 = (c, 0, 0) if k is None else (c * s, c, 0)
                else:
                    w = c * np.exp(1j * k * s)
                    w1, w2 = 1j * k * w, -k * k * w
                column += [np.real(w), np.imag(w), np.imag(w1), np.real(w2)]
            columns.append(column)
    return float(np.linalg.det(np.array(columns, dtype=float)))


@pytest.mark.parametrize("degrees", [0.0, 120.0, 240.0, 340.0])
def test_thrust_of_nearly_straight_rods(degrees: float) -> None:
    """As the ends part the thrust tends to the load at which the twisted straight rod buckles, to 1e-4."""
    M = np.radians(degrees) / 1.3
    loads = np.linspace(6.0, 10.2, 200)
    values = [critical(M + 1e-9, P) for P in loads]
    at = next(k for k in range(len(loads)) if values[k] * values[k + 1] <= 0)
    exact = brentq(lambda P: critical(M + 1e-9, P), loads[at], loads[at + 1])
    found = bent(Fiber(1.0, 400, 1.0, 1 / 1.3), 1 - 1e-5, np.radians(degrees))
    assert found.thrust == pytest.approx(exact, rel=1e-4)


def test_an_unstable_arch_falls_into_the_helix() -> None:
    """Disturbed with its grips held, the arch of 360 deg ends in a stable shape of less energy and twist.

    The way of buckling that is softer, grown large: bent most at its ends, and swung out to one side of the
    plane, by the sign of the disturbance.
    """
    fiber = Fiber(1.0, 100, 1.0, 1 / 1.3)
    b = bent(fiber, 19 / 24, np.radians(360))
    assert not b.stable
    c = chain(fiber, (PIVOT, PIVOT), rotation_held=True)
    held = controls_at(c, (19 / 24, 0.0, 0.0), rotation=b.rotation)
    values, modes = lowest(c, c.system(b.shape, held), 2)
    assert values[0] < 0 < values[1]
    for side in (1.0, -1.0):
        fallen = minimise(c, c.moved(b.shape, side * 1e-3 * modes[0]), held)
        assert c.potential(fallen, held) < c.potential(b.shape, held) - 0.3
        assert lowest(c, c.system(fallen, held))[0][0] > 0
        assert c.total_twist(fallen) < np.radians(300)
        assert set(curvature(c, fallen).argsort()[-2:]) == {0, 100}
        z = nodes(c, fallen)[:, 2]
        assert np.abs(z).max() == pytest.approx(abs(z[50]), rel=1e-6)
        assert min(abs(z.min()), abs(z.max())) < 1e-6


def test_where_the_arch_loses_its_symmetry() -> None:
    """Beyond 357 deg another way of buckling is softer, P = 4 pi^2 - 2 pi M for a nearly straight rod.

    That is w = 1 - exp(2 pi i s), which pivots allow in any phase. It meets the arch at the twist where both
    need the same thrust; from there on the arch is no minimum, though it still is an equilibrium.
    """

    def gap(twist: float) -> float:
        M = twist / 1.3
        helix = 4 * np.pi**2 - 2 * np.pi * M
        return bent(Fiber(1.0, 400, 1.0, 1 / 1.3), 1 - 1e-5, twist).thrust - helix

    meet = brentq(gap, np.radians(340), np.radians(359), xtol=1e-6)
    for twist, stable in ((meet - 0.02, True), (meet + 0.02, False)):
        assert bent(Fiber(1.0, 400, 1.0, 1 / 1.3), 1 - 1e-5, twist).stable is stable
    assert np.degrees(meet) == pytest.approx(357.3, abs=0.1)
