"""Figure 3-6: how far waves raise the curvature, and how little the condition for two pieces depends on it.

C is the largest curvature after the first break over that before, in simulations of the full equations in
which nothing else breaks, until the wave has gone half way to the grip; later what comes back from there adds
to it. Near the new end it depends on resolution, so it is given twice: anywhere, and from 2 cm on.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import breaking, panels
from torsade.figures.base import Cell, Choice, Figure, Table
from torsade.fracture.criteria import stress
from torsade.fracture.theory.bending_wave import AMPLIFICATION
from torsade.fracture.theory.binary import binary_slope, threshold
from torsade.fracture.theory.scales import bending_time
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

ROD = breaking.RODS[1]
CURVATURES = (6.0, 8.0, 10.0, 12.0, 14.0)
DEGREES = (0.0, 90.0, 180.0, 270.0, 330.0)
EDGES = (50, 200)
UNTIL = bending_time(ROD, ROD.L / 4)
"""When the wave is half way to the grip [s]."""

FAR = 0.02
"""How far from the new end [m] C is taken a second time."""

FACTORS = (AMPLIFICATION, 1.5, 1.65)


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Rods of the strength at which each twist and curvature would break them, that break once."""
    from torsade.protocols.snap_twist import SnapTwist

    curvatures = CURVATURES[1::2] if choice.quick else CURVATURES
    return {
        f"rise-{edges}-{kappa:g}-{degree:g}": SnapTwist(
            twist=math.radians(degree),
            sigma_c=float(stress(kappa, math.radians(degree) / ROD.L, ROD.E, ROD.mu, ROD.h)),
            min_fragment=ROD.L / 2,
            edges=edges,
            frames=300 if choice.quick else 686,
        )
        for edges in EDGES[: 1 if choice.quick else 2]
        for kappa in curvatures
        for degree in DEGREES
    }


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """C of every run, and where rods begin to break in two for given C."""
    rows: list[tuple[Cell, ...]] = []
    for label, result in results.items():
        _, edges, kappa, degree = label.split("-")
        anywhere, far = _rise(result)
        rows.append((int(edges), float(kappa), float(degree), anywhere, far))
    columns = ("edges", "limit_curvature_per_m", "twist_deg", "C", "C_beyond_2_cm")
    limits: list[tuple[Cell, ...]] = []
    for C in FACTORS:
        at = threshold(ROD, breaking.SIGMA_C[1], C)
        limits.append((C, at.li, math.degrees(at.twist), at.kappa, math.degrees(1 / binary_slope(ROD, C))))
    names = ("C", "li", "threshold_deg", "limit_curvature_per_m", "twist_deg_per_curvature")
    return {"": Table(columns, rows), "lines": Table(names, limits)}


def _rise(result: Result) -> tuple[float, float]:
    """C anywhere, and beyond `FAR` from the new end."""
    before = float(result.dataset.attrs["critical_curvature_per_m"])
    early = np.asarray(result.dataset["time"].values) <= UNTIL
    kappa = np.asarray(result.dataset["curvature"].values, np.float64)[early]
    end = int(result.dataset["piece_start"].values[0][1])
    s = np.arange(end) * ROD.L / int(result.spec["edges"])
    away = s[-1] - s >= FAR * (1 - 1e-9)
    return float(kappa[:, :end].max()) / before, float(kappa[:, :end][:, away].max()) / before


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 2.9)
        left, right = figure.subplots(1, 2)
        _factors(left, tables[""])
        _lines(right)
        panels.letter(left, "A", -0.14)
        panels.letter(right, "B", -0.14)
        panels.save(figure, path)


def _factors(axes: Any, table: Table) -> None:
    columns = {name: np.asarray(table.column(name), np.float64) for name in table.columns}
    finest = columns["edges"] == columns["edges"].max()
    shown = sorted(set(columns["limit_curvature_per_m"]))
    colours = require("matplotlib").colormaps["viridis"](np.linspace(0.0, 0.85, len(shown)))
    for kappa, colour in zip(shown, colours, strict=True):
        for at, name, marker, face in (
            (finest, "C_beyond_2_cm", "o", colour),
            (finest, "C", "o", "white"),
            (~finest, "C", "s", "white"),
        ):
            mine = at & (columns["limit_curvature_per_m"] == kappa)
            axes.plot(
                columns["twist_deg"][mine], columns[name][mine], marker=marker, markersize=3.8, color=colour,
                markerfacecolor=face, linewidth=0.8, markeredgewidth=0.8,
                label=f"{kappa:g} 1/m" if name != "C" else None,
            )  # fmt: skip
    axes.axhline(AMPLIFICATION, color=panels.INK, linewidth=0.8, linestyle=(0, (4, 2)))
    axes.annotate(
        "linear wave, 1.428", (0.98, AMPLIFICATION), xycoords=("axes fraction", "data"), xytext=(0, -3),
        textcoords="offset points", ha="right", va="top", fontsize=6.5,
    )  # fmt: skip
    edges = sorted(set(columns["edges"].astype(int)))
    for at, name, text, below in (
        (finest, "C", f"{edges[-1]} edges, anywhere", False),
        (~finest, "C", f"{edges[0]} edges, anywhere", False),
        (finest, "C_beyond_2_cm", f"{edges[-1]} edges, from 2 cm on", True),
    ):
        heights = columns[name][at & (columns["twist_deg"] == 0)]
        if len(heights):
            axes.annotate(
                text, (4, heights.min() if below else heights.max()), xytext=(0, -5 if below else 3),
                textcoords="offset points", va="top" if below else "bottom", fontsize=6.5,
            )  # fmt: skip
    axes.set(ylim=(1.38, 1.72), xlim=(-12, 345), xlabel="twist (degrees)", ylabel="curvature increase C")
    axes.xaxis.set_major_locator(require("matplotlib.ticker").MultipleLocator(90))
    axes.legend(frameon=False, fontsize=6.5, ncols=3, loc="upper left", handlelength=1.4, columnspacing=1.0)


def _lines(axes: Any) -> None:
    breaking.critical_curves(axes, 1, all_forms=False)
    twist = np.linspace(0, 420, 50)
    for C, dashes in zip(FACTORS, ("-", (0, (5, 2)), (0, (1.2, 1.2))), strict=True):
        at = threshold(ROD, breaking.SIGMA_C[1], C)
        axes.plot(
            twist, binary_slope(ROD, C) * np.radians(twist), color="#5b3a8e", linestyle=dashes, linewidth=1.1,
            label=f"C = {C:.3g}: {math.degrees(at.twist):.0f}°",
        )  # fmt: skip
        axes.plot(math.degrees(at.twist), at.kappa, "o", color="#5b3a8e", markersize=3)
    axes.legend(frameon=False, fontsize=6.5, loc="lower right", bbox_to_anchor=(0.84, 0.0), handlelength=2.2)


FIGURE = Figure(
    "3-6", "The rise of curvature after a break, and the condition for two pieces", runs, measure, draw
)
