"""Figure 4-1: what tells knots apart in a run: the speed at which they give way, and what presses them.

(A) Speed of the pulled end against time. (B) The ranking of all bends by topological friction c_f beside
that by total compression force, the sum over all edges of the contact forces on them. (C) Strain along tight
knots in one strand, and how little of it is twist.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import bends, panels, twist_share
from torsade.figures.base import Choice, Figure, Preset, Table
from torsade.figures.ranking import agreement
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

SHOWN = {
    "grief": "#b3312c",
    "granny": "#d98c2b",
    "thief": "#8a63a6",
    "reef": "#2f6fa8",
    "alpine13": "#6b757d",
    "zeppelin14": "#3d8b78",
    "carrick14": "#262a2e",
}
"""Bends whose speed is drawn, and their colours."""

MEASURED = ("knot", "preset", "c_f", "compression_N", "pull_speed_m_per_s", "slipped_at_s")
"""What the main table tells of each bend; the table `bends` tells more."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """All bends, and the two knots of panel C."""
    return {**bends.specs(choice), **twist_share.runs(choice)}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """The bends, how far the two rankings agree, and the strain of tight knots."""
    table = bends.table(results, choice)
    return {
        "": table.only(*MEASURED),
        "bends": table,
        "rankings": rankings(table, choice),
        "twist": twist_share.table(results),
        "twist-shares": twist_share.shares(results),
    }


def rankings(table: Table, choice: Choice) -> Table:
    """Rank correlations of total compression with c_f, over bends that are not the same."""
    columns = (
        "preset",
        "bends",
        "n",
        *(f"{name}{end}" for name in ("kendall", "spearman") for end in ("", "_low", "_high")),
        "pairs_alike",
        "pairs_reversed",
    )
    rows = []
    for preset in choice.presets:
        for which, found in bends.distinct(table, preset).items():
            of = agreement(found["c_f"], found["compression_N"])
            rows.append((preset, which, of.n, *of.kendall, *of.spearman, of.right, of.wrong))
    return Table(columns, list(rows))


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    n = len(choice.presets)
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 9.3)
        upper, lower = figure.subfigures(2, 1, height_ratios=(7.2, 2.1))
        grid = upper.subplots(2, n, height_ratios=(2.6, 4.4), squeeze=False)
        seen = [_speed(axes, results, preset) for axes, preset in zip(grid[0], choice.presets, strict=True)]
        for axes in grid[0]:
            axes.set_ylim(0.8 * min(low for low, _ in seen), 1.6 * max(high for _, high in seen))
            axes.set_yticks([3, 5, 10, 20, 30, 50, 100], [3, 5, 10, 20, 30, 50, 100])
            axes.minorticks_off()
        for axes, preset in zip(grid[1], choice.presets, strict=True):
            draw_rankings(axes, tables["bends"], tables["rankings"], preset)
        panels.letter(grid[0][0], "A", -0.13)
        panels.letter(grid[1][0], "B", -0.13)
        below = lower.subplots()
        twist_share.draw_panel(below, tables["twist"])
        panels.letter(below, "C", -0.06)
        panels.save(figure, path)


def _speed(axes: Any, results: Mapping[str, Result], preset: Preset) -> tuple[float, float]:
    """Speed of some bends until they slip, named at the right; returns between what it is, once settled."""
    names: list[str] = []
    last: list[float] = []
    low, high = np.inf, 0.0
    for knot, colour in SHOWN.items():
        if bends.label_of(knot, preset) not in results:
            continue
        data = results[bends.label_of(knot, preset)].dataset
        _, end = bends.window(data)
        t, v = data["time"].values, 1e3 * data["pull_speed"].values
        held = t <= end * (1 + 1e-9)
        axes.plot(t[held], v[held], color=colour, lw=1.3)
        axes.plot(t[~held], v[~held], color=colour, lw=0.7, alpha=0.35)
        if not held.all():
            axes.plot(t[held][-1], v[held][-1], "o", ms=3.5, color=colour, mec="white", mew=0.6)
        names.append(knot)
        last.append(float(np.log10(np.nanmedian(v[held][-5:]))))
        settled = v[held][len(v[held]) // 10 + 1 :]
        low, high = min(low, float(settled.min())), max(high, float(settled.max()))
    axes.set(yscale="log", xlabel="time (s)", ylabel="speed of the pulled end (mm/s)", title=preset)
    axes.margins(x=0)
    for knot, place in zip(names, panels.spread_out(last, 0.075), strict=True):
        axes.annotate(
            panels.name_of(knot), (1.0, 10**place), xycoords=("axes fraction", "data"), xytext=(4, 0),
            textcoords="offset points", va="center", fontsize=7, color=SHOWN[knot], annotation_clip=False,
        )  # fmt: skip
    return low, high


def draw_rankings(axes: Any, table: Table, rankings: Table, preset: Preset) -> None:
    """The two rankings side by side, each bend joined with itself."""
    which, found = list(bends.distinct(table, preset).items())[-1]
    knots = found["knot"]
    sides = [_places(found[name]) for name in ("compression_N", "c_f")]
    for k, knot in enumerate(knots):
        colour = SHOWN.get(knot, panels.MUTED)
        shown = {"color": colour, "lw": 1.6 if knot in SHOWN else 0.8, "zorder": 3 if knot in SHOWN else 2}
        axes.plot([0, 1], [sides[0][k], sides[1][k]], **shown)
        weight = "bold" if knot in SHOWN else "normal"
        for x, side, name, digits in ((0, sides[0], "compression_N", 0), (1, sides[1], "c_f", 1)):
            value, word = f"{found[name][k]:.{digits}f}", panels.name_of(knot)
            text = f"{word}  {value}" if x == 0 else f"{value}  {word}"
            axes.annotate(
                text, (x, side[k]), xytext=(-4 if x == 0 else 4, 0), textcoords="offset points",
                ha="right" if x == 0 else "left", va="center", fontsize=6.2, color=colour, weight=weight,
            )  # fmt: skip
    axes.set(xlim=(-1.05, 2.05), ylim=(len(knots) - 0.3, -1.4))
    axes.axis("off")
    axes.text(-0.04, -0.9, "compression (N)", ha="right", fontsize=7)
    axes.text(1.04, -0.9, "$c_f$", ha="left", fontsize=7)
    rows = (dict(zip(rankings.columns, row, strict=True)) for row in rankings.rows)
    row = next(row for row in rows if (row["preset"], row["bends"]) == (preset, which))
    said = [
        panels.agreed(word, *(float(str(row[f"{name}{end}"])) for end in ("", "_low", "_high")))
        for word, name in ((r"Kendall $\tau_b$", "kendall"), (r"Spearman $\rho$", "spearman"))
    ]
    axes.set_title(f"{preset}, {row['n']} bends\n" + ", ".join(said), fontsize=6.5, loc="center")


def _places(values: Sequence[Any]) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Ranks from 0, the largest first."""
    return np.asarray(np.argsort(np.argsort(-np.asarray(values, np.float64), kind="stable")))


FIGURE = Figure("4-1", "Pull speed and total compression rank the bends", runs, measure, draw)
