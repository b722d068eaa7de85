"""Figure 5-2: batteries charged with twist.

(A) A trefoil and a figure-eight at rest, twisted either way, coloured by their energy. (B) Energy density
along the trefoil at either twist, from where it is largest on.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from torsade.arrays import Floats
from torsade.figures import panels
from torsade.figures.base import Choice, Figure, Table
from torsade.figures.battery_map import KINDS, label
from torsade.protocols.battery import Battery, even_twist_energy
from torsade.view._extra import require
from torsade.view.battery import density_bar, density_colour, density_unit
from torsade.view.scene import picture

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

KNOTS = ("3_1", "4_1")
TWISTS = (-2.0, -1.0, 0.0, 1.0, 2.0)
"""Twist densities h theta' at the start."""

ALONG = {-2.0: "#c9543f", 2.0: "#2f6fa8"}
"""Of the profiles of panel B, and their colours."""


def runs(choice: Choice) -> Mapping[str, Spec]:
    """Batteries that are charged and not cut."""
    # With twice the nodes of other batteries fewer shapes are held that are not stable.
    options = {"nodes": 60, "charging": "0.3 s"} if choice.quick else {"nodes": 200}
    return {
        label(knot, twist): Battery(knot=knot, twist=twist, stop="charged", **options)
        for knot in KNOTS
        for twist in TWISTS
    }


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """Energies, twist and writhe of every battery, and the profiles of panel B."""
    columns = ("knot", "twist_density", "Lk", "Tw", "Wr", *(f"{kind}_E0" for kind in KINDS), "energy_E0")
    rows = []
    for knot in KNOTS:
        for twist in TWISTS:
            attrs = results[label(knot, twist)].dataset.attrs
            energies = attrs["energy_E0"]
            turns = (attrs[name] for name in ("link", "twist", "writhe"))
            rows.append((knot, twist, *turns, *(energies[kind] for kind in KINDS), energies["total"]))
    profiles = {twist: _density(results[label("3_1", twist)]) for twist in ALONG}
    places = np.arange(len(profiles[2.0])) / len(profiles[2.0])
    heads = ("s_over_L", *(f"density_at_{twist:+g}_Eb_h2" for twist in ALONG))
    shifted = [np.roll(values, -int(np.argmax(values))) for values in profiles.values()]
    along = [tuple(float(c) for c in row) for row in zip(places, *shifted, strict=True)]
    return {"": Table(columns, list(rows)), "density": Table(heads, list(along))}


def _density(result: Result) -> Floats:
    """Energy per rest length along a charged battery [E_b h²], shape (n_nodes,)."""
    data = result.dataset
    return np.asarray(data["charge_energy_density"].values[-1], np.float64) / density_unit(data)


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture."""
    top = max(float(np.quantile(_density(result), 0.98)) for result in results.values())
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.4, 4.9)
        upper, lower = figure.subfigures(2, 1, height_ratios=(3.2, 1.7))
        axes = upper.subplots(len(KNOTS), len(TWISTS))
        for row, knot in zip(axes, KNOTS, strict=True):
            for axis, twist in zip(row, TWISTS, strict=True):
                result = results[label(knot, twist)]
                x = np.asarray(result.dataset["charge_position"].values[-1], np.float64)
                image = picture(
                    [x], True, float(result.dataset.attrs["radius"]), values=[_density(result) / top],
                    size=(560, 480), palette=density_colour, bar=False, fill=0.86, whole=True,
                )  # fmt: skip
                axis.imshow(image, interpolation="antialiased")
                axis.axis("off")
                if knot == KNOTS[0]:
                    axis.set_title(rf"$h\theta' = {twist:g}$", loc="center", fontsize=8)
        density_bar(upper, list(axes.ravel()), top, shrink=0.6, pad=0.01)
        panels.letter(axes[0][0], "A")
        below = lower.subplots()
        s = np.asarray(tables["density"].column("s_over_L"), np.float64)
        for twist, colour in ALONG.items():
            values = tables["density"].column(f"density_at_{twist:+g}_Eb_h2")
            below.plot(s, np.asarray(values, np.float64), color=colour, label=rf"$h\theta' = {twist:+g}$")
        even = even_twist_energy(max(TWISTS), Battery(knot="3_1").fiber_material.nu)
        below.axhline(even, color=panels.MUTED, linewidth=0.8, linestyle=(0, (4, 2)), label="even twist")
        below.set(xlabel="s/L, from the largest on", ylabel=r"energy per length ($E_b h^2$)")
        below.margins(x=0.0)
        below.set_ylim(bottom=0.0)
        below.legend(frameon=False, ncols=3, fontsize=7, loc="lower right")
        panels.letter(below, "B", -0.07)
        panels.save(figure, path)


FIGURE = Figure("5-2", "Batteries charged with twist", runs, measure, draw)
