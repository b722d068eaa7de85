"""What is drawn on top of a picture: a slim colour bar, arrows and names at the ends of strands."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.view._extra import require
from torsade.view.arrows import Arrow, draw_arrows
from torsade.view.camera import View
from torsade.view.colours import STRAIN_MAX, strain_colormap, stress_colormap

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]
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
    picture: Floats,
    view: View,
    strands: Sequence[Floats],
    radius: float,
    marks: Sequence[Mark],
    arrows: Sequence[Arrow],
    bar: bool,
) -> Floats:
    """The picture (height, width, 3), 0..1, with marks, arrows and, if asked for, the strain colour bar.

    Strands are the nodes (n, 3) of each, in the unit of the view and of the radius.
    """
    if not (bar or marks or arrows):
        return picture

    def draw(figure: Any, axes: Any) -> None:
        draw_arrows(axes, arrows, view, strands, radius)
        pixels = [view.pixels(x) for x in strands]
        for mark in marks:
            _draw_mark(axes, mark, view, pixels, radius * view.scale(strands[mark.strand]))
        if bar:
            draw_bar(figure, emptiest_corner(np.min(picture, axis=2) < 0.98), view.size[1] / 100.0, STRAIN)

    layer = drawn((picture.shape[1], picture.shape[0]), draw) / 255.0
    alpha = layer[:, :, 3:]
    return np.asarray(picture * (1.0 - alpha) + layer[:, :, :3] * alpha)


def drawn(size: tuple[int, int], draw: Callable[[Any, Any], None]) -> Pixels:
    """What is drawn on a transparent sheet of that width and height: (height, width, 4) of RGBA, 0 to 255.

    `draw` is given a figure and axes over all of it that count pixels from the lower left.
    """
    figure_module, agg = require("matplotlib.figure"), require("matplotlib.backends.backend_agg")
    width, height = size
    with require("matplotlib").rc_context(FONT):
        figure = figure_module.Figure(figsize=(width / 100.0, height / 100.0), dpi=100, facecolor="none")
        canvas = agg.FigureCanvasAgg(figure)
        axes = figure.add_axes((0, 0, 1, 1), facecolor="none")
        axes.set(xlim=(0, width), ylim=(0, height))
        axes.axis("off")
        draw(figure, axes)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())


def _draw_mark(axes: Any, mark: Mark, view: View, pixels: Sequence[Floats], radii: Floats) -> None:
    """One mark beside its strand, of radii (n,) pixels, on the side where other strands are further away."""
    own = pixels[mark.strand]
    at = _in_frame(own, mark.node % len(own), view.size)
    if at is None:
        return
    unit, thick = view.size[1] / 100.0, float(radii[at])
    along = own[min(at + 1, len(own) - 1)] - own[max(at - 1, 0)]
    normal = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-12)
    normal *= 1.0 if normal[1] + 1e-6 * normal[0] >= 0 else -1.0
    arrow = np.zeros(2)
    if mark.pull is not None:
        pull = np.asarray(mark.pull, dtype=np.float64)
        flat = np.array([pull @ view.right, pull @ view.up])
        arrow = 5.0 * unit * flat / max(float(np.linalg.norm(flat)), 1e-12)
    others = np.concatenate(pixels)
    first, second = ((own[at] + side * normal * (thick + 3.5 * unit)) for side in (1.0, -1.0))
    clear = [float(np.linalg.norm(others - place, axis=1).min()) for place in (first, second)]
    if clear[1] > clear[0] + 0.5 * unit:
        normal = -normal
    if mark.pull is not None:
        foot = own[at] + normal * (thick + 2.4 * unit + abs(float(arrow @ normal)))
        style = {"arrowstyle": "-|>", "lw": 0.28 * unit, "color": INK, "mutation_scale": 2.4 * unit}
        axes.annotate("", foot + arrow, foot - arrow, arrowprops={**style, "shrinkA": 0, "shrinkB": 0})
    if mark.text:
        half_width = 0.8 * unit * len(mark.text) * abs(float(normal[0]))
        gap = (4.8 if mark.pull is not None else 2.6) * unit + abs(float(arrow @ normal))
        away = thick + gap + half_width
        style = {"ha": "center", "va": "center", "color": INK, "fontsize": 1.9 * unit}
        axes.text(*(own[at] + normal * away), mark.text, **style)


def _in_frame(pixels: Floats, node: int, size: tuple[int, int]) -> int | None:
    """The node of a strand that is nearest, counted along it, to the given one and well inside the frame."""
    margin = 0.10 * np.array(size)
    candidates = np.flatnonzero(np.all((pixels > margin) & (pixels < np.array(size) - margin), axis=1))
    return int(candidates[np.argmin(np.abs(candidates - node))]) if len(candidates) else None


class Bar(NamedTuple):
    """What a colour bar explains: values from 0 to `top`, their colours, ticks and a title."""

    colormap: Callable[[], Any]
    top: float
    ticks: tuple[float, ...]
    title: str


STRAIN = Bar(
    strain_colormap,
    STRAIN_MAX,
    (0.0, 0.2, 0.4, 0.6),
    r"strain  $\log\,(1 + \sqrt{\varepsilon\!:\!\varepsilon})$",
)
STRESS = Bar(stress_colormap, 1.0, (0.0, 0.5, 1.0), "stress / strength")


def draw_bar(figure: Any, place: tuple[float, float], unit: float, bar: Bar) -> None:
    """A colour bar with its lower left corner at a place, in fractions of the frame.

    `unit` is a hundredth of the frame's height [pixels].
    """
    box = figure.add_axes((*place, BAR_WIDTH, BAR_HEIGHT))
    box.imshow(
        np.linspace(0, 1, 1024)[None],
        cmap=bar.colormap(),
        aspect="auto",
        extent=(0.0, bar.top, 0.0, 1.0),
        interpolation="bilinear",
    )
    box.set(yticks=[], xticks=bar.ticks, xticklabels=[f"{tick:g}" for tick in bar.ticks])
    box.tick_params(length=0.5 * unit, width=0.12 * unit, pad=0.5 * unit, labelsize=1.75 * unit, colors=INK)
    for spine in box.spines.values():
        spine.set(linewidth=0.12 * unit, color=INK)
    box.set_title(bar.title, fontsize=1.9 * unit, color=INK, pad=0.9 * unit, loc="left")


def emptiest_corner(ink: NDArray[np.bool_]) -> tuple[float, float]:
    """Left and bottom of a bar, in fractions of the frame, where it covers least ink (height, width).

    Bottom left if equal.
    """
    height, width = ink.shape
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
