"""A battery: shapes while it discharges, coloured by their energy, and energy and crossings against time."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.view._extra import require
from torsade.view.plots import ENERGIES, INK, STYLE, save
from torsade.view.scene import picture

if TYPE_CHECKING:
    import xarray

__all__ = ["density_bar", "density_colour", "draw_battery", "plot_battery"]

Floats = NDArray[np.float64]

SHARES = (0.5, 0.1, 0.01)
"""Of the energy at the cut, at which a picture shows the fiber."""

PALETTE = "YlOrRd"
DARKEST = 0.92
"""How far along the palette goes: the end of it hides the shading."""

TOP = 0.95
"""The quantile of the energy density in the charged fiber that the darkest colour stands for."""

PANEL = (640, 640)
"""Of one shape [pixels]."""


def density_colour(values: Floats) -> Floats:
    """sRGB (..., 3) of energy densities as shares of the largest shown."""
    colours = require("matplotlib").colormaps[PALETTE](DARKEST * np.clip(values, 0.0, 1.0))
    return np.asarray(colours)[..., :3]


def density_bar(figure: Any, axes: Any, top: float, **options: Any) -> None:
    """The colour bar of energy densities up to top [E_b h²]."""
    colors = require("matplotlib.colors")
    base = require("matplotlib").colormaps[PALETTE](np.linspace(0.0, DARKEST, 256))
    scale = require("matplotlib.cm").ScalarMappable(
        colors.Normalize(0.0, top), colors.ListedColormap(base, "density")
    )
    bar = figure.colorbar(scale, ax=axes, **options)
    bar.set_label(r"energy per length ($E_b h^2$)")
    bar.outline.set_visible(False)


def draw_battery(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Draw the charged fiber, and what it is like with 50, 10 and 1 % of its energy left.

    Parameters
    ----------
    dataset : of the protocol battery
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset)
    unit = dataset.attrs["E0_J"] / _length(dataset)
    shapes = list(_shapes(dataset))
    top = float(np.quantile(shapes[0][1], TOP))
    with require("matplotlib").rc_context(STYLE):
        size = (1.75 * len(shapes) + 0.7, 2.2)
        figure = require("matplotlib.figure").Figure(figsize=size, layout="constrained")
        axes = figure.subplots(1, len(shapes), squeeze=False)[0]
        for axis, (x, density, closed, title) in zip(axes, shapes, strict=True):
            image = picture(
                [x],
                closed,
                float(dataset.attrs["radius"]),
                values=[density / top],
                size=PANEL,
                palette=density_colour,
                bar=False,
                fill=0.86,
                whole=True,
            )
            axis.imshow(image, interpolation="antialiased")
            axis.axis("off")
            axis.set_title(title, loc="center", fontsize=7.5)
        density_bar(figure, list(axes), top / unit, shrink=0.75, pad=0.01)
        return save(figure, path)


def _shapes(dataset: xarray.Dataset) -> Iterator[tuple[Floats, Floats, bool, str]]:
    """Nodes, energy density, whether closed, and what to say of every shape that is shown."""
    charged, names = dataset.isel(charge=-1), ("position", "energy_density")
    x, density = (np.asarray(charged[f"charge_{name}"], np.float64) for name in names)
    yield x, density, True, f"{dataset.attrs['knot']}, charged"
    parts = [np.asarray(dataset[f"energy_{kind}"], np.float64) for kind in ENERGIES]
    energy = np.sum(parts, axis=0)
    times = np.asarray(dataset["time"], np.float64) / dataset.attrs["T0_s"]
    for share in SHARES:
        reached = np.flatnonzero(energy <= share * energy[0])
        if len(reached):
            k = int(reached[0])
            frame = dataset.isel(time=k)
            x, density = (np.asarray(frame[name], np.float64) for name in names)
            left = f"{100 * energy[k] / energy[0]:.2g} %"
            name = dataset.attrs["frame_knots"][k]
            yield x, density, False, f"{name}, t = {times[k]:.2g} $T_0$: {left}"


def plot_battery(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Plot the energies of a battery that discharges, by kind, and its crossings, against time.

    Parameters
    ----------
    dataset : of the protocol battery
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset)
    if dataset.sizes["time"] > 1:
        axis, crossings = "time", np.asarray(dataset["fewest_crossings"], np.float64)
        label, before = "time after the cut ($T_0$)", ""
    else:
        axis, crossings = "charge_time", None
        label, before = "time before the cut ($T_0$)", "charge_"
    t = np.asarray(dataset[axis], np.float64) / dataset.attrs["T0_s"]
    parts = {
        kind: np.asarray(dataset[f"{before}energy_{kind}"], np.float64) / dataset.attrs["E0_J"]
        for kind in ENERGIES
    }
    with require("matplotlib").rc_context(STYLE):
        rows = 1 if crossings is None else 2
        figure = require("matplotlib.figure").Figure(figsize=(4.5, 1.3 + 1.3 * rows), layout="constrained")
        axes = figure.subplots(rows, 1, sharex=True, squeeze=False, height_ratios=(3, 1)[:rows])[:, 0]
        total = sum(parts.values())
        axes[0].plot(t, total, color=INK, label="all")
        for kind, values in parts.items():
            axes[0].plot(t, values, color=ENERGIES[kind], linewidth=1.0, label=kind)
        axes[0].set_yscale("log")
        axes[0].set_ylim(5e-4 * float(np.max(total)), 1.6 * float(np.max(total)))
        axes[0].set_ylabel("energy ($E_0$)")
        axes[0].legend(frameon=False, ncols=5, fontsize=7, loc="lower right", bbox_to_anchor=(1.0, 1.0))
        axes[-1].set_xscale("symlog", linthresh=float(t[1]), linscale=0.3)
        axes[-1].set_xlim(0.0, t[-1])
        axes[-1].set_xlabel(label)
        if crossings is not None:
            axes[1].step(t, crossings, where="post", color=INK)
            axes[1].set_ylabel("crossings")
            axes[1].set_ylim(-0.4, float(crossings.max()) + 1.6)
            axes[1].yaxis.get_major_locator().set_params(integer=True)
            _name_knots(axes[1], t, dataset.attrs["frame_knots"])
        axes[0].set_title(f"{dataset.attrs['knot']}", fontsize=8.5)
        figure.align_ylabels(list(axes))
        return save(figure, path)


def _name_knots(axis: Any, t: Floats, names: list[str]) -> None:
    """Write the knots above the crossings, each where it begins, and a line between two."""
    begins = [k for k, name in enumerate(names) if k == 0 or name != names[k - 1]]
    for k, after in pairwise([*begins, len(t) - 1]):
        if k:
            axis.axvline(t[k], color=INK, linewidth=0.5, linestyle=(0, (2, 2)))
        low = t[1] * 0.2 if k == 0 else t[k]
        if t[after] > 1.8 * low:  # room enough for a name
            axis.annotate(
                names[k], (low, 0.97), xycoords=("data", "axes fraction"), xytext=(3, 0),
                textcoords="offset points", fontsize=6.5, color=INK, va="top",
            )  # fmt: skip


def _length(dataset: xarray.Dataset) -> float:
    """L [m], from the numbers of the model."""
    return float(json.loads(dataset.attrs["model"])["fiber_length"])


def _require(dataset: xarray.Dataset) -> None:
    missing = [name for name in ("charge_position", "energy_density") if name not in dataset.variables]
    if missing or "T0_s" not in dataset.attrs:
        raise TorsadeError(
            f"this result cannot be drawn: it lacks {', '.join(missing or ['T0_s'])}; give one of a battery "
            "that came to its end."
        )
