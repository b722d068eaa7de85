"""Figure 4-2: strain in knots as they are pulled tight, and what Reidemeister moves cost.

(A, B) Trefoil and figure-eight at four stages, coloured by strain. (C) The measured strain colours as a path
in the CIE 1931 diagram. (D, E) Bending and stretching strain along the fiber at these stages. (F) Energy of
the moves R1, R2 and R3, made on fibers by moving their ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import move_energies, panels, tightening, twist_share
from torsade.figures.base import Choice, Figure, Table
from torsade.view._extra import require
from torsade.view.colours import PRIMARIES, STRAIN_MAX, STRAIN_TABLE, chromaticity, strain_colour

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE", "colours"]

SHOWN = ("knot", "preset", "still_at_s", "h_kappa_max", "log_strain_max", "twist_share", "twist_adds")
"""What the main table tells of each knot; the table `knots` tells more."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Both knots, as figure 4-1C has them, and all moves."""
    return twist_share.runs(choice) | move_energies.runs(choice)


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """What the knots and the moves came to, and all curves of the picture."""
    return {
        "": twist_share.shares(results).only(*SHOWN),
        "knots": twist_share.shares(results),
        "barriers": move_energies.barriers(results),
        "moves": move_energies.move_paths(results),
        "paths": tightening.paths(results),
        "profiles": tightening.profiles(results),
        "colours": colours(),
    }


def colours() -> Table:
    """The measured colours, as sRGB and as chromaticities x, y."""
    strains = np.linspace(0.0, STRAIN_MAX, len(STRAIN_TABLE))
    xy = chromaticity(STRAIN_TABLE / 255.0)
    rows: list[Any] = [
        (float(e), *map(int, rgb), float(x), float(y))
        for e, rgb, (x, y) in zip(strains, STRAIN_TABLE, xy, strict=True)
    ]
    return Table(("log_strain", "R", "G", "B", "x", "y"), rows)


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture; knots are those of the first preset."""
    preset = choice.presets[0]
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 8.4)
        rows = figure.subfigures(3, 1, height_ratios=(2.7, 2.5, 3.0), hspace=0.01)
        pictures = rows[0].subplots(2, tightening.STAGES)
        for axes, knot, letter in zip(pictures, twist_share.KNOTS, "AB", strict=True):
            tightening.draw_stages(axes, results[twist_share.label_of(knot, preset)])
            panels.letter(axes[0], letter, -0.02)
            axes[0].set_title(f"  {knot}", fontsize=8)
        panels.strain_bar(rows[0], pictures, shrink=0.55, aspect=24, pad=0.02)
        colour, *profiles = rows[1].subfigures(1, 3, width_ratios=(1.0, 1.15, 1.15))
        _draw_colours(colour)
        for part, knot, letter in zip(profiles, twist_share.KNOTS, "DE", strict=True):
            above, below = part.subplots(2, 1, sharex=True)
            tightening.draw_profiles(above, below, tables["profiles"], knot, preset)
            panels.letter(above, letter, -0.2)
            above.set_title(knot, fontsize=8)
        _draw_moves(rows[2], results)
        panels.save(figure, path)


def _draw_colours(part: Any) -> None:
    """Panel C: the path of the strain colours, with the triangle of all that sRGB can show."""
    axes = part.subplots()
    corners = np.array([*PRIMARIES, PRIMARIES[0]])
    axes.plot(*corners.T, color=panels.MUTED, linewidth=0.7)
    axes.plot(0.3127, 0.3290, "+", color=panels.MUTED, markersize=5)
    strains = np.linspace(0.0, STRAIN_MAX, 281)
    axes.plot(*chromaticity(strain_colour(strains)).T, color=panels.INK, linewidth=0.6)
    measured = np.linspace(0.0, STRAIN_MAX, len(STRAIN_TABLE))
    rgb = strain_colour(measured)
    xy = chromaticity(rgb)
    axes.scatter(*xy.T, c=rgb, s=22, edgecolors=panels.INK, linewidths=0.4, zorder=3)
    for k, place in ((0, (-4, -9)), (7, (4, 3)), (10, (4, 3)), (14, (-5, 0))):
        ha = "right" if place[0] < 0 else "left"
        axes.annotate(
            f"{measured[k]:.2f}", xy[k], xytext=place, textcoords="offset points", fontsize=6.5, ha=ha
        )
    axes.set(xlabel="x", ylabel="y", xlim=(0.1, 0.7), ylim=(0.0, 0.68), aspect="equal")
    panels.letter(axes, "C", -0.2)
    axes.set_title("strain colours, CIE 1931", fontsize=8)


def _draw_moves(row: Any, results: Mapping[str, Result]) -> None:
    """Panel F: pictures of each move before and after it, above its energy path."""
    grid = row.subplots(2, 6, height_ratios=(1.0, 1.9), gridspec_kw={"wspace": 0.02})
    shown = {"R1": "R1, gripped", "R2": "R2", "R3": "R3"}
    for k, (move, name) in enumerate(shown.items()):
        move_energies.draw_shapes(grid[0, 2 * k], grid[0, 2 * k + 1], results[move_energies.label_of(name)])
        spec = grid[1, 2 * k].get_gridspec()
        for axes in grid[1, 2 * k : 2 * k + 2]:
            axes.remove()
        axes = row.add_subplot(spec[1, 2 * k : 2 * k + 2])
        move_energies.draw_move(axes, results, move)
        axes.set_title(move, fontsize=8)
        if k == 0:
            panels.letter(grid[0, 0], "F", -0.02)


FIGURE = Figure(
    "4-2", "Strain in knots as they are pulled tight; energies of Reidemeister moves", runs, measure, draw
)
