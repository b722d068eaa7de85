"""Figure 5-3: how batteries discharge.

(A) Shapes on the way. (B) Energy at the cut against twist, a line for every knot. (C) Energy against time.
(D) Discharge times of all knots and twists; rings mark those that are resonant. (E) The same against twist.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import battery_map, panels
from torsade.figures.base import Choice, Figure, Table
from torsade.figures.battery_map import label
from torsade.protocols.battery import Battery, even_twist_energy
from torsade.view._extra import require
from torsade.view.battery import SHARES, TOP, density_bar, shapes

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

PICTURED = (("3_1", 0.0), ("7_4", 0.0), ("7_4", 3.0))
"""Knots and twist densities of panel A."""

FOLLOWED = (("3_1", 0.0), ("4_1", 0.0), ("7_4", 0.0), ("3_1", 3.0), ("7_4", 3.0))
"""Of panel C."""

MARKED = {"3_1": "#c9543f", "5_1": "#d99b2b", "4_1": "#2f6fa8", "7_4": "#3c8c5a"}
"""Knots whose lines have a colour of their own."""

PALETTE = "YlGnBu"


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Batteries that are drawn; the others of the map are numbers."""
    options: Mapping[str, Any] = battery_map.QUICK if choice.quick else {}
    return {label(knot, twist): Battery(knot=knot, twist=twist, **options) for knot, twist in FOLLOWED}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Energy against time of the batteries of panel C."""
    columns = ("knot", "twist_density", "time_T0", "energy_share")
    rows = []
    for knot, twist in FOLLOWED:
        data = results[label(knot, twist)].dataset
        energy = np.asarray(data["sample_energy"].values, np.float64)
        time = np.asarray(data["sample_time"].values, np.float64) / data.attrs["T0_s"]
        rows += [(knot, twist, float(t), float(e)) for t, e in zip(time, energy / energy[0], strict=True)]
    return {"discharge": Table(columns, list(rows))}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.4, 9.4)
        upper, middle, lower = figure.subfigures(3, 1, height_ratios=(4.3, 2.3, 2.9))
        _draw_shapes(upper, results)
        before, after = middle.subplots(1, 2)
        _draw_energies(before, tables["map"])
        _draw_discharge(after, tables["discharge"])
        times, lines = lower.subplots(1, 2, width_ratios=(1.25, 1.0))
        _draw_map(lower, times, tables["map"])
        _draw_times(lines, tables["map"])
        for axes, letter, x in zip(
            (before, after, times, lines), "BCDE", (-0.14, -0.14, -0.12, -0.16), strict=True
        ):
            panels.letter(axes, letter, x)
        panels.save(figure, path)


def _draw_shapes(figure: Any, results: Mapping[str, Result]) -> None:
    """Panel A, a row for every battery, each with its own colour bar."""
    axes = figure.subplots(len(PICTURED), 1 + len(SHARES), squeeze=False)
    for k, (row, (knot, twist)) in enumerate(zip(axes, PICTURED, strict=True)):
        data = results[label(knot, twist)].dataset
        found = list(shapes(data, SHARES))
        top = float(np.quantile(found[0].density, TOP))
        for axis in row:
            axis.axis("off")
        for axis, shape in zip(row, found, strict=False):
            left = f"{100 * shape.left:.2g} % after {shape.time:.2g} $T_0$"
            note = rf"$h\theta' = {twist:g}$" if shape.closed else left
            shape.draw(axis, float(data.attrs["radius"]), top, f"{shape.called}, {note}", (576, 448))
        bar = density_bar(figure, list(row), top, shrink=0.8, pad=0.01)
        if k != len(PICTURED) // 2:
            bar.set_label("")
    panels.letter(axes[0][0], "A")


def _grid(table: Table, name: str) -> tuple[list[str], Floats, Floats]:
    """Knots, twist densities, and a column of the map by knot and twist (n_knots, n_twists)."""
    knots = list(dict.fromkeys(str(knot) for knot in table.column("knot")))
    twists = np.unique(np.asarray(table.column("twist_density"), np.float64))
    values = np.asarray(table.column(name), np.float64).reshape(len(knots), len(twists))
    return knots, twists, values


def _style(knot: str) -> dict[str, Any]:
    """How the line of a knot is drawn."""
    if knot in MARKED:
        return {"color": MARKED[knot], "linewidth": 1.3, "label": knot, "zorder": 3}
    return {"color": "#b9bfc5", "linewidth": 0.7, "zorder": 2}


def _draw_energies(axes: Any, table: Table) -> None:
    knots, twists, energy = _grid(table, "energy_E0")
    for knot, values in zip(knots, energy, strict=True):
        axes.plot(twists, values, **_style(knot))
    fine = np.linspace(twists[0], twists[-1], 200)
    even = [even_twist_energy(twist, Battery(knot=knots[0]).fiber_material.nu) for twist in fine]
    axes.plot(fine, even, color=panels.INK, linewidth=0.8, linestyle=(0, (4, 2)),
              label="even twist alone")  # fmt: skip
    axes.set(
        xlabel=r"twist density $h\theta'$", ylabel="energy at the cut ($E_0$)", yscale="log", ylim=(2e-2, 8)
    )
    axes.legend(frameon=False, fontsize=6.5, loc="lower left")


def _draw_discharge(axes: Any, table: Table) -> None:
    for knot, twist in FOLLOWED:
        rows = [row for row in table.rows if row[:2] == (knot, twist)]
        time, share = np.array([row[2:] for row in rows], np.float64).T
        dashes = (0, (4, 1.5)) if twist else "-"
        axes.plot(time[1:], share[1:], color=MARKED[knot], linestyle=dashes, linewidth=1.2,
                  label=rf"{knot}, $h\theta' = {twist:g}$")  # fmt: skip
    axes.set(xscale="log", yscale="log", xlabel="time after the cut ($T_0$)", ylabel="share of energy left",
             ylim=(8e-4, 1.3), xlim=(1e-3, 60))  # fmt: skip
    axes.legend(frameon=False, fontsize=6.5, loc="lower left")


def _draw_map(figure: Any, axes: Any, table: Table) -> None:
    """Panel D; what failed or did not get there is hatched."""
    knots, twists, times = _grid(table, "T10_T0")
    colors = require("matplotlib.colors")
    known = times[np.isfinite(times)]
    scale = colors.LogNorm(float(known.min()), float(known.max())) if len(known) else None
    step = twists[1] - twists[0]
    edges = np.append(twists - 0.5 * step, twists[-1] + 0.5 * step)
    axes.set_facecolor("#e8eaec")
    mesh = axes.pcolormesh(edges, np.arange(len(knots) + 1), np.ma.masked_invalid(times), norm=scale,
                           cmap=PALETTE, edgecolors="white", linewidth=0.4)  # fmt: skip
    _, _, resonant = _grid(table, "resonant")
    row, column = np.nonzero(resonant)
    axes.plot(
        twists[column], row + 0.5, "o", mfc="none", mec=panels.PRESET_COLOURS["published"], ms=5.5, mew=1.1
    )
    axes.set_yticks(np.arange(len(knots)) + 0.5, knots, fontsize=7)
    axes.invert_yaxis()
    axes.tick_params(length=0)
    axes.set(xlabel=r"twist density $h\theta'$")
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, aspect=30)
    ticks = require("matplotlib.ticker")
    for place in ("major", "minor"):
        shown = (1.0,) if place == "major" else (2.0, 5.0)
        getattr(bar.ax.yaxis, f"set_{place}_locator")(ticks.LogLocator(subs=shown))
        getattr(bar.ax.yaxis, f"set_{place}_formatter")(ticks.FuncFormatter(lambda x, _: f"{x:g}"))
    bar.set_label("time to 10 % ($T_0$)")
    bar.outline.set_visible(False)


def _draw_times(axes: Any, table: Table) -> None:
    knots, twists, times = _grid(table, "T10_T0")
    for knot, values in zip(knots, times, strict=True):
        axes.plot(twists, values, **_style(knot))
    medians = [battery_map.of_known(np.median, column) for column in times.T]
    axes.plot(twists, medians, color=panels.INK, linewidth=1.6, label="median", zorder=4)
    axes.set(xlabel=r"twist density $h\theta'$", ylabel="time to 10 % ($T_0$)", yscale="log")
    axes.legend(frameon=False, fontsize=6.5, loc="upper left")


FIGURE = Figure(
    "5-3", "Batteries discharge: the map of knots and twists", runs, measure, draw, battery_map.SWEPT
)
