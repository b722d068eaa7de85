"""Figure 3-7: rods quenched at many speeds.

Panels C, D and E from simulations with rods whose strength scatters, once with one least length of a fragment
at all speeds, once with the length that scales as v^(-1/4) (see `torsade.figures.quench`).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import breaking, panels, quench
from torsade.figures.base import Choice, Figure, Table
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

LAWS = (
    ("scaled", "#2f6fa8", r"given $\lambda \sim v^{-1/4}$"),
    ("fixed", "#c9543f", r"given $\lambda$ = 30 mm"),
)


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Quenches with either law."""
    return {**quench.runs(1, choice, "scaled"), **quench.runs(1, choice, "fixed")}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Fits, means at each speed, and every rod."""
    speeds = {law: quench.speed_table(results, 1, law) for law, *_ in LAWS}
    return {
        "": quench.fit_table(speeds),
        **{f"speeds-{law}": table for law, table in speeds.items()},
        "trials": quench.trial_table(results, 1),
    }


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.4, 2.6)
        axes = figure.subplots(1, 3)
        _curvatures(axes[0], tables["trials"])
        for law, colour, label in LAWS:
            _lengths(axes[1], tables[f"speeds-{law}"], colour, label)
            quench.draw_breaks(axes[2], tables[f"speeds-{law}"], colour, label)
        axes[1].legend(frameon=False, fontsize=6.5, loc="lower left")
        axes[2].set_ylim(0, None)
        for one, mark in zip(axes, "CDE", strict=True):
            panels.letter(one, mark, -0.2)
        panels.save(figure, path)


def _curvatures(axes: Any, table: Table) -> None:
    """Limit curvature of every rod against speed, coloured by its number of pieces, and means."""
    c = {name: np.asarray(table.column(name), np.float64) for name in table.columns}
    points = axes.scatter(
        c["speed_mm_per_s"], c["limit_curvature_per_m"], c=c["pieces"], cmap="viridis_r", s=16,
        edgecolors="white", linewidths=0.4, zorder=3,
    )  # fmt: skip
    bar = axes.figure.colorbar(points, ax=axes, aspect=25, pad=0.02)
    bar.set_label("pieces")
    bar.outline.set_visible(False)
    bar.ax.yaxis.set_major_locator(require("matplotlib.ticker").MaxNLocator(5, integer=True))
    means = breaking.mean_by(list(c["speed_mm_per_s"]), list(c["limit_curvature_per_m"]))
    axes.plot(
        [v for v, _ in means],
        [m.value for _, m in means],
        "_",
        color="#d6569a",
        markersize=9,
        markeredgewidth=1.8,
        zorder=4,
    )
    axes.axhline(float(c["limit_curvature_per_m"].mean()), color=panels.INK, linewidth=0.8)
    axes.set_xscale("log")
    axes.set_ylim(0, 16)
    axes.yaxis.set_major_locator(require("matplotlib.ticker").MultipleLocator(4))
    axes.set_xlabel("quench speed v (mm/s)")
    axes.set_ylabel("limit curvature (1/m)")


def _lengths(axes: Any, table: Table, colour: str, label: str) -> None:
    """lambda as the estimator has it against speed, and what rods were given."""
    v, mean, error, given = (
        np.asarray(table.column(name), np.float64)
        for name in ("speed_mm_per_s", "lambda_mm", "lambda_se_mm", "given_lambda_mm")
    )
    axes.errorbar(
        v, mean, yerr=np.nan_to_num(error), fmt="o", color=colour, markersize=3.8, elinewidth=0.8, label=label
    )
    axes.plot(v, given, color=colour, linewidth=0.9)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(6, 70)
    ticks = (7, 10, 20, 30, 40, 60)
    axes.set_yticks(ticks, [str(t) for t in ticks])
    axes.minorticks_off()
    axes.set_xlabel("quench speed v (mm/s)")
    axes.set_ylabel(r"smallest fragment $\lambda$ (mm)")


FIGURE = Figure("3-7", "Rods quenched at many speeds", runs, measure, draw)
