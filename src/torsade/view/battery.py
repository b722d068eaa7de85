"""A battery: shapes while it discharges, coloured by their energy, and energy and crossings against time."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.topology.names import UNKNOT
from torsade.view._extra import require
from torsade.view.overlay import Bar
from torsade.view.plots import ENERGIES, INK, STYLE, save
from torsade.view.scene import picture

if TYPE_CHECKING:
    import xarray

__all__ = [
    "Shape",
    "bar_of_density",
    "battery_note",
    "density_bar",
    "density_colour",
    "density_unit",
    "draw_battery",
    "energy_lines",
    "name_knots",
    "plot_battery",
    "shapes",
    "time_axis",
    "top_density",
]

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


def _density_colormap() -> Any:
    base = require("matplotlib").colormaps[PALETTE](np.linspace(0.0, DARKEST, 256))
    return require("matplotlib.colors").ListedColormap(base, "density")


def bar_of_density(dataset: xarray.Dataset) -> Bar:
    """What a colour bar on a picture explains."""
    top = top_density(dataset) / density_unit(dataset)
    ticks = require("matplotlib.ticker").MaxNLocator(4).tick_values(0.0, top)
    shown = tuple(float(tick) for tick in ticks if tick <= top)
    return Bar(_density_colormap, top, shown, r"energy per length  ($E_b h^2$)")


def density_bar(figure: Any, axes: Any, top: float, **options: Any) -> Any:
    """The colour bar of energy densities up to top [E_b h²], which is drawn and returned."""
    scale = require("matplotlib.cm").ScalarMappable(
        require("matplotlib.colors").Normalize(0.0, top), _density_colormap()
    )
    bar = figure.colorbar(scale, ax=axes, **options)
    bar.set_label(r"energy per length ($E_b h^2$)")
    bar.outline.set_visible(False)
    return bar


def draw_battery(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Draw the charged fiber, and what it is like with 50, 10 and 1 % of its energy left.

    Parameters
    ----------
    dataset : of the protocol battery
    path : the file to write; its ending chooses the format (png, pdf, svg)
    """
    _require(dataset)
    found = list(shapes(dataset))
    top = float(np.quantile(found[0].density, TOP))
    with require("matplotlib").rc_context(STYLE):
        size = (1.75 * len(found) + 0.7, 2.2)
        figure = require("matplotlib.figure").Figure(figsize=size, layout="constrained")
        axes = figure.subplots(1, len(found), squeeze=False)[0]
        for axis, shape in zip(axes, found, strict=True):
            left = "charged" if shape.closed else f"t = {shape.time:.2g} $T_0$: {100 * shape.left:.2g} %"
            shape.draw(axis, float(dataset.attrs["radius"]), top, f"{shape.called}, {left}")
        density_bar(figure, list(axes), top, shrink=0.75, pad=0.01)
        return save(figure, path)


class Shape(NamedTuple):
    """A battery at one moment.

    Attributes
    ----------
    x : nodes [m], shape (n, 3)
    density : energy per rest length [E_b h²], shape (n,)
    closed : whether it is not cut yet
    knot : that it is then
    time : since the cut, or before it since it was twisted [T_0]
    left : of the energy at the cut, as a share of it
    """

    x: Floats
    density: Floats
    closed: bool
    knot: str
    time: float
    left: float

    @property
    def called(self) -> str:
        """The knot in words."""
        return called(self.knot)

    def draw(self, axes: Any, radius: float, top: float, title: str, size: tuple[int, int] = PANEL) -> None:
        """Its picture on axes that lose their frame; top is the density of the darkest colour."""
        image = picture(
            [self.x], self.closed, radius, values=[self.density / top], size=size, palette=density_colour,
            bar=False, fill=0.86, whole=True,
        )  # fmt: skip
        axes.imshow(image, interpolation="antialiased")
        axes.axis("off")
        axes.set_title(title, loc="center", fontsize=7.5)

    @classmethod
    def charging(cls, dataset: xarray.Dataset, frame: int = -1) -> Shape:
        """At a frame before the cut."""
        then = dataset.isel(charge=frame)
        x, density = (np.asarray(then[f"charge_{n}"], np.float64) for n in ("position", "energy_density"))
        time = float(then["charge_time"]) / dataset.attrs["T0_s"]
        return cls(x, density / density_unit(dataset), True, dataset.attrs["charge_knots"][frame], time, 1.0)

    @classmethod
    def discharging(cls, dataset: xarray.Dataset, frame: int) -> Shape:
        """At a frame after the cut."""
        then, energy = dataset.isel(time=frame), _energy(dataset)
        x, density = (np.asarray(then[name], np.float64) for name in ("position", "energy_density"))
        time = float(then["time"]) / dataset.attrs["T0_s"]
        knot = dataset.attrs["frame_knots"][frame]
        return cls(x, density / density_unit(dataset), False, knot, time, float(energy[frame] / energy[0]))


