"""What the figures of chapter 3 share: two sets of rods, trials with disorder, shapes, critical curves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import panels
from torsade.figures.base import Cell, Table
from torsade.fracture.criteria import limit_curvature, matching_strength, torsion_limit
from torsade.fracture.rod import Rod, spaghetti
from torsade.fracture.statistics import mean, sectors
from torsade.fracture.theory.binary import binary_slope
from torsade.view._extra import require
from torsade.view.colours import stress_colormap

if TYPE_CHECKING:
    from torsade.protocols.snap_twist import SnapTwist
    from torsade.results import Result

__all__ = [
    "CURVES",
    "DISORDER",
    "PLATE",
    "RODS",
    "SIGMA_C",
    "critical_curves",
    "draw_pieces",
    "half",
    "mean_by",
    "pieces_colour",
    "pieces_colours",
    "sector_table",
    "trial_table",
    "twist_trials",
]

RODS: Mapping[int, Rod] = {1: spaghetti(1), 2: spaghetti(2)}
"""The thesis's two sets: 24 cm and 1.4 mm, 20 cm and 1.7 mm."""

SIGMA_C: Mapping[int, float] = {1: 1.9e7, 2: 1.8e7}
"""Their strengths [Pa]."""

DISORDER = 0.03
"""Standard deviation of strength from grain to grain; the weakest of many grains is what breaks."""

CURVES = (
    ("effective", "effective (3.4)", panels.INK, "-"),
    ("von_mises_printed", "von Mises, printed (3.5)", "#c9543f", (0, (5, 2))),
    ("von_mises", "von Mises", "#c9543f", (0, (1.2, 1.2))),
    ("max_principal_printed", "max. principal, printed (3.6)", "#2f6fa8", (0, (6, 2, 1.2, 2))),
    ("max_principal", "max. principal", "#2f6fa8", (0, (1.2, 1.2))),
)
"""Criteria as they are drawn: name, label, colour, dashes."""

REGION = "#c9b6e0"
PLATE: Mapping[str, Any] = {"framealpha": 0.85, "edgecolor": "none", "borderpad": 0.3}
"""Behind legends that stand on something."""

_COUNTS = ("#5b3a8e", "#2f6fa8", "#3f9e8f", "#8fbf4d", "#e0b63a", "#d97a34", "#b5475c")


def pieces_colour(pieces: int) -> str:
    """Of a number of pieces, from 2 on."""
    return _COUNTS[min(max(pieces - 2, 0), len(_COUNTS) - 1)]


def pieces_colours(most: int) -> Any:
    """Of mean numbers of pieces from 2 to `most`: those of whole numbers, and what lies between."""
    colours = [pieces_colour(pieces) for pieces in range(2, most + 1)]
    return require("matplotlib.colors").LinearSegmentedColormap.from_list("pieces", colours)


def twist_trials(which: int, degrees: Sequence[float], seeds: Sequence[int]) -> dict[str, SnapTwist]:
    """Twisted rods of a set with strengths that scatter, by label."""
    from torsade.protocols.snap_twist import SnapTwist

    rod = RODS[which]
    return {
        f"twist-{which}-{degree:g}-{seed}": SnapTwist(
            length=rod.L,
            radius=rod.h,
            sigma_c=SIGMA_C[which],
            twist=math.radians(degree),
            disorder=DISORDER,
            seed=seed,
            frames=4,
        )
        for degree in degrees
        for seed in seeds
    }


def trial_table(results: Iterable[Result]) -> Table:
    """What came of rods that were twisted, one to a row."""
    columns = ("twist_deg", "seed", "limit_curvature_per_m", "pieces", "smallest_mm", "li")
    rows: list[tuple[Cell, ...]] = []
    for result in results:
        attrs, spec = result.dataset.attrs, result.spec
        rows.append(
            (
                math.degrees(spec["twist"]),
                int(spec["seed"]),
                float(attrs["critical_curvature_per_m"]),
                int(attrs["fragments"]),
                1e3 * min(attrs["lengths_m"]),
                float(attrs["li"]),
            )
        )
    return Table(columns, rows)


