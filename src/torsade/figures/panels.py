"""What panels of printed figures share: pictures of knots, names beside points, letters at corners."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Floats
from torsade.view._extra import require
from torsade.view.colours import STRAIN_MAX, strain_colormap
from torsade.view.plots import INK, STYLE, save
from torsade.view.scene import picture

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = [
    "INK",
    "MUTED",
    "PRESET_COLOURS",
    "STYLE",
    "agreed",
    "counted",
    "knot_picture",
    "letter",
    "name_of",
    "new_figure",
    "save",
    "spread_out",
    "strain_bar",
]

MUTED = "#7c858d"
PRESET_COLOURS: Mapping[str, str] = {"standard": "#2f6fa8", "published": "#c9543f"}


def new_figure(width: float, height: float, layout: str = "constrained") -> Any:
    """An empty figure of that size [inches], whose panels are laid out by matplotlib or by hand ("none")."""
    return require("matplotlib.figure").Figure(figsize=(width, height), layout=layout)


def name_of(knot: str) -> str:
    """A bend's name as it is printed."""
    return knot.replace("_", " ")


def letter(axes: Any, text: str, x: float = 0.0) -> None:
    """The letter of a panel, above its upper left corner."""
    axes.annotate(
        text, (x, 1.0), xycoords="axes fraction", xytext=(0, 4), textcoords="offset points", fontsize=10,
        fontweight="bold", color=INK, ha="right" if x <= 0 else "left", va="bottom",
    )  # fmt: skip


def agreed(name: str, value: float, low: float, high: float) -> str:
    """A correlation with its interval, as it is printed."""
    number = [f"{x:.2f}".replace("-", "−") for x in (value, low, high)]
    interval = f" [{number[1]}, {number[2]}]" if np.isfinite([low, high]).all() else ""
    return f"{name} = {number[0]}{interval}"


def spread_out(values: ArrayLike, gap: float, low: float = -np.inf, high: float = np.inf) -> Floats:
    """Places (n,) at least a gap apart, as near to the values as can be, in their order, between two bounds.

    Least squares: with the k-th smallest place z_k = y_k + k gap, y must not fall.
    """
    from scipy.optimize import isotonic_regression

    x = np.asarray(values, np.float64)
    order = np.argsort(x, kind="stable")
    rungs = gap * np.arange(len(x))
    y = np.clip(isotonic_regression(x[order] - rungs).x, low, high - rungs[-1:].sum())
    places = np.empty_like(x)
    places[order] = y + rungs
    return places


def knot_picture(axes: Any, result: Result, size: tuple[int, int] = (640, 480), fill: float = 0.72) -> None:
    """Draw the last frame in which a bend holds, coloured by strain, on axes that lose their frame."""
    data, frame = result.dataset, result.last_held
    cuts = np.asarray(data["node_start"].values, np.int64)[1:-1]
    strands = np.split(np.asarray(data["position"].values[frame], np.float64), cuts)
    strain = np.split(np.asarray(data["log_strain"].values[frame], np.float64), cuts)
    options: Mapping[str, Any] = {"values": strain, "size": size, "fill": fill, "fade": 0.06, "bar": False}
    axes.imshow(picture(strands, False, float(data.attrs["radius"]), **options), interpolation="antialiased")
    axes.axis("off")


def strain_bar(figure: Any, axes: Any, **options: Any) -> None:
    """The colour bar of strain for pictures on these axes."""
    cm, colors = require("matplotlib.cm"), require("matplotlib.colors")
    scale = cm.ScalarMappable(colors.Normalize(0.0, STRAIN_MAX), strain_colormap())
    bar = figure.colorbar(scale, ax=axes, ticks=[0, 0.35, 0.7], **options)
    bar.set_label("logarithmic strain")
    bar.outline.set_visible(False)


def counted(row: Mapping[str, Any]) -> str:
    """(N, tau, Gamma) of a row of a table as it is printed."""
    return f"({row['N']}, {row['tau']:.3g}, {row['Gamma']:.3g})"
