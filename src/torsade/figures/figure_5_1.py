"""Figure 5-1: what a battery is.

(A) The knots of chapter 5, tight. (B) One of them tied and twisted, charged, cut, and on its way to a
straight fiber. (C) Its energy by kind, its writhe and how many crossings it is seen with, before and after
the cut.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import panels
from torsade.figures.base import Choice, Figure, Table
from torsade.figures.battery_map import KINDS, KNOTS, label
from torsade.view._extra import require
from torsade.view.battery import TOP, Shape, density_bar, energy_lines, name_knots, shapes, time_axis
from torsade.view.scene import picture

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

KNOT, TWIST = "7_4", 1.0
"""The battery of panels B and C."""

LABEL = label(KNOT, TWIST)

SHARES = (0.9, 0.5, 0.1, 0.01)
"""Of the energy at the cut, at which panel B shows it."""

COLUMNS = 7
"""Of panel A."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """The one battery."""
    from torsade.protocols.battery import Battery

    options: Mapping[str, Any] = (
        {"nodes": 60, "charging": "0.5 s", "duration": "1 s", "frames": 20}
        if choice.quick
        else {"frames": 120}
    )
    return {LABEL: Battery(knot=KNOT, twist=TWIST, **options)}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Energies, writhe and knot at every frame, before and after the cut."""
    data = results[LABEL].dataset
    columns = ("cut", "time_T0", *(f"{kind}_E0" for kind in KINDS), "writhe", "crossings", "knot")
    rows: list[tuple[Any, ...]] = []
    for cut, before, axis, names in (
        (False, "charge_", "charge", data.attrs["charge_knots"]),
        (True, "", "time", data.attrs["frame_knots"]),
    ):
        for k, name in enumerate(names):
            then = data.isel({axis: k})
            energies = (float(then[f"{before}energy_{kind}"]) / data.attrs["E0_J"] for kind in KINDS)
            crossings = int(then["fewest_crossings"]) if cut else None
            time = float(then[f"{before}time"]) / data.attrs["T0_s"]
            rows.append((cut, time, *energies, float(then[f"{before}writhe"]), crossings, name))
    return {"": Table(columns, rows)}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    data = results[LABEL].dataset
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.4, 7.0)
        upper, middle, lower = figure.subfigures(3, 1, height_ratios=(2.4, 1.75, 2.5))
        _draw_knots(upper)
        _draw_sequence(middle, data)
        _draw_energies(lower, tables[""])
        panels.save(figure, path)


def _draw_knots(figure: Any) -> None:
    """Panel A."""
    from torsade.knots.loops import tight_loop

    axes = figure.subplots(-(-len(KNOTS) // COLUMNS), COLUMNS)
    for axis, knot in zip(axes.ravel(), KNOTS, strict=True):
        x = tight_loop(knot).nodes
        axis.imshow(
            picture([x], True, 1.0, size=(384, 384), fill=0.86, whole=True), interpolation="antialiased"
        )
        axis.axis("off")
        axis.set_title(knot, loc="center", fontsize=7.5, pad=1)
    panels.letter(axes[0, 0], "A")


def _draw_sequence(figure: Any, data: Any) -> None:
    """Panel B."""
    found = [Shape.charging(data, 0), *shapes(data, SHARES)]
    axes = figure.subplots(1, 2 + len(SHARES))
    top = float(np.quantile(found[1].density, TOP))
    titles = ["tied and twisted", f"at rest after {found[1].time:.0f} $T_0$"]
    titles += [f"cut, {shape.time:.2g} $T_0$: {100 * shape.left:.2g} %" for shape in found[2:]]
    for axis in axes:
        axis.axis("off")
    for axis, shape, title in zip(axes, found, titles, strict=False):
        shape.draw(axis, float(data.attrs["radius"]), top, f"{shape.called}\n{title}", (416, 448))
        axis.title.set_fontsize(6.5)
    density_bar(figure, list(axes), top, shrink=0.75, pad=0.01)
    panels.letter(axes[0], "B")


def _draw_energies(figure: Any, table: Table) -> None:
    """Panel C: two axes of time, which meet at the cut."""
    axes = figure.subplots(2, 2, sharey="row", sharex="col", height_ratios=(3, 1.2), width_ratios=(1, 1.6))
    cut = np.asarray(table.column("cut"), bool)
    time = np.asarray(table.column("time_T0"), np.float64)
    kinds = {kind: np.asarray(table.column(f"{kind}_E0"), np.float64) for kind in KINDS}
    most = []
    for side, where in zip(axes.T, (~cut, cut), strict=True):
        most.append(energy_lines(side[0], time[where], {kind: kinds[kind][where] for kind in kinds}))
        time_axis(side[1], time[where])
    axes[0, 0].set_ylim(5e-4 * most[1], 2 * max(most))
    writhe = np.asarray(table.column("writhe"), np.float64)
    crossings = np.asarray([np.nan if c is None else c for c in table.column("crossings")], np.float64)
    names = table.column("knot")
    axes[1, 0].plot(time[~cut], writhe[~cut], color=panels.MUTED, label="writhe")
    axes[1, 1].plot(time[cut], writhe[cut], color=panels.MUTED, label="writhe")
    axes[1, 1].step(time[cut], crossings[cut], where="post", color=panels.INK, label="crossings")
    name_knots(axes[:, 1], time[cut], [str(name) for name, after in zip(names, cut, strict=True) if after])
    axes[1, 1].set_ylim(-0.6, float(np.nanmax(crossings)) + 2.6)
    axes[0, 0].set_ylabel("energy ($E_0$)")
    axes[1, 0].set_xlabel("time since it was twisted ($T_0$)")
    axes[1, 1].set_xlabel("time after the cut ($T_0$)")
    axes[0, 1].legend(frameon=False, ncols=5, fontsize=6.5, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    axes[1, 1].legend(frameon=False, fontsize=6.5, loc="center left", bbox_to_anchor=(0.0, 0.25))
    figure.align_ylabels(list(axes[:, 0]))
    panels.letter(axes[0, 0], "C", -0.16)


FIGURE = Figure("5-1", "Batteries: knots, charging, cut and discharge", runs, measure, draw)
