"""Figure 6-1: the suturing system, drawn from a run of the surgeon's knot.

(A) The suture at the end of the pull, around both sides of the wound. (B) The same along the skin: what pulls
the suture, what it does to the skin, and what restores the skin to where it was (dashed).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import panels
from torsade.figures.base import Choice, Figure, Table
from torsade.figures.sutures import label, suture, table
from torsade.view._extra import require
from torsade.view.scene import picture
from torsade.view.skin import COLOUR, FROM_ABOVE, skin_at

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

THROWS = "5,-3"
STRAND, EDGE, PULL, PRESS, SPRING = "#3273ab", "#1d466b", "#262a2e", "#c9543f", "#2f7d52"
SHOWN = 0.5
"""Share of the gap at rest that is left in panel B: a wound that is closing."""

PER_NEWTON = 0.17
"""Length of arrows [m/N]."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """The surgeon's knot."""
    return {label(THROWS, 0.0): suture(THROWS, 0.0, choice)}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """What the suture does to the skin."""
    return {"": table(results)}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    data = results[label(THROWS, 0.0)].dataset
    radius = float(data.attrs["radius"])
    image = picture(
        [np.asarray(data["position"].values[-1], np.float64)],
        False,
        radius,
        size=(1120, 960),
        direction=FROM_ABOVE,
        skin=skin_at(data, -1),
        fill=0.8,
        fade=0.05,
    )
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.4, 3.3)
        left, right = figure.subplots(1, 2)
        left.imshow(image, interpolation="antialiased")
        left.axis("off")
        panels.letter(left, "A")
        _along_skin(right, data, radius)
        panels.letter(right, "B")
        panels.save(figure, path)


def _along_skin(axis: Any, data: Any, radius: float) -> None:
    """The suture seen along the skin while the wound closes, with forces as arrows."""
    skin = skin_at(data, 0)
    assert skin is not None
    gaps = np.asarray(data["gap"].values)
    frame = int(np.argmax(gaps <= SHOWN * gaps[0])) if np.any(gaps <= SHOWN * gaps[0]) else len(gaps) - 1
    rest = np.asarray(data["skin_position"].values[0], np.float64)
    w = np.asarray(data["skin_position"].values[frame], np.float64)
    unit = 1e3  # drawn in millimetres
    patches = require("matplotlib.patches")
    for centre, was in zip(w, rest, strict=True):
        body = {"facecolor": COLOUR, "edgecolor": "#c49a86", "linewidth": 0.8, "zorder": 1}
        axis.add_patch(patches.Circle(unit * centre[:2], unit * skin.radius, **body))
        old = {
            "fill": False,
            "edgecolor": panels.MUTED,
            "linewidth": 0.8,
            "linestyle": (0, (4, 2)),
            "zorder": 2,
        }
        axis.add_patch(patches.Circle(unit * was[:2], unit * skin.radius, **old))
    x = unit * np.asarray(data["position"].values[frame], np.float64)
    h = unit * radius
    across = 1.35 * (float(w[1, 0] - w[0, 0]) + 2 * skin.radius) * unit / 2
    bottom, top = unit * (w[:, 1].min() - skin.radius) - 4 * h, float(x[:, 1][np.abs(x[:, 0]) < across].max())
    axis.set_xlim(-1.7 * across, 1.7 * across)
    axis.set_ylim(bottom, top + 9 * h)
    axis.set_aspect("equal")
    axis.axis("off")
    _strand(axis, x, h)
    _forces(axis, data, frame, unit, across, x)


def _strand(axis: Any, x: Floats, h: float) -> None:
    """The strand as wide as it is, the upper part over the lower where it crosses itself."""
    patches, paths = require("matplotlib.patches"), require("matplotlib.path")
    middle = 0.5 * (x[1:] + x[:-1])
    for k in np.argsort(middle[:, 2], kind="stable"):
        along = x[k + 1] - x[k]
        along = along[:2] / max(float(np.linalg.norm(along[:2])), 1e-12)
        side = np.array([-along[1], along[0]])
        a, b = x[k, :2] - 0.6 * h * along, x[k + 1, :2] + 0.6 * h * along
        for width, colour in ((h, EDGE), (0.74 * h, STRAND)):
            corners = [a + width * side, b + width * side, b - width * side, a - width * side]
            part = paths.Path([*corners, corners[0]])
            axis.add_patch(patches.PathPatch(part, facecolor=colour, edgecolor="none", zorder=3))


def _forces(axis: Any, data: Any, frame: int, unit: float, across: float, x: Floats) -> None:
    """Arrows of the pull, of what presses each side, and of the springs."""
    pull = float(json.loads(data.attrs["spec"])["force"])
    for half in (x[: len(x) // 2], x[len(x) // 2 :][::-1]):
        inside = np.flatnonzero(np.abs(half[:, 0]) < across)
        way = half[0, :2] - half[min(12, len(half) - 1), :2]
        way = way / np.linalg.norm(way)
        start = half[inside[0], :2] if len(inside) else half[0, :2]
        _arrow(axis, start, start + unit * PER_NEWTON * pull * way, PULL, "$F_P$")
    w = unit * np.asarray(data["skin_position"].values[frame], np.float64)
    for kind, colour, name, lift in (("skin", PRESS, "$F_C$", 0.35), ("spring", SPRING, "$F_S$", -0.35)):
        for centre, force in zip(w, np.asarray(data[f"{kind}_force"].values[frame]), strict=True):
            step = unit * PER_NEWTON * force[:2]
            start = centre[:2] + np.array([0.0, lift])
            _arrow(axis, start, start + step, colour, name)


def _arrow(axis: Any, a: Floats, b: Floats, colour: str, text: str) -> None:
    """An arrow from a to b, with its name beside its middle, outwards."""
    style = {"arrowstyle": "-|>", "linewidth": 1.4, "color": colour, "mutation_scale": 9}
    axis.annotate("", b, a, arrowprops={**style, "shrinkA": 0, "shrinkB": 0}, annotation_clip=False)
    along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-30)
    side = np.array([-along[1], along[0]])
    side *= 1.0 if side[0] * a[0] > 0 else -1.0
    offset = {"xytext": 9 * side, "textcoords": "offset points", "color": colour, "fontsize": 8}
    axis.annotate(text, 0.5 * (a + b), ha="center", va="center", annotation_clip=False, **offset)


FIGURE = Figure("6-1", "The suturing system", runs, measure, draw)
