"""Figure 3-1, C and D: breaks follow one another as bending waves bring them.

Frames of a cascade, its pieces stopped when no end holds them, as in the thesis; and the time between the
first two breaks against their distance, of rods whose strength scatters and which were given different least
lengths of a fragment, beside the paths of the two highest crests of the wave (3.20).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import breaking, panels
from torsade.figures.base import Cell, Choice, Figure, Table
from torsade.fracture.theory.scales import bending_time
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

ROD = breaking.RODS[1]
LENGTHS = (0.01, 0.015, 0.02, 0.03, 0.04, 0.05)
"""Least lengths of a fragment [m] of the rods in D."""

TIMES = (0.0, 100e-6, 160e-6, 300e-6, 350e-6, 600e-6)


def runs(choice: Choice) -> Mapping[str, Spec]:
    """One cascade, and rods of many least lengths."""
    from torsade.protocols.snap_twist import SnapTwist

    seeds = 1 if choice.quick else 8
    cascade = SnapTwist(frames=50 if choice.quick else 412, pieces="frozen")
    return {"cascade-frozen": cascade} | {
        f"second-{1e3 * length:g}-{seed}": SnapTwist(
            min_fragment=length, disorder=breaking.DISORDER, seed=seed, frames=4
        )
        for length in LENGTHS
        for seed in range(1, seeds + 1)
    }


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """The second break of each rod, with the time at which the highest crest of the wave would come."""
    rows: list[tuple[Cell, ...]] = []
    for label, result in results.items():
        times, places = (result.dataset.attrs[f"break_{what}"] for what in ("times_s", "places_m"))
        if label.startswith("second-") and len(times) > 1:
            apart = abs(places[1] - places[0])
            crest = bending_time(ROD, apart)
            given, seed = 1e3 * float(result.spec["min_fragment"]), int(result.spec["seed"])
            rows.append((given, seed, 1e3 * apart, 1e6 * (times[1] - times[0]), 1e6 * crest))
    columns = ("given_lambda_mm", "seed", "distance_mm", "time_us", "crest_us")
    breaks: list[tuple[Cell, ...]] = [
        (1e6 * t, 1e3 * x, ratio)
        for t, x, ratio in zip(
            *(
                results["cascade-frozen"].dataset.attrs[f"break_{what}"]
                for what in ("times_s", "places_m", "stress_ratios")
            ),
            strict=True,
        )
    ]
    return {
        "": Table(columns, rows),
        "cascade": Table(("time_us", "place_mm", "stress_over_strength"), breaks),
    }


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 3.6)
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.05))
        lines = _cascade(left, results["cascade-frozen"])
        bar = figure.colorbar(lines, ax=left, shrink=0.8, aspect=25, ticks=[0, 0.5, 1], pad=0.02)
        bar.set_label(r"stress/$\sigma_c$")
        bar.outline.set_visible(False)
        _paths(right, tables[""])
        panels.letter(left, "C", -0.02)
        panels.letter(right, "D", -0.14)
        panels.save(figure, path)


def _cascade(axes: Any, result: Result) -> Any:
    data, step = result.dataset, 62.0
    for k, time in enumerate(TIMES):
        frame = int(np.argmin(np.abs(np.asarray(data["time"].values) - time)))
        lines = breaking.draw_pieces(axes, result, frame, (0.0, -step * k))
        axes.annotate(f"{1e6 * time:.0f} µs", (-8, -step * k), ha="right", va="bottom", fontsize=6.5)
    axes.set(xlim=(-48, 190), ylim=(-step * len(TIMES) + 50, 85), aspect="equal")
    axes.axis("off")
    return lines


def _paths(axes: Any, table: Table) -> None:
    """Second breaks, and where the crests of the wave are."""
    x, t = (np.asarray(table.column(name), np.float64) for name in ("distance_mm", "time_us"))
    given = np.asarray(table.column("given_lambda_mm"), np.float64)
    reach = 60.0
    far = np.linspace(0, reach, 200)
    # A crest is where x = w sqrt(pi h c_s t), w^2 = 2, 6, ...
    for squared, dashes, label in ((2, "-", "highest crest (3.21)"), (6, (0, (4, 2)), "the one before it")):
        path = 1e6 * (1e-3 * far) ** 2 / (squared * np.pi * ROD.h * ROD.c_s)
        axes.plot(path, far, color=panels.INK, linestyle=dashes, linewidth=1.0, label=label)
    points = axes.scatter(t, x, c=given, cmap="viridis", s=16, edgecolors="white", linewidths=0.4, zorder=3)
    bar = axes.figure.colorbar(points, ax=axes, aspect=25, pad=0.02)
    bar.set_label(r"least length $\lambda$ given (mm)")
    bar.outline.set_visible(False)
    axes.set(xlim=(0, 350), ylim=(0, reach), xlabel="time between the first two breaks (µs)")
    axes.set_ylabel("distance between them (mm)")
    axes.legend(frameon=False, fontsize=6.5, loc="lower right")


FIGURE = Figure("3-1", "Breaks follow one another as bending waves bring them", runs, measure, draw)
