"""Laying out: nothing turns over, all is about equally large, and the energy's gradient is its slope."""

from __future__ import annotations

import numpy as np
import pytest

import torsade as ts
from torsade.knots.packing import packing_centres, triangulated
from torsade.topology import named_diagram
from torsade.topology.diagram import Diagram
from torsade.topology.tangle import union
from torsade.view.layout import _doubled_areas, _energy, _evened, laid_out


def net_of(diagram):
    return triangulated(diagram, [p for edge in diagram.edges for p in edge])


def test_the_circles_of_a_packing_joined_by_their_centres_touch():
    """The sides of a triangle are sums of two radii: (ab + ac - bc)/2 is one radius in all triangles at a."""
    net = net_of(named_diagram("4_1"))
    z = packing_centres(net)
    a, b, c = z[net.triangles].T
    assert _doubled_areas(z, net).min() > 0
    radius = (abs(a - b) + abs(a - c) - abs(b - c)) / 2
    for v in range(len(z)):
        seen = radius[net.triangles[:, 0] == v]
        if len(seen) > 1:
            np.testing.assert_allclose(seen, seen[0], rtol=1e-6)


def test_energy_of_the_unit_triangle_is_four_and_least():
    from torsade.knots.packing import Triangulation

    one = Triangulation({}, np.array([[0, 1, 2]]), np.ones(3, dtype=bool))
    unit = np.array([0, 1, 0.5 + np.sqrt(0.75) * 1j])
    energy, slope = _energy(unit, one)
    assert energy == pytest.approx(4.0)
    assert abs(slope).max() < 1e-14
    # Scaled by s it is 2 s² + 2/s²; turned over it is infinite.
    assert _energy(3 * unit, one)[0] == pytest.approx(18 + 2 / 9)
    assert _energy(unit.conj(), one)[0] == np.inf


def test_slope_is_that_of_the_energy():
    net = net_of(named_diagram("5_2"))
    z = packing_centres(net) * 20
    _, slope = _energy(z, net)
    rng = np.random.default_rng(1)
    way = rng.normal(size=len(z)) + 1j * rng.normal(size=len(z))
    step = 1e-7
    rise = (_energy(z + step * way, net)[0] - _energy(z - step * way, net)[0]) / (2 * step)
    assert rise == pytest.approx(float((slope.conj() @ way).real), rel=1e-5)


@pytest.mark.parametrize("name", ["reef", "zeppelin13", "double_fisherman"])
def test_triangles_become_about_equally_large(name):
    net = net_of(ts.knots.find(name).diagram)
    before, after = (_doubled_areas(z, net) for z in (packing_centres(net), _evened(net)))
    assert before.max() / before.min() > 1e3
    assert after.min() > 0
    assert after.max() / after.min() < 60


def test_pulled_ends_lie_left_and_right():
    entry = ts.knots.find("thief")
    drawn = entry.diagram.pulled(entry.pulled)
    ends = dict(zip(drawn.ends, laid_out(drawn).ends, strict=True))
    across = ends["B0"] - ends["A1"]
    assert across.real > 0
    assert abs(across.imag) < 1e-9 * across.real


def test_pieces_stand_side_by_side():
    layout = laid_out(union(union(named_diagram("3_1"), named_diagram("4_1")), Diagram.circle()))
    first, second = layout.ports[:12].real, layout.ports[12:].real
    assert first.max() < second.min() < second.max() < layout.circles[0].real - 1
