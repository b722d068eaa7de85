"""Diagrams drawn flat: strands with gaps where they pass under, arrows, charges, Seifert circles.

>>> from torsade.topology.codes import from_braid
>>> from torsade.view.diagrams import draw_diagram
>>> from torsade.view._extra import require
>>> axes = require("matplotlib.figure").Figure().subplots()
>>> draw_diagram(axes, from_braid([1, 1, 1]), charges=True)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsade.topology.diagram import Diagram
from torsade.topology.seifert import turning
from torsade.view._extra import require
from torsade.view.colours import STRAND_COLOURS
from torsade.view.layout import Layout, laid_out

__all__ = ["NEGATIVE", "POSITIVE", "STRANDS", "draw_crossing", "draw_diagram"]

Complexes = NDArray[np.complex128]

STRANDS = STRAND_COLOURS
"""Colours of strands A, B, ..., as in pictures."""

POSITIVE, NEGATIVE = "#b3312c", "#3b4da0"
"""Colours of right-handed crossings and counterclockwise loops, and of the others."""

GREY = "#8d949b"
INK = "#262a2e"
FACE = "#f3b562"
_GAP = 0.32  # of a strand, on either side of the one above it [sides of a triangle]
_CORNER = 0.34  # how far from a crossing a smoothed strand turns
_BADGE = 0.62  # how far from a crossing its charge stands
_FINE = 24  # points between two of a curve
_HEAD = np.array([1.0, -0.8 + 0.62j, -0.5, -0.8 - 0.62j, 1.0])  # of an arrow to the right


def draw_diagram(
    axes: Any,
    diagram: Diagram,
    *,
    charges: bool = False,
    circulation: bool = False,
    smoothed: bool = False,
    colours: Sequence[str] = STRANDS,
    labels: bool = False,
    width: float = 2.4,
    size: float = 7.0,
) -> None:
    """Draw a diagram on matplotlib axes, which lose their frame.

    Strands run as those of the diagram do: turn them towards pulled ends with `Diagram.pulled`. Open strands
    end in arrows, and each edge between crossings carries a small one.

    Parameters
    ----------
    charges : write the sign of every crossing beside it, between the two edges that leave
    circulation : shade bounded faces by |C|/e, their circulation over their edges, and write it
    smoothed : draw what is left when crossings are smoothed: Seifert circles in the colour of their sense,
        their signs at their middle, and arcs from end to end in grey
    colours : of strands A, B, ..., repeated if there are more strands
    labels : write the names of the ends
    width : of strands [points]
    size : of writing [points]
    """
    layout = laid_out(diagram)
    axes.set(aspect="equal")
    axes.axis("off")
    if circulation:
        _faces(axes, diagram, layout, size)
    if smoothed:
        _smoothed(axes, diagram, layout, width, size)
    else:
        _strands(axes, diagram, layout, colours, width)
    if charges:
        for place, sign in zip(_forward(diagram, layout, _BADGE), diagram.signs, strict=True):
            _badge(axes, place, sign, size)
    if labels:
        for name, end, p in zip(diagram.ends, layout.ends, range(-len(diagram.ends), 0), strict=True):
            out = end - layout.ports[p]
            place = end + 0.9 * out / abs(out)
            axes.text(place.real, place.imag, name, ha="center", va="center", fontsize=size, color=INK)
    axes.autoscale_view()
    axes.margins(0.06)


def _curve(points: Complexes, closed: bool) -> Complexes:
    """A smooth curve through points, `_FINE` steps from each to the next."""
    from scipy.interpolate import CubicSpline

    if closed:
        points = np.append(points, points[0])
    along = np.concatenate([[0.0], np.cumsum(np.sqrt(abs(np.diff(points))))])
    spline = CubicSpline(along, points, bc_type="periodic" if closed else "natural")
    steps = np.linspace(0.0, 1.0, _FINE, endpoint=False)
    fine = (along[:-1, None] + np.diff(along)[:, None] * steps).ravel()
    return np.asarray(spline(np.append(fine, along[-1])))


@dataclass(frozen=True)
class _Run:
    """A strand on paper: its curve, and which of its points are at the tails and heads of its edges.

    `edges` holds (tail, head, first point, last point).
    """

    curve: Complexes
    closed: bool
    edges: tuple[tuple[int, int, int, int], ...]


def _runs(diagram: Diagram, layout: Layout) -> list[_Run | None]:
    """Each strand as a curve; None for a circle without crossings."""
    found: list[_Run | None] = []
    for k, passages in enumerate(diagram.strands):
        closed = not diagram.is_open(k)
        if closed and not passages:
            found.append(None)
            continue
        edges: list[tuple[int, int, int, int]] = []
        points: list[complex] = []
        for edge, owner in zip(diagram.edges, diagram.edge_strand, strict=True):
            if owner == k:
                tail, head = edge
                points.append(layout.crossings[tail >> 2] if tail >= 0 else layout.ends[tail])
                points += [layout.ports[tail], layout.ports[head]]
                edges.append((*edge, (len(points) - 3) * _FINE, len(points) * _FINE))
        if not closed:
            points.append(layout.ends[edges[-1][1]])
        found.append(_Run(_curve(np.array(points), closed), closed, tuple(edges)))
    return found


def _strands(axes: Any, diagram: Diagram, layout: Layout, colours: Sequence[str], width: float) -> None:
    """Strands one after the other, each cut where it passes under."""
    circles = iter(layout.circles)
    for k, run in enumerate(_runs(diagram, layout)):
        colour = colours[k % len(colours)]
        if run is None:
            _ring(axes, next(circles), colour, width)
            continue
        _cut(
            axes,
            run.curve,
            [last for _, head, _, last in run.edges if head >= 0 and not head & 1],
            colour,
            width,
        )
        for tail, head, first, last in run.edges:
            if head < 0:
                _arrow(axes, run.curve, len(run.curve) - 1, colour, 4.2 * width)
            elif tail >= 0:
                _arrow(axes, run.curve, (first + last) // 2, colour, 3.6 * width)


def _cut(axes: Any, curve: Complexes, at: Sequence[int], colour: str, width: float) -> None:
    """A curve with gaps around some of its points; a gap at its seam shows at both of its tips."""
    shown = np.ones(len(curve), dtype=bool)
    for i in at:
        near = abs(curve - curve[i]) < _GAP
        beside = np.zeros_like(near)
        beside[max(i - _FINE, 0) : i + _FINE] = True
        if i + _FINE > len(curve):
            beside[: i + _FINE - len(curve)] = True
        shown &= ~(near & beside)
    runs = np.split(np.arange(len(curve)), np.flatnonzero(np.diff(shown.astype(int))) + 1)
    for run in runs:
        if shown[run[0]]:
            piece = curve[run]
            axes.plot(piece.real, piece.imag, color=colour, lw=width, solid_capstyle="butt", zorder=2)


def _arrow(axes: Any, curve: Complexes, i: int, colour: str, scale: float) -> None:
    """A head on a curve, about its point i."""
    along = curve[min(i + 2, len(curve) - 1)] - curve[max(i - 2, 0)]
    head = _HEAD * along / abs(along)
    shape = np.stack([head.real, head.imag], axis=1)
    axes.plot(curve[i].real, curve[i].imag, marker=shape, ms=scale, mfc=colour, mec="none", zorder=4)


def _ring(axes: Any, centre: complex, colour: str, width: float) -> None:
    axes.add_patch(
        require("matplotlib.patches").Circle((centre.real, centre.imag), 1.0, fill=False, ec=colour, lw=width)
    )


def _forward(diagram: Diagram, layout: Layout, far: float) -> Complexes:
    """For each crossing a point between the two edges that leave it."""
    places = np.array(layout.crossings)
    for passages in diagram.strands:
        for p in passages:
            out = layout.ports[p ^ 2] - layout.crossings[p >> 2]
            places[p >> 2] += far * out / abs(out) / np.sqrt(2)
    return places


def _badge(axes: Any, place: complex, sign: int, size: float) -> None:
    axes.text(
        place.real, place.imag, "+" if sign > 0 else "−", ha="center", va="center_baseline", fontsize=size,
        color="white", zorder=6,
        bbox={"boxstyle": "circle,pad=0.12", "fc": POSITIVE if sign > 0 else NEGATIVE, "ec": "none"},
    )  # fmt: skip


def _faces(axes: Any, diagram: Diagram, layout: Layout, size: float) -> None:
    """Bounded faces, the darker the more their edges run around them one way; |C|/e in their middle."""
    along: dict[int, Complexes] = {}
    for run in (run for run in _runs(diagram, layout) if run is not None):
        for tail, head, first, last in run.edges:
            along[tail] = run.curve[first : last + 1]
            along[head] = along[tail][::-1]
    for f, darts in enumerate(diagram.faces):
        if not diagram.is_bounded(f):
            continue
        border = np.concatenate([along[p] for p in darts])
        turns, n = abs(diagram.circulation(f)), len(darts)
        if turns:
            axes.fill(border.real, border.imag, color=FACE, alpha=0.15 + 0.75 * turns / n, lw=0, zorder=0)
        middle = layout.faces[f]
        axes.text(
            middle.real,
            middle.imag,
            f"{turns}/{n}",
            ha="center",
            va="center",
            fontsize=size,
            color=INK,
            zorder=5,
        )


def _smoothed(axes: Any, diagram: Diagram, layout: Layout, width: float, size: float) -> None:
    """Seifert circles with their senses, and arcs from end to end."""
    circles = iter(layout.circles)
    loops = diagram.seifert_circles
    curves = [_curve(_turns(diagram, layout, loop, closed=True), True) for loop in loops if loop]
    remaining = iter(curves)
    for loop in loops:
        sense = turning(diagram, loop)
        colour = POSITIVE if sense > 0 else NEGATIVE
        if not loop:
            centre = next(circles)
            _ring(axes, centre, colour, width)
        else:
            curve = next(remaining)
            axes.plot(curve.real, curve.imag, color=colour, lw=width, zorder=3)
            _arrow(axes, curve, 3 * _FINE // 2, colour, 3.6 * width)
            centre = _pole(curve, [other for other in curves if other is not curve])
        _badge(axes, centre, sense, size)
    for arc in diagram.seifert_arcs:
        curve = _curve(_turns(diagram, layout, arc, closed=False), False)
        axes.plot(curve.real, curve.imag, color=GREY, lw=width, zorder=2)
        _arrow(axes, curve, len(curve) - 1, GREY, 4.2 * width)


def _turns(diagram: Diagram, layout: Layout, edges: Sequence[int], closed: bool) -> Complexes:
    """Points along a smoothed curve: two on each edge, and one beside each crossing where it turns."""
    points: list[complex] = []
    for i, e in enumerate(edges):
        tail, head = diagram.edges[e]
        if tail < 0:
            points.append(layout.ends[tail])
        points += [layout.ports[tail], layout.ports[head]]
        if head < 0:
            points.append(layout.ends[head])
        elif closed or i + 1 < len(edges):
            on = diagram.edges[edges[(i + 1) % len(edges)]][0]
            x = layout.crossings[head >> 2]
            side = (layout.ports[head] - x) / abs(layout.ports[head] - x)
            side += (layout.ports[on] - x) / abs(layout.ports[on] - x)
            points.append(x + _CORNER * side / abs(side))
    return np.array(points)


def _pole(curve: Complexes, others: Sequence[Complexes]) -> complex:
    """About the point within a closed curve, but in none of those within it, that is farthest from all."""
    x, y = (np.linspace(part.min(), part.max(), 60) for part in (curve.real, curve.imag))
    grid = (x[:, None] + 1j * y).ravel()
    grid = grid[_within(curve, grid)]
    for other in others:
        if _within(curve, other[:1])[0]:
            grid = grid[~_within(other, grid)]
    near = np.concatenate([curve, *others])[:: _FINE // 6]
    return complex(grid[int(np.argmax(abs(grid[:, None] - near).min(axis=1)))])


def _within(curve: Complexes, points: Complexes) -> NDArray[np.bool_]:
    path = require("matplotlib.path").Path(np.stack([curve.real, curve.imag], axis=1))
    return np.asarray(path.contains_points(np.stack([points.real, points.imag], axis=1)))


def draw_crossing(
    axes: Any,
    sign: int,
    *,
    at: complex = 0j,
    colours: Sequence[str] = STRANDS,
    width: float = 2.4,
) -> None:
    """Draw a crossing: strand A above, right-handed for +1, left-handed for -1; one unit to each end."""
    s = np.linspace(-1, 1, 2 * _FINE + 1)
    up, down = np.exp(0.25j * np.pi), np.exp(0.75j * np.pi)
    # Right-handed: the upper strand turned counterclockwise comes to lie along the lower one.
    above, below = (at + s * way for way in ((up, down) if sign > 0 else (down, up)))
    _cut(axes, above, [], colours[0], width)
    _cut(axes, below, [_FINE], colours[1], width)
    for curve, colour in ((above, colours[0]), (below, colours[1])):
        _arrow(axes, curve, len(curve) - 1, colour, 4.2 * width)
