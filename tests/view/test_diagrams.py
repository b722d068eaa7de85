"""A drawn diagram is read again: its curves cross where and as the diagram says."""

from __future__ import annotations

import numpy as np
import pytest

import torsade as ts
from torsade.topology import is_isomorphic, named_diagram, project
from torsade.topology.diagram import Diagram
from torsade.view._extra import require
from torsade.view.diagrams import _pole, _runs, draw_diagram
from torsade.view.layout import laid_out

NAMES = ["reef", "grief", "bowline13", "hunter23", "alpine13", "ashley14", "fisherman", "overhand"]


def axes_of():
    return require("matplotlib.figure").Figure(figsize=(3, 3)).subplots()


def pulled(name):
    entry = ts.knots.find(name)
    return entry.diagram.pulled(entry.pulled) if entry.kind == "bend" else entry.diagram


def read(diagram):
    """The diagram of the curves as drawn, lifted where a crossing says that they are above."""
    curves, closed = [], []
    for run in _runs(diagram, laid_out(diagram)):
        z = np.zeros(len(run.curve))
        for _, head, _, last in run.edges:
            if head >= 0:
                near = np.abs(np.arange(len(z)) - last)
                near = np.minimum(near, len(z) - 1 - near) if run.closed else near
                z += (1 if head & 1 else -1) * np.clip(1 - near / 20, 0, None)
        x = np.stack([run.curve.real, run.curve.imag, z], axis=1)
        curves.append(x[:-1] if run.closed else x)
        closed.append(run.closed)
    return project(curves, closed).diagram


@pytest.mark.parametrize("name", NAMES)
def test_a_drawn_tangle_reads_as_it_is(name):
    diagram = pulled(name)
    seen = read(diagram)
    assert seen.n_crossings == diagram.n_crossings
    assert sorted(seen.signs) == sorted(diagram.signs)
    assert is_isomorphic(seen.renamed(list("wxyz")[: len(seen.ends)]), diagram.renamed(named(seen, diagram)))


def named(seen, diagram):
    """Names for the ends of a diagram as those of what is seen: strands keep their numbers and directions."""
    letters = dict(zip((end for end in seen.ends), "wxyz", strict=False))
    tips = {}
    for k in range(diagram.n_strands):
        mine = [e for e, owner in zip(diagram.edges, diagram.edge_strand, strict=True) if owner == k]
        for end, port in enumerate((mine[0][0], mine[-1][1])):
            tips[port] = letters[f"{'AB'[k]}{end}"]
    return [tips[p] for p in range(-len(diagram.ends), 0)]


@pytest.mark.parametrize("name", ["3_1", "4_1", "7_4", "Hopf", "Whitehead"])
def test_a_drawn_knot_reads_as_it_is(name):
    diagram = named_diagram(name)
    assert is_isomorphic(read(diagram), diagram)


@pytest.mark.parametrize("name", ["reef", "hunter13", "granny"])
def test_what_is_written_is_what_is_counted(name):
    diagram = pulled(name)
    axes = axes_of()
    draw_diagram(axes, diagram, charges=True)
    words = [text.get_text() for text in axes.texts]
    assert words.count("+") - words.count("−") == diagram.writhe
    assert len(words) == diagram.n_crossings
    axes = axes_of()
    draw_diagram(axes, diagram, circulation=True)
    shares = [tuple(map(int, text.get_text().split("/"))) for text in axes.texts]
    assert sum(c / e for c, e in shares) == pytest.approx(ts.topology.state(diagram).gamma)
    axes = axes_of()
    draw_diagram(axes, diagram, smoothed=True, labels=True)
    words = [text.get_text() for text in axes.texts]
    assert words.count("+") - words.count("−") == ts.topology.state(diagram).whitney
    assert set(diagram.ends) <= set(words)


def test_every_crossing_has_one_gap():
    """A strand that passes under k times falls into k + 1 pieces."""
    diagram = pulled("reef")
    axes = axes_of()
    draw_diagram(axes, diagram)
    pieces = [line for line in axes.lines if len(line.get_xdata()) > 1]
    assert len(pieces) == diagram.n_crossings + diagram.n_strands


def test_circles_that_cross_nothing_are_drawn():
    axes = axes_of()
    draw_diagram(axes, Diagram.circle())
    assert len(axes.patches) == 1
    draw_diagram(axes, Diagram.circle(), smoothed=True)
    assert axes.texts[0].get_text() == "+"


def test_the_sense_of_a_ring_around_another_stands_between_them():
    turn = np.exp(2j * np.pi * np.arange(96) / 96)
    assert abs(_pole(turn, [])) < 0.1
    assert 0.5 < abs(_pole(turn, [0.5 * turn])) < 1
