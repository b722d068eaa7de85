"""Figure 3-5: twist leaves a rod that has broken before its curvature changes.

Simulations of the whole rod beside linear theory: the damped twist wave, and the curvature of a beam that was
let go with the curvature that the rod had. No second break is allowed, so that the waves run on.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import breaking, panels
from torsade.figures.base import Cell, Choice, Figure, Table
from torsade.fracture.theory.bending_wave import released_rod
from torsade.fracture.theory.twist_wave import twist_wave
from torsade.material import named_material
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

DAMPING = named_material("spaghetti").twist_damping
DEGREES = (120.0, 330.0)
TWIST_TIMES = (0.0, 30e-6, 60e-6, 120e-6, 180e-6, 243e-6)
BEND_TIMES = (0.0, 30e-6, 90e-6, 240e-6)


def runs(choice: Choice) -> Mapping[str, Spec]:
    """A rod with less and one with more twist than breaks it in two."""
    from torsade.protocols.snap_twist import SnapTwist

    rod = breaking.RODS[1]
    edges, frames = (50, 50) if choice.quick else (200, 686)
    return {
        f"twist-{degree:g}": SnapTwist(
            twist=math.radians(degree), min_fragment=rod.L / 2, edges=edges, frames=frames
        )
        for degree in DEGREES
    }


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Twist density and curvature along half the rod, in units of what they were, with theory."""
    twist: list[tuple[Cell, ...]] = []
    bend: list[tuple[Cell, ...]] = []
    for label, result in results.items():
        degree = float(label.removeprefix("twist-"))
        twist += [(degree, *row) for row in _twist_rows(result)]
        bend += [(degree, *row) for row in _bend_rows(result)]
    return {
        "": Table(
            ("twist_deg", "t_us", "twist_density_at_grip", "theory", "largest_kappa_over_kappa_c"),
            _summary(results),
        ),
        "twist": Table(("twist_deg", "t_us", "x_mm", "twist_density", "theory"), twist),
        "curvature": Table(("twist_deg", "t_us", "x_mm", "kappa_over_kappa_c", "euler"), bend),
    }


def _frame(result: Result, time: float) -> int:
    return int(np.argmin(np.abs(np.asarray(result.dataset["time"].values) - time)))


def _twist_rows(result: Result) -> list[tuple[Cell, ...]]:
    rod, Tw = breaking.RODS[1], float(result.spec["twist"])
    rows: list[tuple[Cell, ...]] = []
    for time in TWIST_TIMES:
        frame = _frame(result, time)
        t = float(result.dataset["time"].values[frame])
        x, density = breaking.half(result, frame, "twist_density")
        theory = twist_wave(x, t, rod.L, rod.c_theta, DAMPING).theta_prime * rod.L
        rows += [
            (1e6 * t, 1e3 * float(a), float(b) * rod.L / Tw, float(c))
            for a, b, c in zip(x[1:-1], density[1:-1], theory[1:-1], strict=True)
        ]
    return rows


def _bend_rows(result: Result) -> list[tuple[Cell, ...]]:
    rod, kappa_c = breaking.RODS[1], float(result.dataset.attrs["critical_curvature_per_m"])
    x, start = breaking.half(result, 0, "curvature")
    # The hinge that broke is no more: its curvature is that of its neighbours.
    start[-1] = start[-2]
    fine = np.linspace(0.0, x[-1], 801)
    euler = released_rod(np.interp(fine, x, start), np.asarray(BEND_TIMES), float(x[-1]), rod.h, rod.c_s)
    rows: list[tuple[Cell, ...]] = []
    for time, theory in zip(BEND_TIMES, euler, strict=True):
        frame = _frame(result, time)
        _, kappa = breaking.half(result, frame, "curvature")
        at: Floats = np.interp(x, fine, theory)
        t = float(result.dataset["time"].values[frame])
        rows += [
            (1e6 * t, 1e3 * float(a), float(b) / kappa_c, abs(float(c)) / kappa_c)
            for a, b, c in zip(x[1:-1], kappa[1:-1], at[1:-1], strict=True)
        ]
    return rows


def _summary(results: Mapping[str, Result]) -> list[tuple[Cell, ...]]:
    """At the times of the panel of twist: what is left at the grip, and the largest curvature anywhere."""
    rod = breaking.RODS[1]
    rows: list[tuple[Cell, ...]] = []
    for label, result in results.items():
        Tw, kappa_c = float(result.spec["twist"]), float(result.dataset.attrs["critical_curvature_per_m"])
        for time in TWIST_TIMES:
            frame = _frame(result, time)
            t = float(result.dataset["time"].values[frame])
            _, density = breaking.half(result, frame, "twist_density")
            left = float(twist_wave(0.0, t, rod.L, rod.c_theta, DAMPING).theta_prime) * rod.L
            largest = float(result.dataset["kappa_max"].values[frame]) / kappa_c
            rows.append(
                (float(label.removeprefix("twist-")), 1e6 * t, float(density[1]) * rod.L / Tw, left, largest)
            )
    return rows


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture: twist above, curvature below, a column for each twist."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.0, 4.6)
        axes = figure.subplots(2, len(DEGREES), sharey="row", sharex=True)
        for k, degree in enumerate(DEGREES):
            _panel(axes[0, k], tables["twist"], degree, "twist_density", "theory")
            _panel(axes[1, k], tables["curvature"], degree, "kappa_over_kappa_c", "euler")
            axes[0, k].set_title(f"twist {degree:g}°", loc="center")
            axes[1, k].set_xlabel("distance from the grip (mm)")
        axes[0, 0].set_ylabel(r"$\theta'\,L/\mathrm{Tw}$")
        axes[1, 0].set_ylabel(r"$\kappa/\kappa_c$")
        axes[0, 0].set_ylim(-0.05, 1.3)
        axes[1, 0].set_ylim(0, 1.75)
        panels.letter(axes[0, 0], "A", -0.12)
        panels.letter(axes[1, 0], "B", -0.12)
        panels.save(figure, path)


def _panel(axes: Any, table: Table, degree: float, found: str, theory: str) -> None:
    """Profiles at each time: simulation as lines, theory dashed."""
    columns = [
        np.asarray(table.column(name), np.float64) for name in ("twist_deg", "t_us", "x_mm", found, theory)
    ]
    mine = columns[0] == degree
    times = sorted(set(columns[1][mine]))
    colours = require("matplotlib").colormaps["viridis"](np.linspace(0.0, 0.88, len(times)))
    for t, colour in zip(times, colours, strict=True):
        at = mine & (columns[1] == t)
        axes.plot(columns[2][at], columns[3][at], color=colour, linewidth=1.2, label=f"{t:.0f} µs")
        axes.plot(columns[2][at], columns[4][at], color=panels.INK, linewidth=0.7, linestyle=(0, (3, 2)))
    axes.set_xlim(0, 1e3 * breaking.RODS[1].L / 2)
    axes.legend(frameon=False, fontsize=6.5, ncols=3, loc="upper left", handlelength=1.2, columnspacing=1.0)


FIGURE = Figure("3-5", "Twist leaves a broken rod before its curvature changes", runs, measure, draw)
