"""Figure 4-3: velocities and twist charges in a knot of one strand and in a bend.

A trefoil pulled at both ends gives in from both sides, so its velocity turns round about the middle of the
fiber and no orientation of the strand agrees with it. In a bend each strand slides one way, towards its
gripped end: that orients the diagram, and gives each crossing a charge.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.figures import bends, panels
from torsade.figures.base import Cell, Choice, Figure, Preset, Table
from torsade.figures.flow import Flow, arrows, flow
from torsade.figures.moments import moment, orientation
from torsade.figures.torque_writhe import UNTIL
from torsade.knots.finding import find
from torsade.observables import SETTLED
from torsade.protocols.tighten import Tighten
from torsade.view._extra import require
from torsade.view.diagrams import NEGATIVE, POSITIVE, STRANDS, draw_crossing, draw_diagram
from torsade.view.scene import picture

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["FIGURE"]

TREFOIL, BEND = "overhand", "reef"
FORCE = 15.0  # on the trefoil, as on the reef [N]
TIGHTENING = 5e-3  # when the trefoil is shown: it is tight by 0.1 s [s]

COLUMNS = (
    "knot",
    "preset",
    "strand",
    "mean_v_m_per_s",
    "least_v_m_per_s",
    "greatest_v_m_per_s",
    "alignment",
    "reversals",
    "reversed_at",
)
"""v is v . t over the body of the knot, in the frame of its centre, t as the strand is oriented; alignment is
the mean cosine; reversed_at the share of the length at which v changes its sign, if it does so once."""

PROFILE = ("knot", "preset", "strand", "arclength_m", "v_m_per_s", "alignment")


def runs(choice: Choice) -> Mapping[str, Spec]:
    """The trefoil, pulled at both ends as hard as bends are, and the reef."""
    brief = {"duration": 2 * TIGHTENING, "frames": 2} if choice.quick else {"duration": 0.1, "frames": 100}
    trefoils: dict[str, Spec] = {
        bends.label_of(TREFOIL, preset): Tighten(
            knot=TREFOIL, material="nylon", force=FORCE, preset=preset, **brief
        )
        for preset in choice.presets
    }
    return trefoils | bends.specs(choice, [BEND])


def frame_of(result: Result) -> int:
    """The frame shown: of a bend in the middle of the time averaged over, or the last of a shorter run."""
    time = result.dataset["time"].values
    wanted = TIGHTENING if result.protocol == "tighten" else 0.5 * (SETTLED + UNTIL)
    return min(int(np.searchsorted(time, wanted * (1 - 1e-9))), result.last_held)


def signs_of(result: Result) -> list[int]:
    """Orientation of the strands: towards gripped ends in a bend; a single strand keeps its own."""
    return orientation(result) if "pulled" in result.dataset.attrs else [1]


def measure(results: Mapping[str, Result], choice: Choice) -> Mapping[str, Table]:
    """One row for each strand, and its profile in another table."""
    rows: list[tuple[Cell, ...]] = []
    profile: list[tuple[Cell, ...]] = []
    for preset in choice.presets:
        for knot in (TREFOIL, BEND):
            result = results[bends.label_of(knot, preset)]
            frame = frame_of(result)
            found = flow(result, frame)
            for k, sign in enumerate(signs_of(result)):
                name = (knot, preset, "AB"[k])
                rows.append((*name, *_summary(found, k, sign)))
                values = (found.along[k], sign * found.sliding[k], sign * found.alignment[k])
                profile += [(*name, *map(float, row)) for row in zip(*values, strict=True)]
    return {"": Table(COLUMNS, rows), "profile": Table(PROFILE, profile)}


def _summary(found: Flow, k: int, sign: int) -> tuple[Cell, ...]:
    """Speeds along a strand's body, mean alignment, and where the speed changes its sign."""
    body = slice(*found.body[k])
    speed, along = sign * found.sliding[k][body], found.along[k][body]
    weight = np.gradient(along)
    weight = weight / weight.sum()
    turn = np.flatnonzero(speed[1:] * speed[:-1] < 0)
    place = None
    if len(turn) == 1:
        i = int(turn[0])
        at = along[i] + (along[i + 1] - along[i]) * speed[i] / (speed[i] - speed[i + 1])
        place = float(at / found.along[k][-1])
    cosine = float(weight @ (sign * found.alignment[k][body]))
    return (float(weight @ speed), float(speed.min()), float(speed.max()), cosine, len(turn), place)


def draw(results: Mapping[str, Result], tables: Mapping[str, Table], choice: Choice, path: Path) -> None:
    """Write the picture, of the first preset."""
    preset = choice.presets[0]
    with require("matplotlib").rc_context(panels.STYLE):
        figure = panels.new_figure(7.2, 5.5, layout="none")
        grid = figure.subplots(
            3, 3, gridspec_kw={
                "left": 0.07, "right": 0.985, "bottom": 0.085, "top": 0.955, "hspace": 0.14, "wspace": 0.18,
                "height_ratios": (1.3, 1.0, 0.9),
            },
        )  # fmt: skip
        for column, (knot, words) in enumerate(((TREFOIL, "trefoil, both ends pulled"), (BEND, "reef bend"))):
            result = results[bends.label_of(knot, preset)]
            _picture(grid[0][column], result)
            _head(figure, grid[0][column], "AB"[column], words)
            _profile(grid[2][column], result)
        draw_diagram(grid[1][0], find(TREFOIL).diagram, colours=(panels.MUTED,), width=2.0)
        draw_diagram(grid[1][1], bends.drawn(BEND), charges=True, width=2.0)
        grid[2][0].set_ylabel(r"$\mathbf{v}\cdot\mathbf{t}$ (mm/s)")
        _crossings(grid[0][2])
        _total(grid[1][2], preset)
        _torque(grid[2][2], results[bends.label_of(BEND, preset)])
        _head(figure, grid[0][2], "C", "charge of a crossing")
        panels.save(figure, path)