def shapes(dataset: xarray.Dataset, shares: Sequence[float] = SHARES) -> Iterator[Shape]:
    """The charged fiber, and the fiber as soon as it has no more than each share of its energy left."""
    yield Shape.charging(dataset)
    energy, seen = _energy(dataset), -1
    for share in shares:
        reached = np.flatnonzero(energy <= share * energy[0])
        if len(reached) and reached[0] != seen:  # of few frames one may be the first below two shares
            seen = int(reached[0])
            yield Shape.discharging(dataset, seen)


def top_density(dataset: xarray.Dataset) -> float:
    """Energy per rest length [J/m] that the darkest colour stands for."""
    return float(np.quantile(np.asarray(dataset["charge_energy_density"][-1], np.float64), TOP))


def battery_note(dataset: xarray.Dataset, time: float) -> str:
    """Which knot a battery is at a time [s] after the cut, and how much of its energy is left."""
    times, energy = np.asarray(dataset["time"], np.float64), _energy(dataset)
    frame = max(0, int(np.searchsorted(times, time, side="right")) - 1)
    left = 100 * float(np.exp(np.interp(time, times, np.log(energy / energy[0]))))
    knot = dataset.attrs["frame_knots"][frame]
    shown = f"{left:.0f}" if left >= 10 else f"{left:.1f}"
    return f"{called(knot)}, {shown} % of the energy left"


def called(knot: str) -> str:
    """A knot by its name, and of none that it is untied."""
    return "untied" if knot == UNKNOT else knot


def _energy(dataset: xarray.Dataset) -> Floats:
    """All energy at every frame after the cut [J]."""
    return np.asarray(sum(np.asarray(dataset[f"energy_{kind}"], np.float64) for kind in ENERGIES))


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
        top = energy_lines(axes[0], t, parts)
        axes[0].set_ylim(5e-4 * top, 1.6 * top)
        axes[0].set_ylabel("energy ($E_0$)")
        axes[0].legend(frameon=False, ncols=5, fontsize=7, loc="lower right", bbox_to_anchor=(1.0, 1.0))
        time_axis(axes[-1], t)
        axes[-1].set_xlabel(label)
        if crossings is not None:
            axes[1].step(t, crossings, where="post", color=INK)
            axes[1].set_ylabel("crossings")
            axes[1].set_ylim(-0.4, float(crossings.max()) + 1.6)
            axes[1].yaxis.get_major_locator().set_params(integer=True)
            name_knots(axes[1:], t, dataset.attrs["frame_knots"])
        axes[0].set_title(f"{dataset.attrs['knot']}", fontsize=8.5)
        figure.align_ylabels(list(axes))
        return save(figure, path)


def energy_lines(axes: Any, t: Floats, parts: Mapping[str, Floats]) -> float:
    """Energies by kind and their sum against time, all of shape (n,); returns the largest sum."""
    total = np.sum(list(parts.values()), axis=0)
    axes.plot(t, total, color=INK, label="all")
    for kind, values in parts.items():
        axes.plot(t, values, color=ENERGIES[kind], linewidth=1.0, label=kind)
    axes.set_yscale("log")
    return float(total.max())


def time_axis(axes: Any, t: Floats) -> None:
    """Times (n,), logarithmic from the second one on; before it the axis goes on to 0."""
    axes.set_xscale("symlog", linthresh=float(t[1]), linscale=0.3)
    axes.set_xlim(0.0, t[-1])


def name_knots(axes: Sequence[Any], t: Floats, names: Sequence[str]) -> None:
    """Lines where the knot becomes another, and above the last of the axes its name where there is room."""
    begins = [k for k, name in enumerate(names) if k == 0 or name != names[k - 1]]
    for k, after in pairwise([*begins, len(t) - 1]):
        for axis in axes if k else ():
            axis.axvline(t[k], color=INK, linewidth=0.5, linestyle=(0, (2, 2)))
        low = t[1] * 0.2 if k == 0 else t[k]
        if t[after] > 1.8 * low:  # room enough for a name
            axes[-1].annotate(
                called(names[k]), (low, 0.97), xycoords=("data", "axes fraction"), xytext=(3, 0),
                textcoords="offset points", fontsize=6.5, color=INK, va="top",
            )  # fmt: skip


def density_unit(dataset: xarray.Dataset) -> float:
    """E_b h² [N]: E_0 over the length of the fiber, which is among the numbers of the model."""
    return float(dataset.attrs["E0_J"]) / float(json.loads(dataset.attrs["model"])["fiber_length"])


def _require(dataset: xarray.Dataset) -> None:
    missing = [name for name in ("charge_position", "energy_density") if name not in dataset.variables]
    if missing or "T0_s" not in dataset.attrs:
        raise TorsadeError(
            f"this result cannot be drawn: it lacks {', '.join(missing or ['T0_s'])}; give one of a battery "
            "that came to its end."
        )
