"""Figure 6-2: the shear of the skin depends on the throws of a suture.

(A) The throws of the six sutures, as they begin. (B, C) By how much the sides of the skin are displaced along
z, at the end of the pull and at most on the way, against the size of the writhe: with drag alone, as in the
thesis, and with dry friction.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import panels
from torsade.figures.base import Choice, Figure, Table
from torsade.figures.sutures import FRICTIONS, label, suture, table
from torsade.protocols.suture import SIX, Suture
from torsade.view._extra import require
from torsade.view.scene import picture

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

ONE_HAND, TWO_HANDS = "#c9543f", "#2f6fa8"
TITLES = {0.0: "drag alone", 0.3: "dry friction 0.3"}
ASIDE = {"5,-3": 0.35, "3,-5": -0.35, "5,-5": 0.35}
"""Of points that share a writhe, so that they are told apart."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """The six sutures, with and without dry friction."""
    return {label(t, f): suture(t, f, choice) for t in SIX for f in FRICTIONS}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Displacements of every suture."""
    return {"": table(results)}


def _throws(throws: str) -> Floats:
    """Picture of the throws alone, the left and the right half of the strand in two colours."""
    spec = Suture(throws=throws)
    x, _, (first, last) = spec.stitch()
    halves = [x[: first + 1], x[last:]]
    top = float(x[:, 1].max())
    reach = 20.0 * spec.h
    cut = [half[(half[:, 1] > top - 14.0 * spec.h) & (np.abs(half[:, 0]) < reach)] for half in halves]
    return picture(
        cut, False, spec.h, size=(640, 368), direction=(0.0, 0.0, 1.0), whole=True, fill=0.94, fade=0.05
    )


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.4, 4.9)
        upper, lower = figure.subfigures(2, 1, height_ratios=(2.2, 2.4))
        axes = upper.subplots(2, 3)
        for axis, (throws, name) in zip(axes.ravel(), SIX.items(), strict=True):
            axis.imshow(_throws(throws), interpolation="antialiased")
            axis.axis("off")
            b, t = throws.split(",")
            writhe = int(b) + int(t)
            shown = f"{name} ({throws.replace(',', ', ')})   Wr = {writhe:{'+d' if writhe else 'd'}}"
            axis.set_title(shown.replace("-", "−"), loc="center", fontsize=7.5)
        panels.letter(axes[0][0], "A")
        below = lower.subplots(1, len(FRICTIONS), sharey=True)
        for axis, friction, name in zip(below, FRICTIONS, "BC", strict=True):
            _scatter(axis, tables[""], friction)
            panels.letter(axis, name, -0.12 if name == "B" else -0.04)
        highest = max(abs(float(z or 0.0)) for z in tables[""].column("z_largest_a_m"))
        below[0].set_ylim(0.0, 1.25e6 * highest)
        below[0].set_ylabel("|z| of each side (µm)")
        panels.save(figure, path)


def _scatter(axis: Any, found: Table, friction: float) -> None:
    """Displacements against the writhe, at the end and at most."""
    rows: list[dict[str, Any]] = [dict(zip(found.columns, row, strict=True)) for row in found.rows]
    for row in rows:
        if row["friction"] != friction:
            continue
        x = abs(row["Wr"]) + ASIDE.get(row["throws"], 0.0)
        end, most = (1e6 * abs(row[key]) for key in ("z_a_m", "z_largest_a_m"))
        colour = ONE_HAND if abs(row["Wr"]) == row["N"] else TWO_HANDS
        axis.plot([x, x], [end, most], color=colour, linewidth=0.8, alpha=0.6)
        axis.plot(x, most, "o", color=colour, markerfacecolor="white", markersize=4)
        axis.plot(x, end, "o", color=colour, markersize=5)
        crowded = abs(row["Wr"]) < 3
        axis.annotate(
            row["knot"], (x, max(end, most)), xytext=(0, 5), textcoords="offset points",
            ha="left" if crowded else "center", va="bottom", rotation=50 if crowded else 0, fontsize=6.5,
            color=colour, rotation_mode="anchor",
        )  # fmt: skip
    axis.set_xlabel("|Wr|")
    axis.set_xlim(-0.8, 9.4)
    axis.set_title(TITLES[friction], fontsize=8)
    points = [("at the end", "o", panels.MUTED), ("at most", "o", "white")]
    for text, marker, face in points:
        axis.plot([], [], marker, color=panels.MUTED, markerfacecolor=face, markersize=4, label=text)
    axis.legend(frameon=False, fontsize=7, loc="upper left", handletextpad=0.2)


FIGURE = Figure("6-2", "Shear of the skin against the throws of a suture", runs, measure, draw)
