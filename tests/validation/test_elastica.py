"""Planar elastica: exact solutions in elliptic integrals, computed elsewhere to ten digits."""

from __future__ import annotations

import numpy as np
import pytest

from motion.still import CLAMP, NOWHERE, arch, curvature, nodes, order, straight
from torsade.motion.equilibrium import Bent, bent
from torsade.motion.supports import Fiber, Support, chain, controls_at
from torsade.motion.trust import minimise

HINGED = np.array(
    [
        (0.99, 11.4711226049, 1.00502829004, 0.629501437345, 0.0634627217646, 0.0989437134637),
        (0.94, 28.2472100316, 1.03104924172, 1.55680895127, 0.152987577377, 0.601264167351),
        (0.89, 38.4536515932, 1.05863669457, 2.12890671562, 0.203755782694, 1.11680611012),
        (0.84, 46.6328352195, 1.0879422835, 2.59398874601, 0.241580839431, 1.64637921532),
        (0.79, 53.7258648856, 1.11913815863, 3.00347052626, 0.271919232142, 2.19087291294),
        (0.74, 60.1251147881, 1.15242058919, 3.37890235336, 0.297074166382, 2.75126737384),
        (0.69, 66.0391377347, 1.18801435305, 3.73188110261, 0.31827781336, 3.32864645892),
        (0.64, 71.5947730699, 1.22617811792, 4.06961780301, 0.336279441581, 3.9242130696),
        (0.59, 76.8762545424, 1.26721108369, 4.39707289197, 0.351572548338, 4.53930745228),
        (0.54, 81.9431574869, 1.31146124192, 4.71794167824, 0.364499857042, 5.1754291629),
        (0.49, 86.8396884522, 1.35933572628, 5.03517181293, 0.375307996446, 5.83426360086),
        (0.44, 91.5999276262, 1.41131389158, 5.3512644822, 0.384178498175, 6.51771429368),
        (0.39, 96.2509847777, 1.46796398719, 5.66846699147, 0.391246508786, 7.22794248122),
        (0.34, 100.814993747, 1.52996461452, 5.98890842753, 0.396612630675, 7.96741605134),
        (0.29, 105.310417026, 1.59813262019, 6.31470595657, 0.400350680407, 8.73897057235),
        (0.24, 109.75291453, 1.67345974726, 6.6480582519, 0.402512897073, 9.54588613847),
        (0.19, 114.155917623, 1.75716134905, 6.99133748259, 0.403133491048, 10.3919851166),
        (0.14, 118.530985592, 1.85074193086, 7.34718937522, 0.402231079077, 11.2817578504),
        (0.09, 122.88798135, 1.95608448411, 7.71865092665, 0.399810363183, 12.2205262334),
        (0.04, 127.235073344, 2.07557393368, 8.10929702943, 0.395863312888, 13.2146592704),
        (0.0, 130.709910708, 2.18337904619, 8.43848785757, 0.391593745196, 14.0549512177),
    ]
)
"""End distance, angle of the ends [deg], thrust over the Euler load, largest curvature, rise and bending
energy of a hinged elastica, in units of L and B: k = sin(angle/2), P L^2/B = 4 K(k)^2,
d = 2 E(k)/K(k) - 1."""

LOADED = np.array(
    [
        (0.1, 2.86216802346, 0.0332953192682, 0.000665399963048, 0.0999334600037),
        (0.25, 7.12143235849, 0.0827459153544, 0.00411781840998, 0.248970545398),
        (0.5, 14.0107459297, 0.162143575658, 0.0159189624708, 0.492040518765),
        (0.75, 20.4847404302, 0.235615231379, 0.0339663150303, 0.724525263727),
        (1.0, 26.4335195886, 0.3017207738, 0.0564332362834, 0.943566763717),
        (1.5, 36.642932869, 0.410978211248, 0.107941500684, 1.33808774897),
        (2.0, 44.7909659833, 0.493457480397, 0.160641720825, 1.67871655835),
        (3.0, 56.4946095749, 0.60325344113, 0.254420184564, 2.23673944631),
        (4.0, 64.242282435, 0.669964181278, 0.328941242247, 2.68423503101),
        (5.0, 69.6354636939, 0.713791523612, 0.387628360724, 3.06185819638),
        (6.0, 73.5504366488, 0.74457114889, 0.434588828682, 3.39246702791),
        (7.0, 76.4875656525, 0.76736909974, 0.472927428386, 3.6895080013),
        (8.0, 78.7491245638, 0.784982374953, 0.504827732134, 3.96137814293),
        (9.0, 80.5272318686, 0.799055527471, 0.531820562673, 4.21361493595),
        (10.0, 81.9493248721, 0.81060902488, 0.554995597754, 4.45004402246),
        (20.0, 87.8307032639, 0.868695898285, 0.683885567566, 6.32228864867),
        (50.0, 89.8387453129, 0.917155447304, 0.80000039605, 9.99998019752),
    ]
)
"""Load P L^2/B across the tip of a cantilever, angle [deg] and deflection of the tip, its way along the axis
and the curvature at the root, in units of L."""


