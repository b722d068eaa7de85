"""Curves against time, in the style of a printed figure: what a stored result says, on one small page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, reason_of
from torsade.view._extra import require

if TYPE_CHECKING:
    import xarray

Floats = NDArray[np.float64]

ENDINGS = (".png", ".pdf", ".svg")
INK, CURVE, SLIP = "#262a2e", "#2f6fa8", "#b5475c"
STYLE: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Helvetica", "Arial", "DejaVu Sans"],
    "font.size": 8.0,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.grid": True,
    "grid.color": "#e4e7ea",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "pdf.fonttype": 42,
    "svg.hashsalt": "torsade",
}


def plot_separation(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot how far apart the two ends of a pulled bend are, and how fast they part, against time.

    Parameters
    ----------
    dataset : coordinate `time` [s], variables `separation (time)` [m] and `pull_speed (time)` [m/s]; the
        attributes `knot` and `c_f` make the title, `slipped_at_s` [s] is marked
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset, "separation", "pull_speed")
    speed = 1e3 * _values(dataset, "pull_speed")
    panels = [("separation (mm)", 1e3 * _values(dataset, "separation")), ("pull speed (mm/s)", speed)]
    with require("matplotlib").rc_context(STYLE):
        figure, axes = _stack(dataset, panels)
        if np.isfinite(speed).any():
            top = 1.15 * float(np.nanpercentile(speed, 97.0))
            axes[1].set_ylim(min(0.0, float(np.nanpercentile(speed, 3.0))), top if top > 0 else None)
        slipped = _number(dataset, "slipped_at_s")
        if slipped is not None:
            for axis in axes:
                axis.axvline(slipped, color=SLIP, linewidth=0.9, linestyle=(0, (4, 2)))
            box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
            left = slipped > 0.6 * float(dataset["time"].max())
            axes[0].annotate(
                f"slips at {slipped:.3g} s",
                (slipped, 0.06),
                xycoords=("data", "axes fraction"),
                xytext=(-5 if left else 5, 0),
                textcoords="offset points",
                ha="right" if left else "left",
                color=SLIP,
                bbox=box,
            )
        _title(axes[0], dataset)
        return save(figure, path)


def plot_tightening(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot the end-to-end distance, the largest curvature and the twist of a tightened knot against time.

    Parameters
    ----------
    dataset : coordinate `time` [s], variables `end_to_end (time)` [m], `h_kappa_max (time)` and
        `total_twist (time)` [rad]; the attributes `knot` and `c_f` make the title
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset, "end_to_end", "h_kappa_max", "total_twist")
    panels = [
        ("end to end (mm)", 1e3 * _values(dataset, "end_to_end")),
        (r"$h\,\kappa_{\mathrm{max}}$", _values(dataset, "h_kappa_max")),
        ("total twist (rad)", _values(dataset, "total_twist")),
    ]
    with require("matplotlib").rc_context(STYLE):
        figure, axes = _stack(dataset, panels)
        _title(axes[0], dataset)
        return save(figure, path)


def plot_wound(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot the gap of a sutured wound, what its sides move along z, and the forces on them, against time.

    Parameters
    ----------
    dataset : of the protocol suture
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset, "gap", "skin_position", "skin_pressing", "skin_shearing")
    z = 1e6 * np.asarray(dataset["skin_position"][:, :, 2] - dataset["skin_position"][0, :, 2])
    force = 1e3 * np.stack([np.asarray(dataset[f"skin_{kind}"])[:, 0] for kind in ("pressing", "shearing")])
    panels = [
        ("gap (mm)", 1e3 * _values(dataset, "gap")),
        ("$z$ (\u00b5m)", z[:, 0]),
        ("force on $a$ (mN)", force[0]),
    ]
    with require("matplotlib").rc_context(STYLE):
        figure, axes = _stack(dataset, panels)
        axes[1].plot(np.asarray(dataset["time"]), z[:, 1], color=SLIP)
        axes[2].plot(np.asarray(dataset["time"]), force[1], color=SLIP)
        _beside(axes[1], "side a", "side b")
        _beside(axes[2], "normal", "shear")
        _title(axes[0], dataset)
        return save(figure, path)


def _beside(axis: Any, first: str, second: str) -> None:
    """Say what the two curves of a panel are, above its right corner."""
    for text, colour, x in ((first, CURVE, 0.86), (second, SLIP, 1.0)):
        axis.annotate(
            text, (x, 1.0), xycoords="axes fraction", xytext=(0, 2), textcoords="offset points",
            ha="right", va="bottom", fontsize=7.0, color=colour,
        )  # fmt: skip


def plot_swing(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot the angle and the energy of a torsion pendulum against time.

    Parameters
    ----------
    dataset : coordinate `time` [s], variables `angle (time)` [rad], `energy_spin (time)` and
        `energy_twist (time)` [J]
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset, "angle", "energy_spin", "energy_twist")
    energy = _values(dataset, "energy_spin") + _values(dataset, "energy_twist")
    panels = [
        ("angle (deg)", np.degrees(_values(dataset, "angle"))),
        ("energy, share of the first", energy / energy[0]),
    ]
    with require("matplotlib").rc_context(STYLE):
        figure, axes = _stack(dataset, panels)
        axes[1].set_ylim(bottom=0.0)
        return save(figure, path)


ENERGIES = {"bend": "#2f6fa8", "twist": "#e39a2d", "stretch": "#41a08d", "contact": "#bf4560"}
"""Colours of stored energies by kind."""


def plot_move(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot stored energies and crossings of a Reidemeister move against the way of the moved ends.

    Parameters
    ----------
    dataset : variables `displacement (time)` [m], `crossings (time)` and `energy_bend`, `energy_twist`,
        `energy_stretch`, `energy_contact (time)` [J]; the attribute `knot`, the move, makes the title
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset, "displacement", "crossings", *(f"energy_{kind}" for kind in ENERGIES))
    way = 1e3 * _values(dataset, "displacement")
    parts = {kind: 1e9 * _values(dataset, f"energy_{kind}") for kind in ENERGIES}
    with require("matplotlib").rc_context(STYLE):
        figure = require("matplotlib.figure").Figure(figsize=(4.5, 3.4), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        above.plot(way, sum(parts.values()), color=INK, label="all")
        for kind, values in parts.items():
            above.plot(way, values, color=ENERGIES[kind], linewidth=1.0, label=kind, clip_on=False)
        above.set_ylabel("energy (nJ)")
        above.legend(frameon=False, ncols=5, fontsize=7, loc="lower right", bbox_to_anchor=(1.0, 1.0))
        above.set_ylim(bottom=0.0)
        crossings = _values(dataset, "crossings")
        below.step(way, crossings, where="post", color=INK)
        below.set_ylim(-0.3, crossings.max() + 0.7)
        below.yaxis.get_major_locator().set_params(integer=True)
        below.set(xlabel="way of the moved ends (mm)", ylabel="crossings")
        below.margins(x=0.0)
        figure.align_ylabels([above, below])
        _title(above, dataset)
        return save(figure, path)


def plot_bent(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot a bent and twisted fiber from the side and from above, and its curvature along it.

    Parameters
    ----------
    dataset : variables `position (time, node, space)` [m] and `curvature (time, node)` [1/m], of which the
        first frame is plotted; the variable `twist (time, fiber)` [rad] makes the title
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset, "position", "curvature", "twist")
    x, y, z = 1e3 * _values(dataset, "position")[0].T
    kappa = _values(dataset, "curvature")[0]
    along = np.concatenate([[0.0], np.cumsum(np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2 + np.diff(z) ** 2))])
    twist = np.degrees(_values(dataset, "twist")[0, 0])
    with require("matplotlib").rc_context(STYLE):
        heights = (3.9 * min(0.8, max(0.2, float(np.ptp(y)) / float(np.ptp(x) + 1e-9))), 0.9, 1.4)
        size = (4.5, 1.2 + sum(heights))
        figure = require("matplotlib.figure").Figure(figsize=size, layout="constrained")
        side, above, bend = figure.subplots(3, 1, height_ratios=heights)
        side.plot(x, y, color=CURVE)
        side.set_aspect("equal", adjustable="datalim")
        side.set(ylabel="y (mm)")
        above.plot(x, z, color=CURVE)
        above.set(xlabel="x (mm)", ylabel="z (mm)")
        bend.plot(along, kappa, color=CURVE)
        bend.margins(x=0.0)
        bend.set(xlabel="arclength (mm)", ylabel="curvature (1/m)")
        bend.set_ylim(bottom=0.0)
        side.set_title(f"ends {x[-1] - x[0]:.4g} mm apart,  total twist {twist:.4g}°")
        figure.align_ylabels((side, above, bend))
        figure.draw_without_rendering()  # the shape's aspect settles its limits then
        above.set_xlim(side.get_xlim())
        out = max(1.1 * float(np.abs(z).max()), 0.01 * along[-1])
        above.set_ylim(-out, out)
        return save(figure, path)


def _require(dataset: xarray.Dataset, *names: str) -> None:
    missing = [name for name in ("time", *names) if name not in dataset.variables]
    if missing:
        raise TorsadeError(
            f"this result cannot be plotted: it lacks {', '.join(missing)}; give one written by the protocol "
            "that this plot belongs to."
        )


def _values(dataset: xarray.Dataset, name: str) -> Floats:
    return np.asarray(dataset[name], dtype=np.float64)


def _number(dataset: xarray.Dataset, name: str) -> float | None:
    """An attribute as a finite number, or None when it is absent, null or not a number."""
    value = dataset.attrs.get(name)
    return float(value) if value is not None and np.isfinite(float(value)) else None


def _stack(dataset: xarray.Dataset, panels: list[tuple[str, Floats]]) -> tuple[Any, Any]:
    """Panels one above the other over a common time axis."""
    height = 0.7 + 1.45 * len(panels)
    figure = require("matplotlib.figure").Figure(figsize=(4.5, height), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True)
    time = _values(dataset, "time")
    for axis, (label, curve) in zip(axes, panels, strict=True):
        axis.plot(time, curve, color=CURVE)
        axis.set_ylabel(label)
        axis.margins(x=0.0)
    axes[-1].set_xlabel("time (s)")
    figure.align_ylabels(axes)
    return figure, axes


def _title(axis: Any, dataset: xarray.Dataset) -> None:
    """Name of the knot and its topological friction, as far as they are known."""
    # A dollar sign would begin a formula.
    parts = [str(dataset.attrs["knot"]).replace("$", r"\$")] if dataset.attrs.get("knot") else []
    if dataset.attrs.get("protocol") == "suture":
        parts = [part.replace(",", ", ").replace("-", "\N{MINUS SIGN}") for part in parts]
        parts = [f"({part})" for part in parts]
    friction = _number(dataset, "c_f")
    if friction is not None:
        parts.append(rf"$c_f$ = {friction:.3g}")
    if parts:
        axis.set_title(",  ".join(parts))


def save(figure: Any, path: str | Path) -> Path:
    """Write a matplotlib figure to a file (png, pdf, svg), or say why that cannot be done."""
    path = Path(path)
    if path.suffix.lower() not in ENDINGS:
        raise TorsadeError(f"cannot plot to {str(path)!r}; give a name that ends in {' or '.join(ENDINGS)}")
    try:
        figure.savefig(path, dpi=300, facecolor="white")
    except OSError as error:
        raise TorsadeError(
            f"the plot cannot be written to {path} ({reason_of(error)}); give a path in a folder that exists "
            "and can be written."
        ) from error
    return path
