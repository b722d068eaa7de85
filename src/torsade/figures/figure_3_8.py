"""Figure 3-8: breaking by twist and by quench in rods of other dimensions, 20 cm long and 1.7 mm thick.

Panels A, B and E. Panels C and D are distributions measured at two humidities, which the model does not have;
`torsade trials` makes such tables of measurements.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from torsade.figures import breaking, panels, quench
from torsade.figures.base import Choice, Figure, Table
from torsade.figures.figure_3_4 import DEGREES, draw_sectors, draw_trials
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

TWISTS = tuple(0.6 * degree for degree in DEGREES)
"""As far below the twist that breaks them as those of the longer rods."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Trials with twist, and quenches of both sets."""
    degrees, seeds = (TWISTS[::4], 1) if choice.quick else (TWISTS, 5)
    twisted = breaking.twist_trials(2, degrees, range(1, seeds + 1))
    return {**twisted, **quench.runs(1, choice), **quench.runs(2, choice)}


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Averages over sectors, every trial, and breaks against speed for both sets."""
    trials = breaking.trial_table(r for label, r in results.items() if label.startswith("twist-2"))
    return {
        "": breaking.sector_table(trials, breaking.RODS[2]),
        "trials": trials,
        "speeds-1": quench.speed_table(results, 1),
        "speeds-2": quench.speed_table(results, 2),
    }


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 5.4)
        grid = figure.subplot_mosaic("AB;EE", height_ratios=(1.0, 0.8))
        draw_trials(grid["A"], tables["trials"], 2)
        draw_sectors(grid["B"], tables[""], 2)
        for which, colour in ((1, "#2f6fa8"), (2, "#b5475c")):
            rod = breaking.RODS[which]
            label = f"{100 * rod.L:.0f} cm, {2e3 * rod.h:.1f} mm"
            quench.draw_breaks(grid["E"], tables[f"speeds-{which}"], colour, label)
        grid["E"].legend(frameon=False, fontsize=6.5, loc="upper left")
        grid["E"].set_ylim(0, None)
        for mark, axes in grid.items():
            panels.letter(axes, mark, -0.06 if mark == "E" else -0.14)
        panels.save(figure, path)


FIGURE = Figure("3-8", "Breaking of thicker, shorter rods by twist and by quench", runs, measure, draw)
