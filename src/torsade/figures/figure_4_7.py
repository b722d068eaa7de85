"""Figure 4-7: planar diagrams of the thesis's 22 pulled bends, with what is counted and measured on each.

The drawings are those of the catalogue, whose (N, tau, Gamma) are counted; strands run towards their pulled
ends. Below each stands c_f with every preset.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsade.figures import bends, panels
from torsade.figures.base import Cell, Choice, Figure, Table
from torsade.view._extra import require
from torsade.view.diagrams import draw_diagram

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

ROWS = (
    ("reef", "thief", "granny", "grief", "carrick13", "carrick14"),
    ("bowline13", "bowline14", "bowline24", "bowline23", "ashley13", "ashley14"),
    ("hunter13", "hunter14", "hunter24", "hunter23", None, None),
    ("zeppelin13", "zeppelin14", "zeppelin23", "alpine13", "alpine24", "alpine23"),
)
"""Where each variant is drawn; the places left free hold the key."""

COUNTED = ("N", "N_fewest", "Wr", "tau", "Gamma", "Gamma_least", "Gamma_greatest", "Whitney")
MEASURED = ("c_f", "slipped_at_s")


def runs(choice: Choice) -> Mapping[str, Spec]:
    """The variants."""
    return bends.specs(choice, [knot for row in ROWS for knot in row if knot])


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """One row for each variant: what is counted, and what is measured with each preset."""
    table = bends.table(results, choice)
    by_run = {(row[0], row[1]): dict(zip(table.columns, row, strict=True)) for row in table.rows}
    columns = (
        *("knot", "pulled", *COUNTED),
        *(f"{name}_{preset}" for preset in choice.presets for name in MEASURED),
    )
    rows: list[tuple[Cell, ...]] = []
    for knot in (knot for row in ROWS for knot in row):
        found = [by_run[knot, preset] for preset in choice.presets if (knot, preset) in by_run]
        if found:
            measured = (one[name] for one in found for name in MEASURED)
            rows.append((knot, found[0]["pulled"], *(found[0][name] for name in COUNTED), *measured))
    return {"": Table(columns, rows)}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    table = tables[""]
    rows = {str(row[0]): dict(zip(table.columns, row, strict=True)) for row in table.rows}
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 7.0, layout="none")
        grid = figure.subplots(
            len(ROWS), len(ROWS[0]), gridspec_kw={
                "left": 0.01, "right": 0.99, "bottom": 0.035, "top": 0.95, "hspace": 0.42, "wspace": 0.08
            },
        )  # fmt: skip
        for axes, knot in zip(grid.ravel(), (knot for row in ROWS for knot in row), strict=True):
            axes.axis("off")
            if knot in rows:
                _draw_variant(axes, str(knot), rows[str(knot)], choice)
        _key(grid[2][4], choice)
        panels.save(figure, path)


def _draw_variant(axes: Any, knot: str, row: Mapping[str, Cell], choice: Choice) -> None:
    """A diagram, its name and counts above, c_f below."""
    draw_diagram(axes, bends.drawn(knot), width=1.5)
    axes.set_adjustable("datalim")
    axes.set_title(panels.name_of(knot), fontsize=7.5, fontweight="bold", loc="center", pad=13)
    axes.annotate(
        panels.counted(row), (0.5, 1.0), xycoords="axes fraction", xytext=(0, 3), textcoords="offset points",
        ha="center", va="bottom", fontsize=6.5, color=panels.INK,
    )  # fmt: skip
    for k, preset in enumerate(choice.presets):
        x = 0.5 + 0.26 * (k - 0.5 * (len(choice.presets) - 1)) * 1.2
        axes.annotate(
            friction(row, preset), (x, 0.0), xycoords="axes fraction", xytext=(0, -2),
            textcoords="offset points", ha="center", va="top", fontsize=7.5,
            color=panels.PRESET_COLOURS[preset],
        )  # fmt: skip


def friction(row: Mapping[str, Cell], preset: str) -> str:
    """c_f as it is printed, with a star when the bend slips."""
    c_f, slipped = row[f"c_f_{preset}"], row[f"slipped_at_s_{preset}"]
    return "-" if c_f is None else f"{float(c_f):.1f}{'' if slipped is None else '*'}"


def _key(axes: Any, choice: Choice) -> None:
    """What stands where."""
    lines = [
        ("name", panels.INK, "bold"),
        (r"$(N,\ \tau,\ \Gamma)$ of this drawing", panels.INK, "normal"),
        *((f"$c_f$, {preset}", panels.PRESET_COLOURS[preset], "normal") for preset in choice.presets),
        ("* slips", panels.INK, "normal"),
        ("arrows: towards pulled ends", panels.INK, "normal"),
    ]
    for k, (text, colour, weight) in enumerate(lines):
        axes.text(
            0.0, 0.85 - 0.15 * k, text, color=colour, weight=weight, fontsize=7.5, transform=axes.transAxes
        )


FIGURE = Figure("4-7", "Planar diagrams of all variants, with counts and friction", runs, measure, draw)
