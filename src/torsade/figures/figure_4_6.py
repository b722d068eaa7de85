"""Figure 4-6: the Whitney index of pulled bends.

Every crossing is smoothed along the strands, which run towards their pulled ends; the index is the sum of the
senses of the loops that are left, counterclockwise +1. It tells the reef from the thief, as Gamma does.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsade.figures import bends, panels
from torsade.figures.base import Choice, Figure, Table
from torsade.topology.seifert import turning
from torsade.view._extra import require
from torsade.view.diagrams import draw_diagram

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

ROWS = (
    ("reef", "thief", "granny", "grief", "carrick13", "carrick14"),
    ("bowline13", "bowline14", "zeppelin14", "alpine13", "hunter14", "ashley14"),
)


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Nothing: all is counted."""
    return {}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """The index of every bend, and the loops that it is the sum of."""
    columns = ("knot", "Whitney", "loops", "counterclockwise", "clockwise", "N", "Gamma")
    rows = []
    for knot in bends.labels(choice):
        counted, diagram = bends.counts(knot), bends.drawn(knot)
        senses = [turning(diagram, loop) for loop in diagram.seifert_circles]
        loops = (counted.loops, senses.count(1), senses.count(-1))
        rows.append((knot, counted.whitney, *loops, counted.crossings, counted.gamma))
    return {"": Table(columns, list(rows))}


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture: diagrams, and below each what is left of it when crossings are smoothed."""
    index = dict(zip(tables[""].column("knot"), tables[""].column("Whitney"), strict=True))
    rows = [[knot for knot in row if knot in index] for row in ROWS]
    rows = [row for row in rows if row]
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 2.85 * len(rows), layout="none")
        grid = figure.subplots(2 * len(rows), len(ROWS[0]), squeeze=False, gridspec_kw=_room(len(rows)))
        for axes in grid.ravel():
            axes.axis("off")
        for k, row in enumerate(rows):
            for upper, lower, knot in zip(grid[2 * k], grid[2 * k + 1], row, strict=False):
                _draw_bend(upper, lower, knot, int(str(index[knot])))
        panels.save(figure, path)


def _room(n: int) -> dict[str, float]:
    """Where panels are, for n rows of bends."""
    return {
        "left": 0.01,
        "right": 0.99,
        "bottom": 0.06 / n,
        "top": 1 - 0.09 / n,
        "hspace": 0.16,
        "wspace": 0.08,
    }


def _draw_bend(upper: Any, lower: Any, knot: str, index: int) -> None:
    """A diagram, and its loops with their senses."""
    for axes, smoothed in ((upper, False), (lower, True)):
        draw_diagram(axes, bends.drawn(knot), smoothed=smoothed, width=1.4, size=5.0)
        axes.set_adjustable("datalim")
    upper.set_title(panels.name_of(knot), fontsize=7.5, fontweight="bold", loc="center", pad=3)
    sign = f"{index:+d}".replace("-", "−") if index else "0"
    lower.set_title(f"Wh = {sign}", fontsize=7.5, loc="center", pad=1)


FIGURE = Figure("4-6", "The Whitney index of pulled bends", runs, measure, draw)
