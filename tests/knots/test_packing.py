"""Circle packings: tangent circles, and drawings that are the diagram."""

from __future__ import annotations

import numpy as np
import pytest

from torsade.knots.bends import bends
from torsade.knots.packing import _Touching, packed, packing_radii, triangulated
from torsade.knots.sutures import suture_diagram
from torsade.topology import canonical_form, from_text, named_diagram, project
from torsade.topology.diagram import Diagram
from torsade.topology.table import contents

SMALL = [name for name in contents()["knots"] if name != "0_1" and int(name.split("_")[0]) <= 7]
WITH_KINKS = ["{1,2,3,-4}", "{1,1,1,2}", "{1,2,-1,3,3,-2,-4}"]


def all_darts(diagram: Diagram) -> list[int]:
    return [p for two in diagram.edges for p in two]


def distance(z: complex, w: complex) -> float:
    """In the hyperbolic disc of curvature -1."""
    return float(2 * np.arctanh(abs((z - w) / (1 - np.conj(z) * w))))


@pytest.mark.parametrize("diagram", [named_diagram("3_1"), named_diagram("8_18"), bends()["carrick"].diagram])
def test_neighbours_touch(diagram: Diagram) -> None:
    """Around every circle, however it was reached, neighbours lie at the sum of the radii."""
    net = triangulated(diagram, all_darts(diagram))
    Y = packing_radii(net)
    where = _Touching(net, Y).centre
    r = 2 * np.arctanh(np.where(net.boundary, 0.0, Y))
    inner = [two for t in net.triangles.tolist() for two in (t[:2], t[1:]) if not net.boundary[two].any()]
    assert len(inner) > 50
    apart = [distance(where[v], where[w]) for v, w in inner]
    np.testing.assert_allclose(apart, [r[v] + r[w] for v, w in inner], rtol=1e-6)
    assert len(where) == np.count_nonzero(~net.boundary)


def read(diagram: Diagram) -> Diagram:
    """The diagram of the drawing, through the projection."""
    drawing = packed(diagram, range(diagram.n_strands))
    x = [
        np.column_stack([z.real, z.imag, height])
        for z, height in zip(drawing.points, drawing.heights, strict=True)
    ]
    return project(x, [not diagram.is_open(k) for k in range(diagram.n_strands)]).diagram


@pytest.mark.parametrize("name", [*SMALL, "L2a1", "L5a1", "L6a4", "L8n1", "3_1#m4_1"])
def test_the_drawing_is_the_diagram(name: str) -> None:
    diagram = named_diagram(name)
    assert canonical_form(read(diagram), plane=True) == canonical_form(diagram, plane=True) or (
        not diagram.outer and canonical_form(read(diagram)) == canonical_form(diagram)
    )


@pytest.mark.parametrize("code", WITH_KINKS)
def test_loops_of_one_crossing_are_drawn(code: str) -> None:
    diagram = from_text(code)
    assert canonical_form(read(diagram)) == canonical_form(diagram)


@pytest.mark.parametrize("diagram", [*(b.diagram for b in bends().values()), suture_diagram(7, -5)])
def test_tangles_are_drawn(diagram: Diagram) -> None:
    assert canonical_form(read(diagram)) == canonical_form(diagram)


def test_the_face_named_is_outside() -> None:
    """Each face of the figure-eight knot in turn."""
    diagram = named_diagram("4_1")
    for face in diagram.faces:
        named = Diagram(diagram.mate, diagram.ends, diagram.starts, (face[0],))
        assert canonical_form(read(named), plane=True) == canonical_form(named, plane=True)


def test_a_mirror_image_is_drawn_alike() -> None:
    diagram = named_diagram("9_42")
    one, other = (packed(d, [0]) for d in (diagram, diagram.mirror()))
    np.testing.assert_array_equal(one.points[0], other.points[0])
    np.testing.assert_array_equal(one.heights[0], -other.heights[0])
