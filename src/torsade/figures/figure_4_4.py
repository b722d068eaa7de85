"""Figure 4-4: linking number, writhe and self-torque.

Two links with what is counted on their diagrams; reef and granny, coloured by self-torque density, and with
their velocities; self-torque density beside writhe density along the granny; total self-torque against writhe
for all bends.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import bends, panels
from torsade.figures.base import Cell, Choice, Figure, Preset, Table
from torsade.figures.flow import arrows, flow
from torsade.figures.moments import coefficients, moment
from torsade.figures.proportion import Proportion, proportion
from torsade.figures.torque_writhe import Balance, balance, window
from torsade.topology.codes import from_braid
from torsade.view._extra import require
from torsade.view.diagrams import NEGATIVE, POSITIVE, STRANDS, draw_diagram
from torsade.view.scene import picture

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE", "fits", "row"]

LINKS: Mapping[str, tuple[int, ...]] = {"Hopf": (1, 1), "Whitehead": (-1, -1, 2, -1, 2)}
"""Braids whose closures are the links of the thesis's figure."""

SHOWN = ("reef", "granny")

MAIN = ("knot", "preset", "Wr", "Wr3", "Wr3_touching", "reduced_torque", "constant", "correlation")
"""The columns of the table in short; all are in the one named "bends"."""

COLUMNS = (
    *("knot", "preset", "pulled", "Wr", "Wr3", "Wr3_touching"),
    *("torque_N_m", "torque_sd_N_m", "reduced_torque", "constant", "correlation"),
    *("v_m_per_s", "v_A_m_per_s", "v_B_m_per_s", "explained", "alignment", "turning_rad_per_s"),
    *("turned_rad", "twist_rad", "from_s", "to_s"),
)
"""See `torsade.figures.torque_writhe.Balance`; v is half the parting speed."""

FITS = (
    *("preset", "against", "bends", "slope", "slope_low", "slope_high"),
    *("correlation", "correlation_low", "correlation_high"),
)
"""Reduced torque ≈ slope × a writhe; twist and rotation ≈ slope × reduced torque; with 95 % intervals."""

PROFILE = ("knot", "preset", "strand", "arclength_m", "torque_density_N", "writhe_density_per_m")

LETTERS = {
    "A": (0.015, 0.965),
    "B": (0.36, 0.965),
    "C": (0.015, 0.69),
    "D": (0.36, 0.69),
    "E": (0.015, 0.372),
}
"""Where the letters of the panels stand, in shares of the figure."""

FOLLOWS = {"twist_rad": "twist", "turned_rad": "turned"}

AGAINST = {"Wr": "writhe", "Wr3": "writhe_3", "Wr3_touching": "touching_writhe"}


def runs(choice: Choice) -> Mapping[str, Spec]:
    """All bends."""
    return dict(bends.specs(choice))


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """One row for each bend and preset; fits over all; densities along the two bends that are shown."""
    rows: list[tuple[Cell, ...]] = []
    fitted: list[tuple[Cell, ...]] = []
    profile: list[tuple[Cell, ...]] = []
    for preset in choice.presets:
        found = {knot: balance(results[bends.label_of(knot, preset)]) for knot in bends.labels(choice)}
        rows += [row(knot, preset, b, results[bends.label_of(knot, preset)]) for knot, b in found.items()]
        for name, fit in fits(found).items():
            fitted.append((preset, name, fit.n, *fit.slope, *fit.correlation))
        for knot in SHOWN:
            profile += _densities(knot, preset, results[bends.label_of(knot, preset)])
    brief = [tuple(full[COLUMNS.index(name)] for name in MAIN) for full in rows]
    return {
        "": Table(MAIN, brief),
        "bends": Table(COLUMNS, rows),
        "fits": Table(FITS, fitted),
        "profile": Table(PROFILE, profile),
    }


def row(knot: str, preset: Preset, b: Balance, result: Result) -> tuple[Cell, ...]:
    """What is known of one bend."""
    return (
        *(knot, preset, str(result.dataset.attrs["pulled"]), b.writhe, b.writhe_3, b.touching_writhe),
        *(b.torque, b.torque_spread, b.reduced_torque, b.constant, b.correlation),
        *(b.speed, *b.strand_speed, b.explained, b.alignment, b.turning),
        *(b.turned, b.twist, b.start, b.end),
    )


def fits(found: Mapping[str, Balance]) -> dict[str, Proportion]:
    """Reduced torque against each kind of writhe, and what may come of it against reduced torque.

    Of bends that are the same the first counts.
    """
    same = bends.kinds(found)
    single = {knot: b for knot, b in found.items() if same[knot] == knot}
    torque = [b.reduced_torque for b in single.values()]
    groups = [bends.family(knot) for knot in single]
    against = {
        name: proportion([getattr(b, field) for b in single.values()], torque, groups)
        for name, field in AGAINST.items()
    }
    follows = {
        name: proportion(torque, [getattr(b, field) for b in single.values()], groups)
        for name, field in FOLLOWS.items()
    }
    return against | follows