def solved(edges: int) -> list[Bent]:
    return [bent(Fiber(edges=edges), d) for d in HINGED[:, 0]]


def off(found: list[Bent]) -> np.ndarray:
    """Relative errors (n_rows, 4) of thrust, largest curvature, rise and energy."""
    ours = [(b.thrust / np.pi**2, b.kappa_max, b.x[:, 1].max(), b.energy_bend) for b in found]
    return np.array(ours) / HINGED[:, 2:] - 1


def test_hinged_elastica_at_400_nodes() -> None:
    """Curvature, thrust, rise and energy to 1e-4 from d/L = 0.99 to 0, and the angle of the ends."""
    found = solved(399)
    errors = np.abs(off(found))
    assert errors.max() < 1e-4
    assert errors[:, :2].max() < 1.1e-5
    for b, row in zip(found, HINGED, strict=True):
        slope = np.degrees(np.arctan2(b.shape.edge[0, 1], b.shape.edge[0, 0]))
        assert slope == pytest.approx(row[1], rel=1e-4)
        assert b.stable
        assert b.out_of_plane < 1e-9


def test_hinged_elastica_converges_with_the_square_of_the_edges() -> None:
    """Order by regression over 50 to 400 edges, of the largest error in every column."""
    sizes = [50, 100, 200, 400]
    worst = np.array([np.abs(off(solved(n))).max(axis=0) for n in sizes])
    for column in range(4):
        assert order(sizes, worst[:, column]) == pytest.approx(2.0, abs=0.1)


def test_thrust_is_the_slope_of_the_energy() -> None:
    """dE/dd = -P: the reaction of the discrete fiber to 1e-6, the thrust from its moments to 1e-3."""
    f = Fiber(edges=200)
    for d in (0.9, 0.5, 0.1):
        up, down = bent(f, d + 1e-4), bent(f, d - 1e-4)
        slope = (up.energy_bend - down.energy_bend) / 2e-4
        here = bent(f, d)
        assert slope == pytest.approx(here.shape.reaction[0], rel=1e-6)
        assert -slope == pytest.approx(here.thrust, rel=1e-3)


def cantilever(edges: int) -> np.ndarray:
    """Relative errors (n_rows, 4) under the loads of the table."""
    c = chain(Fiber(edges=edges), (CLAMP, Support("free", NOWHERE)))
    shape = straight(c)
    out = []
    for load, *_ in LOADED:
        shape = minimise(c, shape, controls_at(c, force=(0.0, load, 0.0)))
        tip, last = nodes(c, shape)[-1], shape.edge[-1]
        angle = np.degrees(np.arctan2(last[1], last[0]))  # moment and curvature vanish at the tip
        out.append((angle, tip[1], 1 - tip[0], curvature(c, shape)[0]))
    return np.array(out) / LOADED[:, 1:] - 1


def test_cantilever_with_a_load_across_its_tip() -> None:
    """To 1e-5 with 400 edges from P L^2/B = 0.1 to 50, and second order."""
    sizes = [100, 200, 400]
    errors = np.array([cantilever(n) for n in sizes])
    assert np.abs(errors[-1]).max() < 1e-5
    worst = np.abs(errors).max(axis=(1, 2))
    assert order(sizes, worst) == pytest.approx(2.0, abs=0.1)


def test_a_cantilever_under_its_own_weight() -> None:
    """Small sag w L^4/8B of a load spread over the nodes, to 1e-3."""
    n, w = 100, 0.01
    c = chain(Fiber(edges=n), (CLAMP, Support("free", NOWHERE)))
    beyond = w * (1 - (np.arange(n) + 0.5) / n)
    load = np.zeros((n + 1, 3))
    load[1:, 1] = -beyond
    controls = controls_at(c)._replace(load=load)
    assert nodes(c, minimise(c, straight(c), controls))[-1, 1] == pytest.approx(-w / 8, rel=1e-3)


def test_a_planar_start_is_not_needed() -> None:
    """The arch is the least energy also in space: from a slanted start the same curvature."""
    c = chain(Fiber(edges=100), (Support("plane"), Support("plane")))
    shape = arch(c, 1.4)
    tilt = np.array([[1, 0, 0], [0, np.cos(0.5), -np.sin(0.5)], [0, np.sin(0.5), np.cos(0.5)]])
    edge = shape.edge @ tilt.T
    edge[[0, -1]] = shape.edge[[0, -1]]
    found = minimise(c, shape._replace(edge=edge), controls_at(c, (0.49, 0.0, 0.0)))
    assert curvature(c, found).max() == pytest.approx(5.03517181293, rel=1e-4)
