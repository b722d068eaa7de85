"""Figure 4-8: the bends ranked by two measures of a run, and the shapes of tight ones.

(B) Topological friction and total compression of each bend, over the mean of the four simplest, in place of
the thesis's critical masses, which it does not give as numbers. (C) Bends just before they slip, or at the
end, coloured by strain.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import bends, panels
from torsade.figures.base import Choice, Figure, Preset, Table
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

SIMPLE = ("reef", "thief", "granny", "grief")
"""Bends whose mean is the unit of both measures."""

PICTURED = ("zeppelin14", "alpine13", "carrick14", "hunter14", "ashley14")
"""Bends whose shape is shown."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """All bends."""
    return bends.specs(choice)


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Both measures of every bend, as they are and over the mean of the simple ones, strongest first."""
    table = bends.table(results, choice)
    columns = ("knot", "preset", "c_f", "compression_N", "c_f_normalised", "compression_normalised", "holds")
    rows = []
    for preset in choice.presets:
        found = [row for row in table.only(*columns[:4], "holds").rows if row[1] == preset and row[2]]
        values = np.array([row[2:4] for row in found], np.float64)
        unit = values[[row[0] in SIMPLE for row in found]].mean(axis=0)
        rows += [
            (*row[:4], *(float(x) for x in value / unit), row[4])
            for row, value in zip(found, values, strict=True)
        ]
    return {"": Table(columns, list(rows)), "bends": table}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    shown = [knot for knot in PICTURED if knot in bends.labels(choice)] or list(SIMPLE)
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 6.6)
        upper, lower = figure.subfigures(2, 1, height_ratios=(4.3, 2.3))
        pair = upper.subplots(1, len(choice.presets), squeeze=False)[0]
        for axes, preset in zip(pair, choice.presets, strict=True):
            _measures(axes, tables[""], preset)
        pair[0].legend(loc="lower right", frameon=False, fontsize=7)
        panels.letter(pair[0], "B", -0.2)
        grid = lower.subplots(len(choice.presets), len(shown), squeeze=False)
        for line, preset in zip(grid, choice.presets, strict=True):
            for axes, knot in zip(line, shown, strict=True):
                panels.knot_picture(axes, results[bends.label_of(knot, preset)], (480, 320), fill=0.8)
                if preset == choice.presets[0]:
                    axes.set_title(panels.name_of(knot), loc="center", fontsize=7.5)
            line[0].annotate(
                preset, (0, 0.5), xycoords="axes fraction", xytext=(-3, 0), textcoords="offset points",
                rotation=90, ha="right", va="center", fontsize=7.5,
            )  # fmt: skip
        panels.letter(grid[0][0], "C")
        panels.strain_bar(lower, grid, shrink=0.7, pad=0.01, aspect=30)
        panels.save(figure, path)


def _measures(axes: Any, table: Table, preset: Preset) -> None:
    """One line for each bend, the strongest on top: friction and compression."""
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows if row[1] == preset]
    height = -np.arange(len(rows), dtype=float)
    friction, pressed = (
        [float(str(row[name])) for row in rows] for name in ("c_f_normalised", "compression_normalised")
    )
    colour = panels.PRESET_COLOURS[preset]
    axes.hlines(height, friction, pressed, color="#c9ced3", lw=1.0, zorder=1)
    axes.plot(friction, height, "o", ms=4.5, color=colour, label="friction $c_f$")
    axes.plot(pressed, height, "^", ms=4.5, mfc="white", mec=colour, mew=1.0, label="total compression")
    names = [panels.name_of(str(row["knot"])) + ("" if row["holds"] else "*") for row in rows]
    axes.set_yticks(height, names, fontsize=6.5)
    axes.set(title=f"{preset} (* slips)", xlabel="over the mean of reef, thief, granny and grief")
    axes.set(ylim=(height[-1] - 0.7, 0.7))
    axes.tick_params(axis="y", length=0)
    axes.set_xlim(left=0)


FIGURE = Figure(
    "4-8", "Bends ranked by friction and by compression, and their tight shapes", runs, measure, draw
)
