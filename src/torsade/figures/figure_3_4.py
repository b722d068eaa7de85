"""Figure 3-4: with enough twist rods break in two.

Cascades without disorder below and above the twist that it takes, as in panels B and D; and, in place of the
experiments of panels E and F, trials with rods whose strength scatters, against theory: the region in which
an ideal rod breaks in two, and the critical curves of the criteria, printed and consistent.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import breaking, panels
from torsade.figures.base import Choice, Figure, Table
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

SHAPES = (60.0, 330.0)
TIMES = (0.0, 0.2e-3, 0.5e-3, 1.0e-3, 2.0e-3)
DEGREES = tuple(float(d) for d in range(0, 330, 15))


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Two cascades, and trials."""
    from torsade.protocols.snap_twist import SnapTwist

    frames, seeds = (41, 1) if choice.quick else (206, 5)
    shapes = {
        f"cascade-{degree:g}": SnapTwist(twist=math.radians(degree), frames=frames) for degree in SHAPES
    }
    degrees = DEGREES[::4] if choice.quick else DEGREES
    return shapes | breaking.twist_trials(1, degrees, range(1, seeds + 1))


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Every trial, and averages over sectors."""
    trials = breaking.trial_table(r for label, r in results.items() if label.startswith("twist-"))
    return {"": breaking.sector_table(trials, breaking.RODS[1]), "trials": trials}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 6.6)
        above, below = figure.subfigures(2, 1, height_ratios=(1.0, 1.05))
        shapes = above.subplots(1, 2)
        for axes, degree, mark in zip(shapes, SHAPES, "BD", strict=True):
            lines = _cascade(axes, results[f"cascade-{degree:g}"], degree)
            panels.letter(axes, mark, -0.02)
        bar = above.colorbar(lines, ax=list(shapes), shrink=0.75, aspect=22, ticks=[0, 0.5, 1], pad=0.02)
        bar.set_label(r"stress/$\sigma_c$")
        bar.outline.set_visible(False)
        left, right = below.subplots(1, 2)
        draw_trials(left, tables["trials"], 1)
        draw_sectors(right, tables[""], 1)
        panels.letter(left, "E", -0.14)
        panels.letter(right, "F", -0.14)
        panels.save(figure, path)


def _cascade(axes: Any, result: Result, degree: float) -> Any:
    """Frames below one another, with their times."""
    data = result.dataset
    for k, time in enumerate(TIMES):
        frame = int(np.argmin(np.abs(np.asarray(data["time"].values) - time)))
        lines = breaking.draw_pieces(axes, result, frame, (0.0, -95.0 * k))
        axes.annotate(f"{1e3 * time:.1f} ms", (-12, -95.0 * k), ha="right", va="bottom", fontsize=6.5)
    axes.set(xlim=(-45, 245), ylim=(-95.0 * len(TIMES) + 65, 95), aspect="equal")
    axes.axis("off")
    pieces = int(data.attrs["fragments"])
    axes.set_title(f"twist {degree:g}°: {pieces} pieces", loc="center")
    return lines


def draw_trials(axes: Any, table: Table, which: int) -> None:
    """Every trial, coloured by its number of pieces, over the region of two pieces."""
    breaking.critical_curves(axes, which, all_forms=False)
    columns = {name: np.asarray(table.column(name), np.float64) for name in table.columns}
    for pieces in sorted(set(columns["pieces"].astype(int))):
        mine = columns["pieces"] == pieces
        axes.plot(
            columns["twist_deg"][mine], columns["limit_curvature_per_m"][mine], "o", markersize=4.2,
            color=breaking.pieces_colour(pieces), markeredgecolor="white", markeredgewidth=0.4,
            label=f"{pieces} pieces",
        )  # fmt: skip
    axes.legend(fontsize=6.5, loc="lower left", handletextpad=0.4, **breaking.PLATE)


def draw_sectors(axes: Any, table: Table, which: int) -> None:
    """Averages over sectors with standard deviations, and the curves of all criteria."""
    breaking.critical_curves(axes, which)
    columns = {name: np.asarray(table.column(name), np.float64) for name in table.columns}
    axes.errorbar(
        columns["twist_deg"], columns["limit_curvature_per_m"], xerr=columns["twist_sd_deg"],
        yerr=columns["limit_curvature_sd_per_m"], fmt="none", ecolor=panels.MUTED, elinewidth=0.8, zorder=4,
    )  # fmt: skip
    points = axes.scatter(
        columns["twist_deg"], columns["limit_curvature_per_m"], c=columns["pieces"], s=26, vmin=2, vmax=6,
        cmap=breaking.pieces_colours(6), edgecolors="white", linewidths=0.5, zorder=5,
    )  # fmt: skip
    bar = axes.figure.colorbar(points, ax=axes, ticks=[2, 3, 4, 5, 6], aspect=22, pad=0.02)
    bar.set_label("mean number of pieces")
    bar.outline.set_visible(False)
    axes.legend(fontsize=6, loc="lower left", handlelength=2.4, **breaking.PLATE)


FIGURE = Figure("3-4", "With enough twist rods break in two", runs, measure, draw)
