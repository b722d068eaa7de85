"""A fracture cascade: pieces at some moments, and a map of stress over place and time with its breaks."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.fracture.criteria import matching_strength
from torsade.view._extra import require
from torsade.view.colours import DISTINCT, STRAND_COLOURS
from torsade.view.plots import INK, SLIP, STYLE, save
from torsade.view.strands import strands_at

if TYPE_CHECKING:
    import xarray

__all__ = ["along_rod", "draw_pieces", "pieces_at", "plot_cascade"]

Floats = NDArray[np.float64]

BEFORE = 0.15
"""How long before the first break the map begins, as a share of the time after it."""


MOMENTS = 4
"""Moments that a picture shows."""

THICKER = 3.0
"""How much thicker than to scale the rod is drawn, as in the thesis."""


def pieces_at(dataset: xarray.Dataset, frame: int) -> list[Floats]:
    """Nodes (n, 3) [m] of every piece at a recorded frame, from end 0 of the rod to end 1."""
    _require(dataset, "position")
    return [piece.x for piece in strands_at(dataset, frame)]


def along_rod(dataset: xarray.Dataset, name: str) -> tuple[Floats, Floats]:
    """A recorded quantity of nodes by place along the whole rod, whatever pieces it is in.

    Parameters
    ----------
    dataset : of a protocol that breaks a rod: `piece_start (time, piece_bound)`, the attribute `spec`
    name : of a variable (time, node), such as `stress`

    Returns
    -------
    Places [m], shape (n_nodes,), and values, shape (n_frames, n_nodes): the larger one of both sides of a
    break.
    """
    _require(dataset, name)
    spec = json.loads(dataset.attrs["spec"])
    nodes = int(spec["edges"]) + 1
    values, starts = np.asarray(dataset[name], float), np.asarray(dataset["piece_start"], int)
    out = np.zeros((len(values), nodes))
    for frame, (row, start) in enumerate(zip(values, starts, strict=True)):
        for piece, (first, last) in enumerate(pairwise(start)):
            place = slice(first - piece, last - piece)  # every break made one node two
            out[frame, place] = np.maximum(out[frame, place], row[first:last])
    return np.linspace(0.0, float(spec["length"]), nodes), out


def plot_cascade(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot stress over place and time, from just before the first break on, and where the rod breaks.

    Parameters
    ----------
    dataset : of snap-twist or snap-quench
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    place, stress = along_rod(dataset, "stress")
    spec, attrs = json.loads(dataset.attrs["spec"]), dataset.attrs
    strength = matching_strength(spec["sigma_c"], spec["criterion"])
    time = np.asarray(dataset["time"], float)
    times, places = (np.asarray(attrs[f"break_{what}"], float) for what in ("times_s", "places_m"))
    begin = float(times[0]) if len(times) else 0.0
    end = float(time[-1])
    shown = time >= begin - BEFORE * (end - begin) if len(times) else time >= 0.0
    with require("matplotlib").rc_context(STYLE):
        figure = require("matplotlib.figure").Figure(figsize=(4.5, 3.2), layout="constrained")
        axis = figure.subplots()
        mesh = axis.pcolormesh(
            1e3 * place,
            1e3 * (time[shown] - begin),
            stress[shown] / strength,
            cmap="Blues",
            vmin=0.0,
            shading="nearest",
            rasterized=True,
        )
        for x, t in zip(places, times, strict=True):
            axis.plot([1e3 * x] * 2, [1e3 * (t - begin), 1e3 * (end - begin)], color=INK, linewidth=1.0)
        axis.plot(1e3 * places, 1e3 * (times - begin), "o", color=SLIP, markersize=4.0, markeredgewidth=0.0)
        axis.set_xlim(0.0, 1e3 * place[-1])
        axis.set_xlabel("place along the rod (mm)")
        axis.set_ylabel("time since the first break (ms)" if len(times) else "time (ms)")
        axis.grid(False)
        bar = figure.colorbar(mesh, ax=axis, pad=0.02)
        bar.set_label("stress / strength")
        bar.outline.set_linewidth(0.7)
        axis.set_title(_title(spec, attrs["fragments"]))
        return save(figure, path)


def draw_pieces(dataset: xarray.Dataset, path: str | Path, frame: int | None = None) -> Path:
    """Draw the rod from the first break to the end, one moment above the other, seen across its plane.

    Parameters
    ----------
    dataset : of snap-twist or snap-quench
    path : the PNG file to write
    frame : draw this frame alone
    """
    _require(dataset, "position")
    time = np.asarray(dataset["time"], float)
    times = dataset.attrs.get("break_times_s", [])  # a run that was interrupted has none
    begin = float(times[0]) if len(times) else float(time[0])
    if frame is None:
        wanted = np.linspace(begin, float(time[-1]), MOMENTS)
        frames = [int(np.searchsorted(time, t * (1 - 1e-9)).clip(max=len(time) - 1)) for t in wanted]
    else:
        frames = [frame]
    shapes = [[1e3 * x for x in pieces_at(dataset, k)] for k in frames]
    notes = [f"{1e3 * (time[k] - begin):.2f} ms" for k in frames]
    return _draw_moments(shapes, notes, 2e3 * float(dataset.attrs["radius"]) * THICKER, path)


def _draw_moments(shapes: list[list[Floats]], notes: list[str], thick: float, path: str | Path) -> Path:
    """Draw pieces [mm] of some moments, of this thickness [mm], two beside each other, each with its note."""
    seen = np.concatenate([x for pieces in shapes for x in pieces])
    low, high = seen.min(axis=0), seen.max(axis=0)
    margin = 0.04 * (high[0] - low[0])
    wide, tall = high[0] - low[0] + 2 * margin, max(high[1] - low[1], 0.1 * (high[0] - low[0])) + 2 * margin
    columns = min(2, len(shapes))
    rows, inches = -(-len(shapes) // columns), 6.4 / columns
    width = 72 * inches / wide * thick  # points
    with require("matplotlib").rc_context(STYLE):
        figure = require("matplotlib.figure").Figure(figsize=(6.4, rows * inches * tall / wide))
        for k, (note, pieces) in enumerate(zip(notes, shapes, strict=True)):
            axis = figure.add_axes(
                (k % columns / columns, 1 - (k // columns + 1) / rows, 1 / columns, 1 / rows)
            )
            axis.set(
                xlim=(low[0] - margin, high[0] + margin), ylim=(high[1] + margin - tall, high[1] + margin)
            )
            axis.set_axis_off()
            for p, x in enumerate(pieces):
                colour = STRAND_COLOURS[p % DISTINCT]
                axis.plot(x[:, 0], x[:, 1], color=colour, linewidth=width, solid_capstyle="butt")
            axis.text(0.5, 0.08, note, transform=axis.transAxes, color=INK, ha="center")
        return save(figure, path)


def _require(dataset: xarray.Dataset, name: str) -> None:
    missing = [key for key in ("piece_start", name) if key not in dataset]
    if missing:
        raise TorsadeError(
            f"this result is not of a rod that breaks: it lacks {', '.join(missing)}; give one of snap-twist "
            "or snap-quench"
        )


def _title(spec: dict[str, float], fragments: int) -> str:
    done = (
        f"twisted by {np.degrees(spec['twist']):.4g}°"
        if "twist" in spec
        else f"ends nearing at {1e3 * spec['speed']:.4g} mm/s"
    )
    return f"{done}: {fragments} {'piece' if fragments == 1 else 'pieces'}"