def _head(figure: Any, axes: Any, letter: str, words: str) -> None:
    """The letter and the title of a column, at one height whatever the shape of its axes."""
    box = axes.get_gridspec()[axes.get_subplotspec().num1].get_position(figure)
    figure.text(box.x0 - 0.035, 0.972, letter, fontsize=10, fontweight="bold", va="center")
    figure.text(0.5 * (box.x0 + box.x1), 0.972, words, fontsize=8.5, ha="center", va="center")


def _picture(axes: Any, result: Result) -> None:
    """The knot with arrows along its velocities."""
    radius = float(result.dataset.attrs["radius"])
    found = flow(result, frame_of(result))
    options: dict[str, Any] = {"size": (960, 720), "fill": 0.74, "fade": 0.05}
    image = picture(found.strands, False, radius, arrows=arrows(found, radius), **options)
    axes.imshow(np.clip(image, 0, 1), interpolation="antialiased")
    axes.axis("off")


def _profile(axes: Any, result: Result) -> None:
    """Speed along the strands; the body of the knot is drawn strongly."""
    found, radius = flow(result, frame_of(result)), float(result.dataset.attrs["radius"])
    for k, sign in enumerate(signs_of(result)):
        s, v = found.along[k] / radius, 1e3 * sign * found.sliding[k]
        body = slice(*found.body[k])
        middle = s[-1] / 2 if len(found.strands) == 1 else 0.5 * (s[body][0] + s[body][-1])
        order = slice(None, None, sign)
        axes.plot(sign * (s - middle)[order], v[order], color=STRANDS[k], lw=0.8, alpha=0.45)
        axes.plot(sign * (s - middle)[body], v[body], color=STRANDS[k], lw=1.8, label=f"strand {'AB'[k]}")
    axes.axhline(0.0, color=panels.INK, lw=0.6)
    axes.set_xlabel("arclength from the middle (radii)")
    if len(found.strands) > 1:
        axes.legend(frameon=False, fontsize=7, loc="lower center", ncols=2)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.set_xlim(-40, 40)


def _crossings(axes: Any) -> None:
    """The two kinds of crossings with their charges."""
    axes.set(aspect="equal", xlim=(-2.9, 2.9), ylim=(-2.05, 2.0))
    axes.axis("off")
    for x, sign in ((-1.45, 1), (1.45, -1)):
        draw_crossing(axes, sign, at=x + 0.25j, width=2.4)
        colour, word = (POSITIVE, "right") if sign > 0 else (NEGATIVE, "left")
        half = "½".join(("+" if sign > 0 else "−",) * 2 + ("",))
        axes.text(x, -1.25, f"{half} = {'+' if sign > 0 else '−'}1", ha="center", color=colour, fontsize=9)
        axes.text(x, -1.8, f"{word}-handed", ha="center", color=colour, fontsize=7.5)


def _total(axes: Any, preset: Preset) -> None:
    """Charges of some bends, summed up."""
    axes.axis("off")
    axes.set_title(r"$Wr=\sum_i q_i$", loc="center", fontsize=8.5, y=0.86)
    for k, knot in enumerate(("reef", "thief", "granny", "grief")):
        charges = bends.counts(knot).charges
        y = 0.7 - 0.19 * k
        axes.text(0.02, y, knot, transform=axes.transAxes, fontsize=8, va="center")
        for i, q in enumerate(sorted(charges, reverse=True)):
            axes.text(
                0.31 + 0.085 * i, y, "+" if q > 0 else "−", transform=axes.transAxes, ha="center",
                va="center", color="white", fontsize=7,
                bbox={"boxstyle": "circle,pad=0.12", "fc": POSITIVE if q > 0 else NEGATIVE, "ec": "none"},
            )  # fmt: skip
        total = f"{sum(charges):+d}" if sum(charges) else "0"
        axes.text(
            0.99, y, total.replace("-", "−"), transform=axes.transAxes, ha="right", va="center", fontsize=8
        )


def _torque(axes: Any, result: Result) -> None:
    """Self-torque density along the strands of the bend."""
    seen, radius = moment(result, frame_of(result)), float(result.dataset.attrs["radius"])
    for k, (x, torque) in enumerate(zip(seen.strands, seen.torque, strict=True)):
        s = np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1)) / radius
        touched = np.flatnonzero(torque)
        middle = 0.5 * (s[touched[0]] + s[touched[-1]]) if len(touched) else 0.5 * s[-1]
        axes.plot(s - middle, torque, color=STRANDS[k], lw=1.2)
    axes.axhline(0.0, color=panels.INK, lw=0.6)
    axes.set_xlim(-20, 20)
    axes.set_xlabel("arclength from the middle (radii)")
    axes.set_title("reef: self-torque density (N)", fontsize=7.5, loc="center", y=0.97)


FIGURE = Figure("4-3", "Velocities and twist charges in a trefoil and in a bend", runs, measure, draw)
