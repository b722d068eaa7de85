"""How little of the strain is twist in knots pulled tight: trefoil and figure-eight at rest (Fig 4-1C).

Both are pulled by both ends with 0.02 N, in the optomechanical fiber, until no node is faster than 1 um/s.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures.base import Cell, Choice, Preset, Table
from torsade.protocols.tighten import Tighten

if TYPE_CHECKING:
    import xarray

    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = [
    "COLOURS",
    "KNOTS",
    "draw_panel",
    "found",
    "label_of",
    "rest_arclength",
    "runs",
    "share_of",
    "shares",
    "spec",
    "table",
]

KNOTS: Mapping[str, str] = {"trefoil": "overhand", "figure-eight": "figure-eight"}
"""Names in the thesis, and in the catalogue."""

COLOURS: Mapping[str, str] = {"trefoil": "#2f6fa8", "figure-eight": "#c9543f"}

STILL = "1 um/s"

PUBLISHED_SPACING = "0.1 mm"
"""Nodes half a radius apart: with those of the published preset, 0.69 radii, strands of these knots would
pass through each other, since the projected contact area vanishes where they cross at right angles."""

COLUMNS = ("knot", "preset", "arclength_per_radius", "strain", "strain_twist")


def label_of(knot: str, preset: Preset) -> str:
    """The run of a knot."""
    return f"tighten {KNOTS[knot]}, {preset}"


def spec(knot: str, preset: Preset, quick: bool = False) -> Tighten:
    """A knot pulled until it is at rest; in a quick look, for a moment."""
    how: dict[str, Any] = (
        {"duration": "0.2 s", "frames": 8} if quick else {"duration": "40 s", "frames": 2000}
    )
    if preset == "published":
        how["spacing"] = PUBLISHED_SPACING
    return Tighten(knot=KNOTS[knot], preset=preset, until_still=STILL, **how)


def runs(choice: Choice) -> dict[str, Spec]:
    """Both knots in all presets."""
    return {
        label_of(knot, preset): spec(knot, preset, choice.quick)
        for preset in choice.presets
        for knot in KNOTS
    }


def found(results: Mapping[str, Result]) -> list[tuple[str, Preset, Result]]:
    """Knot, preset and result of every run of these that there is."""
    presets: tuple[Preset, ...] = ("standard", "published")
    every = [(knot, preset, label_of(knot, preset)) for preset in presets for knot in KNOTS]
    return [(knot, preset, results[label]) for knot, preset, label in every if label in results]


def rest_arclength(data: xarray.Dataset) -> Floats:
    """Arclength of every node of one open fiber at rest [m], from its middle."""
    l = np.linalg.norm(np.diff(data["position"].values[0].astype(float), axis=0), axis=1)
    s = np.concatenate([[0.0], np.cumsum(l)])
    return np.asarray(s - 0.5 * s[-1])


def total_strain(data: xarray.Dataset) -> Floats:
    """√(eps:eps) on the surface (n_frames, n_nodes), from its parts."""
    extension = data["strain_bend"].values + data["strain_stretch"].values
    return np.asarray(np.hypot(data["strain_twist"].values, extension), np.float64)


def table(results: Mapping[str, Result]) -> Table:
    """Total strain √(eps:eps) and twist strain along each knot at rest: a row for every node."""
    rows: list[Any] = []
    for knot, preset, result in found(results):
        data = result.dataset
        s = rest_arclength(data) / data.attrs["radius"]
        total, twist = total_strain(data)[-1], data["strain_twist"].values[-1]
        rows += [
            (knot, preset, float(a), float(b), float(c)) for a, b, c in zip(s, total, twist, strict=True)
        ]
    return Table(COLUMNS, rows)


def share_of(result: Result) -> dict[str, float | None]:
    """What a knot came to, and how much of its strain is twist.

    `twist_share` is ∫ twist² ds over ∫ eps:eps ds; `twist_adds` the most by which twist raises the log strain
    of any node.
    """
    data = result.dataset
    total, twist = total_strain(data)[-1], data["strain_twist"].values[-1].astype(float)
    without = np.abs(data["strain_bend"].values[-1] + data["strain_stretch"].values[-1])
    weight = np.gradient(rest_arclength(data))
    return {
        "still_at_s": data.attrs.get("over_at_s"),
        "end_to_end_m": float(data["end_to_end"][-1]),
        "length_m": float(data["length"][-1]),
        "h_kappa_max": float(data["h_kappa_max"][-1]),
        "total_twist_rad": float(data["total_twist"][-1]),
        **{f"{part}_max": float(data[f"strain_{part}"][-1].max()) for part in ("bend", "stretch", "twist")},
        "log_strain_max": float(data["max_log_strain"][-1]),
        "twist_share": float((weight * twist**2).sum() / (weight * total**2).sum()),
        "twist_adds": float((np.log1p(total) - np.log1p(without)).max()),
    }


def shares(results: Mapping[str, Result]) -> Table:
    """What each knot came to, and how much of its strain is twist, a row for every run; see `share_of`."""
    every = [(knot, preset, share_of(result)) for knot, preset, result in found(results)]
    rows: list[tuple[Cell, ...]] = [(knot, preset, *numbers.values()) for knot, preset, numbers in every]
    return Table(("knot", "preset", *every[0][2]), rows)


def draw_panel(axes: Any, table: Table) -> None:
    """Total strain (solid) and twist strain (dashed) along the tight knots, of the table's first preset."""
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    preset = rows[0]["preset"]
    for knot, colour in COLOURS.items():
        own = [row for row in rows if row["knot"] == knot and row["preset"] == preset]
        if not own:
            continue
        s, total, twist = (np.array([row[name] for row in own], float) for name in COLUMNS[2:])
        axes.plot(s, total, color=colour, label=f"{knot}, total")
        axes.plot(s, twist, color=colour, linestyle=(0, (3, 1.5)), linewidth=1.1, label=f"{knot}, twist")
    axes.set(xlabel="arclength from the middle (h)", ylabel=r"strain $\sqrt{\varepsilon:\varepsilon}$")
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.0)
    axes.legend(frameon=False, fontsize=6.5, handlelength=2.2)
