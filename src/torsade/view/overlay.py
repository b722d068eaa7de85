"""What is drawn on top of a picture: a slim colour bar, arrows and names at the ends of strands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.view._extra import require
from torsade.view.camera import View
from torsade.view.colours import STRAIN_MAX, strain_colormap

Floats = NDArray[np.float64]
INK = "#262a2e"
FONT = {"font.family": "sans-serif", "font.sans-serif": ["Helvetica", "Arial", "DejaVu Sans"]}
BAR_WIDTH, BAR_HEIGHT = 0.30, 0.016
"""Size of the colour bar, in widths and heights of the frame."""


class Mark(NamedTuple):
    """A name, an arrow or both beside a node.

    Attributes
    ----------
    strand : number of the strand
    node : number of the node on it, negative from its end; when the node is outside the frame the mark
        stands where the strand leaves the frame on the way to it
    text : what to write, for instance the name of the end
    pull : (3,) direction of an arrow in space, for instance that of the pulling force
    """

    strand: int
    node: int
    text: str = ""
    pull: tuple[float, float, float] | None = None


def draw_over(
    picture: Floats, view: View, strands: Sequence[Floats], radius: float, marks: Sequence[Mark], bar: bool
) -> Floats:
    """The picture (height, width, 3), 0..1, with marks and, if asked for, the strain colour bar."""
    if not (bar or marks):
        return picture
    figure_module, agg = require("matplotlib.figure"), require("matplotlib.backends.backend_agg")
    height, width = picture.shape[:2]
    with require("matplotlib").rc_context(FONT):
        figure = figure_module.Figure(figsize=(width / 100.0, height / 100.0), dpi=100, facecolor="none")
        canvas = agg.FigureCanvasAgg(figure)
        axes = figure.add_axes((0, 0, 1, 1), facecolor="none")
        axes.set(xlim=(0, width), ylim=(0, height))
        axes.axis("off")
        for mark in marks:
            _draw_mark(axes, mark, view, strands[mark.strand], radius)
        if bar:
            _draw_bar(figure, picture)
        canvas.draw()
        layer = np.asarray(canvas.buffer_rgba(), dtype=np.float64) / 255.0
    alpha = layer[:, :, 3:]
    return np.asarray(picture * (1.0 - alpha) + layer[:, :, :3] * alpha)


def _draw_mark(axes: Any, mark: Mark, view: View, x: Floats, radius: float) -> None:
    """One mark, set off by a little more than a radius from the strand, on its upper side."""
    place = _in_frame(view.pixels(x), mark.node % len(x), view.size)
    if place is None:
        return
    unit = view.size[1] / 100.0
    clear = 0.5 * radius * view.size[1] / view.half_height
    normal = np.array([0.0, 1.0])
    if mark.pull is not None:
        pull = np.asarray(mark.pull, dtype=np.float64)
        flat = np.array([pull @ view.right, pull @ view.up])
        along = flat / max(float(np.linalg.norm(flat)), 1e-12)
        normal = np.array([-along[1], along[0]]) * (1.0 if along[0] >= 0 else -1.0)
        foot = place + normal * (clear + 2.2 * unit)
        tail, tip = foot - 5.0 * unit * along, foot + 5.0 * unit * along
        style = {"arrowstyle": "-|>", "lw": 0.28 * unit, "color": INK, "mutation_scale": 2.4 * unit}
        axes.annotate("", tip, tail, arrowprops={**style, "shrinkA": 0, "shrinkB": 0})
    if mark.text:
        away = clear + (4.6 if mark.pull is not None else 2.4) * unit
        style = {"ha": "center", "va": "center", "color": INK, "fontsize": 1.9 * unit}
        axes.text(*(place + normal * away), mark.text, **style)


def _in_frame(pixels: Floats, node: int, size: tuple[int, int]) -> Floats | None:
    """The point (2,) of a strand nearest to a node, counted along it, that is well inside the frame."""
    margin = 0.09 * np.array(size)
    inside = np.all((pixels > margin) & (pixels < np.array(size) - margin), axis=1)
    candidates = np.flatnonzero(inside)
    if not len(candidates):
        return None
    return np.asarray(pixels[candidates[np.argmin(np.abs(candidates - node))]])


def _draw_bar(figure: Any, picture: Floats) -> None:
    """The strain colour bar in the emptiest corner."""
    height, width = picture.shape[:2]
    unit = height / 100.0
    left, bottom = _emptiest_corner(picture)
    box = figure.add_axes((left, bottom, BAR_WIDTH, BAR_HEIGHT))
    box.imshow(np.linspace(0, 1, 1024)[None], cmap=strain_colormap(), aspect="auto",
               extent=(0.0, STRAIN_MAX, 0.0, 1.0), interpolation="bilinear")
    box.set(yticks=[], xticks=[0.0, 0.2, 0.4, 0.6])
    box.tick_params(length=0.5 * unit, width=0.12 * unit, pad=0.5 * unit, labelsize=1.75 * unit, colors=INK)
    for spine in box.spines.values():
        spine.set(linewidth=0.12 * unit, color=INK)
    title = r"strain  $\log\,(1 + \sqrt{\varepsilon\!:\!\varepsilon})$"
    box.set_title(title, fontsize=1.9 * unit, color=INK, pad=0.9 * unit, loc="left")


def _emptiest_corner(picture: Floats) -> tuple[float, float]:
    """Left and bottom of the bar, in fractions of the frame, where it covers least; bottom left if equal."""
    height, width = picture.shape[:2]
    ink = np.min(picture, axis=2) < 0.98
    edge = 0.045
    best, place = np.inf, (edge, edge + 0.04)
    for bottom in (edge + 0.04, 1.0 - edge - 0.06):
        for left in (edge, 1.0 - edge - BAR_WIDTH):
            x0, x1 = int((left - 0.02) * width), int((left + BAR_WIDTH + 0.02) * width)
            y0, y1 = int((1.0 - bottom - 0.08) * height), int((1.0 - bottom + 0.06) * height)
            covered = float(ink[y0:y1, x0:x1].mean())
            if covered < best - 1e-4:
                best, place = covered, (left, bottom)
    return place
