"""Figure 4-5: what is counted on drawings of bends, beside how they hold.

(A) Bends of the reef group as they hold, coloured by strain. (D-F) Drawings, oriented towards the pulled
ends, with the charges of their crossings and the circulation of their faces. (G) The phase diagram: tau and
Gamma for every N, coloured by friction. (H) How well each rule orders the bends. The thesis's panels B, of
ropes, and C, a sketch of torques, are not drawn.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsade.figures import bends, panels, phase, rules
from torsade.figures.base import Cell, Choice, Figure, Preset, Table
from torsade.view._extra import require
from torsade.view.diagrams import draw_diagram

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

REEF_GROUP = ("grief", "granny", "thief", "reef")
OTHERS = ("carrick13", "carrick14", "alpine13", "zeppelin14")
MEASURED = (
    *("knot", "preset", "N", "N_fewest", "tau", "Gamma", "Gamma_least", "Gamma_greatest"),
    *("c_f", "slipped_at_s"),
)


def runs(choice: Choice) -> Mapping[str, Spec]:
    """All bends."""
    return bends.specs(choice)


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Counts and friction of every bend, how well each rule orders them, and where all three are wrong."""
    table = bends.table(results, choice)
    return {
        "": table.only(*MEASURED),
        "bends": table,
        "rules": rules.rules_table(table, choice),
        "disagreements": rules.disagreements(table, choice),
    }


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    table, preset = tables["bends"], choice.presets[0]
    rows = {(str(row[0]), row[1]): dict(zip(table.columns, row, strict=True)) for row in table.rows}
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 10.9)
        top, middle, phases, ranked = figure.subfigures(4, 1, height_ratios=(1.5, 3.5, 2.9, 2.9))
        shapes = top.subplots(1, 4)
        for axes, knot in zip(shapes, REEF_GROUP, strict=True):
            panels.knot_picture(axes, results[bends.label_of(knot, preset)], (480, 320), fill=0.8)
            axes.set_title(_said(rows[knot, preset], choice, rows), loc="center", fontsize=7)
        panels.letter(shapes[0], "A")
        panels.strain_bar(top, shapes, shrink=0.8, pad=0.01, aspect=18)
        grid = middle.subplots(2, 4)
        for axes, knot in zip(grid.ravel(), (*REEF_GROUP, *OTHERS), strict=True):
            axes.axis("off")
            if (knot, preset) in rows:
                _draw_counted(axes, knot, rows[knot, preset])
        for axes, text in ((grid[0][0], "D"), (grid[1][0], "E"), (grid[1][2], "F")):
            panels.letter(axes, text)
        phase.draw(phases, table, choice)
        _draw_rules(ranked.subplots(1, 1), tables["rules"], choice)
        panels.save(figure, path)


def _said(row: Mapping[str, Cell], choice: Choice, rows: Mapping[Any, Mapping[str, Cell]]) -> str:
    """A bend's name, its friction with each preset, and how far its body turned, unless chance decides."""
    knot = str(row["knot"])
    c_f = [rows[knot, preset]["c_f"] for preset in choice.presets if (knot, preset) in rows]
    lines = [
        panels.name_of(knot),
        "$c_f$ = " + ", ".join(f"{float(str(x)):.1f}" for x in c_f if x is not None),
    ]
    if row["rotation_rad"] is not None and knot not in bends.BY_CHANCE:
        turned = round(float(str(row["rotation_rad"])), 1) + 0.0
        lines[1] += f", turns {turned:.1f} rad".replace("-", "−")
    return "\n".join(lines)


def _draw_counted(axes: Any, knot: str, row: Mapping[str, Cell]) -> None:
    """A drawing with charges and circulations, and what they add up to."""
    draw_diagram(axes, bends.drawn(knot), charges=True, circulation=True, width=1.6, size=4.6)
    axes.set_adjustable("datalim")
    axes.set_title(f"{panels.name_of(knot)}  {panels.counted(row)}", loc="center", fontsize=7)


def _draw_rules(axes: Any, table: Table, choice: Choice) -> None:
    """Rank correlation of every rule with c_f: intervals over bends (thick) and over whole knots (thin)."""
    names = [*rules.RULES, rules.ALL_THREE]
    for k, preset in enumerate(choice.presets):
        found = _of_thesis(table, preset)
        for place, rule in enumerate(names):
            if rule in found:
                y = place + 0.42 * (k - 0.5 * (len(choice.presets) - 1))
                _draw_rule(axes, found[rule], y, panels.PRESET_COLOURS[preset])
        axes.plot([], [], "o-", color=panels.PRESET_COLOURS[preset], mfc="white", ms=4, label=preset)
    axes.axvline(0, color=panels.MUTED, lw=0.7)
    axes.set_yticks(range(len(names)), [_printed(rule) for rule in names], fontsize=7)
    axes.set(xlim=(-0.75, 1.0), ylim=(len(names) - 0.5, -0.6))
    axes.set_xlabel(r"Kendall's $\tau_b$ with $c_f$; 95 % intervals over bends (thick) and over knots (thin)")
    axes.tick_params(axis="y", length=0)
    axes.legend(loc="lower left", frameon=False, fontsize=7)
    axes.annotate(
        "right : wrong pairs,\nnet over all", (1.0, 1.0), xycoords="axes fraction", xytext=(4, 3),
        textcoords="offset points", fontsize=6, va="bottom", linespacing=1.1, annotation_clip=False,
    )  # fmt: skip
    panels.letter(axes, "H", -0.22)


def _draw_rule(axes: Any, row: Mapping[str, Any], y: float, colour: str) -> None:
    """A rule's correlation and both intervals, where it has them, and its pairs at the right."""
    for low, high, width in (
        ("kendall_low_by_knot", "kendall_high_by_knot", 0.7),
        ("kendall_low", "kendall_high", 2.2),
    ):
        if row[low] is not None and row[high] is not None:
            axes.plot([row[low], row[high]], [y, y], color=colour, lw=width, alpha=0.75, zorder=2)
    if row["kendall"] is not None:
        axes.plot(row["kendall"], y, "o", ms=4, mfc="white", mec=colour, mew=1.2, zorder=3)
    said = [f"{row['pairs_right']} : {row['pairs_wrong']}"]
    said += [] if row["net"] is None else [f"{row['net']:.2f}".replace("-", "−")]
    for x, text in zip((4, 36), said, strict=False):
        axes.annotate(
            text, (1.0, y), xycoords=("axes fraction", "data"), xytext=(x, 0), textcoords="offset points",
            fontsize=5.4, color=colour, va="center", annotation_clip=False,
        )  # fmt: skip


def _of_thesis(table: Table, preset: Preset) -> dict[str, dict[str, Cell]]:
    """Rows of the thesis's bends, by rule."""
    rows = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    return {str(row["rule"]): row for row in rows if (row["preset"], row["bends"]) == (preset, "thesis")}


def _printed(rule: str) -> str:
    """A rule's name with its letters in Greek."""
    return rule.replace("tau", r"$\tau$").replace("Gamma", r"$\Gamma$").replace("Whitney, absolute", "|Wh|")


FIGURE = Figure("4-5", "Counting rules and the phase diagram of bends", runs, measure, draw)