def sector_table(trials: Table, rod: Rod) -> Table:
    """Averages of trials over ten sectors of equal angle, as in Fig. 3-4F."""
    twist = [math.radians(_number(cell)) for cell in trials.column("twist_deg")]
    kappa = [_number(cell) for cell in trials.column("limit_curvature_per_m")]
    pieces = [int(_number(cell)) for cell in trials.column("pieces")]
    columns = (
        "from_deg", "to_deg", "trials", "twist_deg", "twist_sd_deg", "limit_curvature_per_m",
        "limit_curvature_sd_per_m", "pieces", "pieces_sd",
    )  # fmt: skip
    return Table(columns, [s.row for s in sectors(twist, kappa, pieces, rod)])


def _number(cell: Cell) -> float:
    assert isinstance(cell, (int, float))
    return float(cell)


def critical_curves(axes: Any, which: int, *, all_forms: bool = True, C: float = 1.5) -> None:
    """The plane of twist [degrees] and curvature: where rods break in two, and the curves of the criteria."""
    rod, sigma_c = RODS[which], SIGMA_C[which]
    top = 1.12 * 2 * sigma_c / (rod.E * rod.h)
    reach = math.degrees(torsion_limit(rod.L, sigma_c, rod.mu, rod.h)) * 1.12
    twist = np.linspace(0, reach, 400)
    slope = binary_slope(rod, C)
    axes.fill_between(twist, 0, slope * np.radians(twist), color=REGION, alpha=0.55, linewidth=0)
    for name, label, colour, dashes in CURVES if all_forms else CURVES[:1]:
        strength = matching_strength(sigma_c, name)
        end = math.degrees(torsion_limit(rod.L, strength, rod.mu, rod.h, name))
        along = np.linspace(0, 1, 300) ** 0.5 * min(end, reach)
        kappa = limit_curvature(np.radians(along) / rod.L, strength, rod.E, rod.mu, rod.h, name)
        axes.plot(along, kappa, color=colour, linestyle=dashes, linewidth=1.1, label=label)
    axes.set(xlim=(0, reach), ylim=(0, top))
    axes.set_xlabel("twist (degrees)")
    axes.set_ylabel("limit curvature (1/m)")
    axes.xaxis.set_major_locator(require("matplotlib.ticker").MultipleLocator(90))


def draw_pieces(axes: Any, result: Result, frame: int, shift: tuple[float, float], width: float = 2.0) -> Any:
    """Draw the pieces of a frame from above [mm], coloured by stress over strength; returns what is drawn."""
    data = result.dataset
    x = 1e3 * np.asarray(data["position"].values[frame], np.float64)[:, :2]
    sigma = np.asarray(data["stress"].values[frame], np.float64) / float(result.spec["sigma_c"])
    bounds = np.asarray(data["piece_start"].values[frame]).astype(int)
    segments, values = [], []
    for a, b in pairwise(bounds):
        if b - a > 1:
            nodes = x[a:b] + shift
            segments += [nodes[k : k + 2] for k in range(len(nodes) - 1)]
            values += [float(v) for v in 0.5 * (sigma[a : b - 1] + sigma[a + 1 : b])]
    lines = require("matplotlib.collections").LineCollection(
        segments, cmap=stress_colormap(), linewidths=width, capstyle="round"
    )
    lines.set_array(np.asarray(values))
    lines.set_clim(0.0, 1.0)
    axes.add_collection(lines)
    return lines


def mean_by(keys: Sequence[float], values: Sequence[float]) -> list[tuple[float, Any]]:
    """Means of values by equal keys, in the order of the keys."""
    return [
        (key, mean([v for k, v in zip(keys, values, strict=True) if k == key])) for key in sorted(set(keys))
    ]


def half(result: Result, frame: int, name: str) -> tuple[Floats, Floats]:
    """Distances from the grip [m] and values at the nodes of the first half of a rod, its new end last."""
    data = result.dataset
    end = int(data["piece_start"].values[frame][1])
    s = np.arange(end) * float(result.spec["length"]) / int(result.spec["edges"])
    return s, np.asarray(data[name].values[frame][:end], np.float64)
