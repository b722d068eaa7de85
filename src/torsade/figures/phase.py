"""The phase diagram of bends: twist fluctuation tau and circulation Gamma for every N, and friction."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import bends, panels
from torsade.figures.base import Choice, Table
from torsade.view._extra import require

__all__ = ["draw"]

PANELS = ((6,), (7,), (8,), (10, 12), (16, 18))
"""Crossing numbers that share a panel."""

TICKS = (1.0, 0.97, 0.89, 0.75, 0.5, 0.0)
BESIDE = 0.3
"""How far apart bends with the same three numbers are drawn, in units of Gamma."""


def draw(figure: Any, table: Table, choice: Choice) -> None:
    """Draw on a figure one panel for each few N; the halves of a marker are the presets.

    The height is sqrt(1 - tau) = |Wr|/N, so that small differences near tau = 1 are seen.
    """
    rows = _rows(table, choice)
    shown = [numbers for numbers in PANELS if any(row["N"] in numbers for row in rows)]
    reach = [_reach([row["Gamma"] for row in rows if row["N"] in numbers]) for numbers in shown]
    axes = figure.subplots(
        1, len(shown), sharey=True, squeeze=False, width_ratios=[high - low for low, high in reach]
    )[0]
    c_f = [row["c_f"][preset] for row in rows for preset in choice.presets if preset in row["c_f"]]
    norm = require("matplotlib.colors").LogNorm(min(c_f), max(c_f))
    colours = require("matplotlib").colormaps["viridis"]
    for one, numbers, (low, high) in zip(axes, shown, reach, strict=True):
        one.set_yscale("function", functions=(_height, _tau_of))
        one.set(xlim=(low, high), ylim=(-0.12, 1.045))
        one.set_title("N = " + ", ".join(map(str, numbers)), loc="center", fontsize=7.5)
        one.xaxis.set_major_locator(require("matplotlib.ticker").MultipleLocator(1))
        groups = _together([row for row in rows if row["N"] in numbers])
        for k, group in enumerate(groups):
            above = [other for other in groups if other[0]["tau"] > group[0]["tau"] + 1e-9]
            crowded = any(_near(other[0], group[0], 1.3, 0.25) for other in above)
            crowded |= any(_near(other[0], group[0], 1.3, 0.1) for other in groups[:k])
            _draw_group(one, group, choice, lambda value: colours(norm(value)), below=crowded)
    axes[0].set_yticks(TICKS, [f"{t:g}" for t in TICKS])
    axes[0].set_ylabel(r"$\tau$")
    figure.supxlabel(r"$\Gamma$", fontsize=8)
    bar = figure.colorbar(
        require("matplotlib.cm").ScalarMappable(norm, colours), ax=list(axes), pad=0.01, aspect=25
    )
    ticks = [t for t in (15, 20, 30, 50, 80, 120) if min(c_f) <= t <= max(c_f)]
    bar.set_ticks(ticks, labels=[str(t) for t in ticks])
    bar.minorticks_off()
    bar.outline.set_visible(False)
    halves = f" (left {choice.presets[0]}, right {choice.presets[1]})" if len(choice.presets) == 2 else ""
    bar.set_label(f"$c_f${halves}", fontsize=7)
    panels.letter(axes[0], "G", -0.16)


def _height(tau: Floats) -> Floats:
    """|Wr|/N with its sign turned, so that tau = 1 is on top; beyond 0 and 1 it goes on evenly."""
    x = 1 - np.asarray(tau, np.float64)
    return np.asarray(-np.sign(x) * np.sqrt(abs(x)))


def _tau_of(height: Floats) -> Floats:
    """The inverse of `_height`."""
    y = -np.asarray(height, np.float64)
    return np.asarray(1 - np.sign(y) * y**2)


def _rows(table: Table, choice: Choice) -> list[dict[str, Any]]:
    """One row for each bend: N, tau, Gamma, and c_f and whether it holds by preset; no bend twice."""
    found: dict[str, dict[str, Any]] = {}
    for preset in choice.presets:
        of = list(bends.distinct(table, preset).values())[-1]
        for k, knot in enumerate(of["knot"]):
            counted = {name: of[name][k] for name in ("N", "tau", "Gamma")}
            row = found.setdefault(knot, {"knot": knot, **counted, "c_f": {}})
            row["c_f"][preset] = of["c_f"][k]
    return list(found.values())


def _reach(gamma: list[float]) -> tuple[float, float]:
    """From where to where Gamma is shown."""
    return min(gamma) - 0.8, max(gamma) + 0.8


def _together(rows: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Bends whose markers would cover each other, in groups; groups by Gamma, bends in each too."""
    groups: list[list[dict[str, Any]]] = []
    for row in sorted(rows, key=lambda row: (row["Gamma"], row["knot"])):
        near = (group for group in groups if _near(group[0], row, BESIDE, 0.08))
        group = next(near, None)
        if group is None:
            groups.append([row])
        else:
            group.append(row)
    return groups


def _near(one: Mapping[str, Any], other: Mapping[str, Any], gamma: float, height: float) -> bool:
    """Whether two bends are drawn so near each other."""
    apart = np.diff(_height(np.array([one["tau"], other["tau"]])))
    return bool(abs(one["Gamma"] - other["Gamma"]) < gamma and abs(apart[0]) < height)


def _draw_group(axes: Any, group: list[dict[str, Any]], choice: Choice, colour: Any, below: bool) -> None:
    """Bends beside each other about where they belong; names, from top to bottom, as from left to right."""
    middle = float(np.mean([row["Gamma"] for row in group]))
    places = middle + BESIDE * (np.arange(len(group)) - 0.5 * (len(group) - 1))
    for x, row in zip(places, group, strict=True):
        left, right = (row["c_f"].get(preset) for preset in (choice.presets[0], choice.presets[-1]))
        face: Mapping[str, Any] = {
            "markerfacecolor": "white" if left is None else colour(left),
            "markerfacecoloralt": "white" if right is None else colour(right),
        }
        axes.plot(
            x, row["tau"], "o", ms=9, mec=panels.INK, mew=0.5, fillstyle="left", zorder=3, clip_on=False,
            **face,
        )  # fmt: skip
    names = "\n".join(textwrap.fill(panels.name_of(row["knot"]), 12) for row in group)
    tau = min(row["tau"] for row in group) if below else max(row["tau"] for row in group)
    axes.annotate(
        names, (middle, tau), xytext=(0, -6.5 if below else 6.5), textcoords="offset points", ha="center",
        va="top" if below else "bottom", fontsize=5.8, color=panels.INK, linespacing=0.95,
        annotation_clip=False, zorder=4,
    )  # fmt: skip