def frame_of(result: Result) -> int:
    """The frame shown: the middle one of those averaged over."""
    frames = window(result)
    return int(frames[len(frames) // 2])


def _densities(knot: str, preset: Preset, result: Result) -> list[tuple[Cell, ...]]:
    seen = moment(result, frame_of(result))
    return [
        (knot, preset, "AB"[k], *map(float, values))
        for k, x in enumerate(seen.strands)
        for values in zip(_middles(x), seen.torque[k], seen.writhe[k], strict=True)
    ]


def _middles(x: Floats) -> Floats:
    """Arclength of the middles of edges [m]."""
    l = np.linalg.norm(np.diff(x, axis=0), axis=1)
    return np.asarray(np.cumsum(l) - 0.5 * l)


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture; pictures of knots are those of the first preset."""
    shown = {knot: results[bends.label_of(knot, choice.presets[0])] for knot in SHOWN}
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 7.4, layout="none")
        for k, name in enumerate(LINKS):
            _link(figure.add_axes((0.02 + 0.155 * k, 0.775, 0.15, 0.165)), name)
        scale = max(float(np.abs(t).max()) for r in shown.values() for t in moment(r, frame_of(r)).torque)
        for k, (knot, result) in enumerate(shown.items()):
            left = 0.37 + 0.31 * k
            _torque_picture(figure.add_axes((left, 0.74, 0.29, 0.22)), knot, result, scale)
            _velocity_picture(figure.add_axes((left, 0.455, 0.29, 0.22)), result)
        _torque_bar(figure, figure.add_axes((0.56, 0.722, 0.2, 0.011)), scale)
        _profile(figure.add_axes((0.07, 0.465, 0.245, 0.21)), shown["granny"])
        for k, name in enumerate(AGAINST):
            axes = figure.add_axes((0.07 + 0.315 * k, 0.07, 0.285, 0.29))
            _scatter(axes, tables, name, choice)
            if k:
                axes.set_yticklabels([])
            else:
                axes.set_ylabel(r"self-torque $\times\ h^2/\pi v\eta_\mathrm{f}\,J$", labelpad=2)
        for text, place in LETTERS.items():
            figure.text(*place, text, fontsize=10, fontweight="bold")
        panels.save(figure, path)


def _link(axes: Any, name: str) -> None:
    """A link with the charges of its crossings."""
    diagram = from_braid(LINKS[name])
    draw_diagram(axes, diagram, charges=True, width=2.0)
    numbers = f"Lk = {diagram.linking[0, 1]:+g}, Wr = {diagram.writhe:+d}".replace("-", "−")
    axes.set_title(f"{name}\n{numbers.replace('+0', '0')}", loc="center", fontsize=7.5, y=-0.42)


def _torque_picture(axes: Any, knot: str, result: Result, scale: float) -> None:
    """A bend coloured by its self-torque density."""
    seen = moment(result, frame_of(result))
    values = [_at_nodes(torque) for torque in seen.torque]
    image = _knot(seen.strands, result, values=values, palette=lambda v: _diverging(v / scale))
    axes.imshow(image, interpolation="antialiased")
    axes.axis("off")
    total = f"{1e3 * seen.total_torque:+.2f} mN m".replace("-", "−")
    axes.set_title(f"{knot}, in all {total}", loc="center", fontsize=8)


def _velocity_picture(axes: Any, result: Result) -> None:
    """A bend with arrows along its velocities in the frame of its body."""
    found = flow(result, frame_of(result))
    image = _knot(found.strands, result, arrows=arrows(found, float(result.dataset.attrs["radius"])))
    axes.imshow(image, interpolation="antialiased")
    axes.axis("off")


def _knot(strands: list[Floats], result: Result, **options: Any) -> Floats:
    radius = float(result.dataset.attrs["radius"])
    image = picture(strands, False, radius, size=(864, 640), fill=0.76, fade=0.05, **options)
    return np.asarray(np.clip(image, 0, 1))


def _at_nodes(values: Floats) -> Floats:
    """Means at the nodes of values on the edges (n,)."""
    return np.asarray(0.5 * (np.append(values, values[-1]) + np.append(values[0], values)))


def _diverging(share: Floats) -> Floats:
    """Colour (..., 3) of a torque from -1 to 1: blue for left-handed, grey for none, red for right-handed."""
    rgb = require("matplotlib.colors").to_rgb
    stops = np.array([rgb(NEGATIVE), rgb("#7f93d6"), rgb("#dddddb"), rgb("#df8a72"), rgb(POSITIVE)])
    places = np.linspace(-1.0, 1.0, len(stops))
    return np.stack([np.interp(share, places, stops[:, c]) for c in range(3)], axis=-1)


def _torque_bar(figure: Any, axes: Any, scale: float) -> None:
    """What the colours of torque mean."""
    axes.imshow(_diverging(np.linspace(-1, 1, 256))[None], aspect="auto", extent=(-scale, scale, 0, 1))
    axes.set(yticks=[])
    axes.grid(False)
    axes.tick_params(labelsize=7, length=2, pad=1.5)
    axes.set_xlabel("self-torque density (N)", fontsize=7.5, labelpad=1)


def _profile(axes: Any, result: Result) -> None:
    """Both densities along the strands of the granny; writhe in the unit that would make it the torque."""
    seen, c = moment(result, frame_of(result)), coefficients(result)
    speed = 0.0 if seen.fit is None else float(seen.fit.speed.mean())
    factor = np.pi * speed / c.h**2 * c.eta_f_J
    for k, (x, torque) in enumerate(zip(seen.strands, seen.torque, strict=True)):
        s = _middles(x) / c.h
        touched = np.flatnonzero(torque)
        s = s - 0.5 * (s[touched[0]] + s[touched[-1]]) if len(touched) else s
        axes.plot(s, torque, color=STRANDS[k], lw=1.3, label="torque" if k == 0 else None)
        axes.plot(s, factor * seen.writhe[k], color=STRANDS[k], lw=0.9, ls=(0, (3, 1.5)))
        axes.plot(s, factor * seen.touching[k], color=STRANDS[k], lw=0.9, ls=(0, (1, 1)))
    for style, words in (("-", "torque"), ((0, (3, 1.5)), "writhe"), ((0, (1, 1)), "in contact")):
        axes.plot([], [], color=panels.INK, lw=1, ls=style, label=words)
    handles, words = axes.get_legend_handles_labels()
    axes.legend(
        handles[-3:],
        words[-3:],
        frameon=False,
        fontsize=6.5,
        loc="upper center",
        borderaxespad=0,
        ncols=3,
        handlelength=1.5,
        columnspacing=0.9,
        handletextpad=0.4,
    )
    axes.set(xlim=(-14, 14))
    axes.set_ylim(top=1.18 * axes.get_ylim()[1])
    axes.set_xlabel("arclength (radii)", labelpad=1)
    axes.set_ylabel("granny: density (N)", labelpad=2)


def _scatter(axes: Any, tables: Mapping[str, Table], name: str, choice: Choice) -> None:
    """Reduced torque of all bends against a writhe, with the fit and the law."""
    table, fitted = tables[""], tables["fits"]
    x, y, preset = (table.column(column) for column in (name, "reduced_torque", "preset"))
    reach = 1.12 * max(abs(float(v)) for v in x if isinstance(v, int | float))
    words = {"Wr": r"$Wr$ of the diagram", "Wr3": r"$Wr_3$", "Wr3_touching": r"$Wr_3$ of what touches"}
    axes.axline((0, 0), slope=1, color=panels.MUTED, lw=0.8, ls=(0, (4, 2)))
    lines = []
    for which in choice.presets:
        colour = panels.PRESET_COLOURS[which]
        mine = [k for k, p in enumerate(preset) if p == which]
        axes.plot(
            [x[k] for k in mine], [y[k] for k in mine], "o", ms=3.2, mec="none", color=colour, alpha=0.8
        )
        slope, least, most, r = next(
            np.array(row[3:7], float) for row in fitted.rows if row[0] == which and row[1] == name
        )
        axes.plot([-reach, reach], [-reach * slope, reach * slope], color=colour, lw=1)
        lines.append((f"{which}: {slope:.2f} [{least:.2f}, {most:.2f}], r = {r:.2f}", colour))
    for k, (text, colour) in enumerate(lines):
        axes.text(
            0.03,
            0.95 - 0.075 * k,
            text,
            transform=axes.transAxes,
            fontsize=6.3,
            color=colour,
            bbox={"fc": "white", "ec": "none", "pad": 0.6},
        )
    high = 1.3 * max(abs(float(v)) for v in y if isinstance(v, int | float))
    axes.set(xlim=(-reach, reach), ylim=(-high, high))
    axes.set_xlabel(words[name], labelpad=2)
    axes.text(
        0.97, 0.04, "dashed: slope 1", transform=axes.transAxes, fontsize=6.3, ha="right", color=panels.MUTED
    )
    _name_some(axes, table, name, choice.presets[0])


def _name_some(axes: Any, table: Table, name: str, preset: Preset) -> None:
    """Names beside some points of one preset."""
    for knot, which, x, y in zip(
        *(table.column(column) for column in ("knot", "preset", name, "reduced_torque")), strict=True
    ):
        if which == preset and knot in ("granny", "grief", "hunter13", "bowline13", "carrick13"):
            axes.annotate(
                panels.name_of(str(knot)), (x, y), xytext=(3, -3), textcoords="offset points", fontsize=6,
                color=panels.INK, va="top",
            )  # fmt: skip


FIGURE = Figure("4-4", "Link, writhe and self-torque", runs, measure, draw)
