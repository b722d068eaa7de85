"""Knots as they are pulled tight: stages on the way, strain along the fiber (Fig 4-2A, B, D, E)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import panels
from torsade.figures.base import Table
from torsade.figures.twist_share import found, rest_arclength
from torsade.view._extra import require
from torsade.view.camera import SAMPLE, best_side, frame, knot_body, level_right
from torsade.view.scene import picture
from torsade.view.tube import smooth_centerline

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["STAGES", "draw_profiles", "draw_stages", "paths", "profiles", "stages"]

STAGES = 4
"""Moments shown of each knot."""

STAGE_COLOURS = ("#b9cbe0", "#7fa6cd", "#3f78b0", "#173f6b")
SIZE = (480, 368)  # pixels
FILL = 0.86

PARTS = ("bend", "stretch", "twist")


def stages(result: Result) -> list[int]:
    """Frames: as it was tied, then taut, then half of the way of the ends from there to rest, then at rest.

    Taut is the first frame after t = 0: a fiber takes up its stretch within milliseconds, and then slides.
    """
    apart = result.dataset["end_to_end"].values
    last = len(apart) - 1
    half = 1 + int(np.argmax(apart[1:] >= 0.5 * (apart[1] + apart[last])))
    return [0, 1, half, last]


def profiles(results: Mapping[str, Result]) -> Table:
    """The parts of the strain at every node of each knot at its stages."""
    rows: list[Any] = []
    for knot, preset, result in found(results):
        data = result.dataset
        s = rest_arclength(data) / data.attrs["radius"]
        for stage, k in enumerate(stages(result), 1):
            time = float(data["time"][k])
            parts = [data[f"strain_{part}"].values[k] for part in PARTS]
            along = zip(s, *parts, data["log_strain"].values[k], strict=True)
            rows += [(knot, preset, stage, time, *map(float, values)) for values in along]
    columns = ("knot", "preset", "stage", "time_s", "arclength_per_radius", *PARTS, "log_strain")
    return Table(columns, rows)


def paths(results: Mapping[str, Result]) -> Table:
    """Each knot's way to rest: where its ends are, largest strains and stored energies, at every frame."""
    rows: list[Any] = []
    names = ("end_to_end", "length", "total_twist", "max_log_strain")
    energies = tuple(f"energy_{kind}" for kind in ("bend", "stretch", "twist", "contact"))
    for knot, preset, result in found(results):
        data = result.dataset
        histories = [data[name].values for name in ("time", *names)]
        histories += [data[f"strain_{part}"].values.max(axis=1) for part in PARTS]
        histories += [data[name].values for name in energies]
        rows += [(knot, preset, *map(float, values)) for values in zip(*histories, strict=True)]
    heads = ("knot", "preset", "time_s", "end_to_end_m", "length_m", "twist_rad", "log_strain_max")
    return Table((*heads, *(f"{part}_max" for part in PARTS), *(f"{name}_J" for name in energies)), rows)


def draw_stages(row: Any, result: Result) -> None:
    """Pictures of a knot at its stages on a row of axes, all from one side and on one scale."""
    data = result.dataset
    h = float(data.attrs["radius"])
    shown = stages(result)
    positions = [data["position"].values[k].astype(float) for k in shown]
    toward, fills = _common_view(positions, h)
    for axes, k, x, fill in zip(row, shown, positions, fills, strict=True):
        image = picture(
            [x], False, h, values=[data["log_strain"].values[k]], size=SIZE, direction=toward, fill=fill,
            fade=0.06, bar=False,
        )  # fmt: skip
        axes.imshow(image, interpolation="antialiased")
        axes.axis("off")
        axes.text(
            0.5, -0.02, f"{data['time'].values[k]:.3g} s", transform=axes.transAxes, ha="center", va="top",
            fontsize=7, color=panels.INK,
        )  # fmt: skip


def _common_view(positions: list[Floats], h: float) -> tuple[Floats, list[float]]:
    """The side that shows the last of several shapes best, and how far each fills a frame of one scale."""
    curves = [smooth_centerline((x - x.mean(axis=0)) / h, False, SAMPLE) for x in positions]
    bodies = [np.concatenate(knot_body([curve], [False], 1.0)) for curve in curves]
    toward = best_side([curves[-1].x], bodies[-1], 1.0, level=True)[1]
    right = level_right(toward)
    heights = [frame(body, 1.0, SIZE, right, toward, FILL).half_height for body in bodies]
    return toward, [FILL * height / max(heights) for height in heights]


def draw_profiles(above: Any, below: Any, table: Table, knot: str, preset: str) -> None:
    """Bending strain above and stretching strain below along one knot, a curve for each stage."""
    rows = [dict(zip(table.columns, row, strict=True)) for row in table.rows]
    for stage in range(1, STAGES + 1):
        own = [r for r in rows if (r["knot"], r["preset"], r["stage"]) == (knot, preset, stage)]
        s = np.array([row["arclength_per_radius"] for row in own], float)
        for axes, part in ((above, "bend"), (below, "stretch")):
            values = np.array([row[part] for row in own], float)
            style = {"color": STAGE_COLOURS[stage - 1], "linewidth": 1.2}
            axes.plot(s, values, **style, label=f"{own[0]['time_s']:.2g} s")
    above.set_ylabel(r"bending $h\kappa$")
    below.set_ylabel(r"stretch $|x'| - 1$")
    below.set_xlabel("arclength from the middle (h)")
    for axes in (above, below):
        axes.margins(x=0.0)
        axes.set_ylim(bottom=0.0)
        axes.yaxis.set_major_locator(require("matplotlib.ticker").MaxNLocator(4))
    above.tick_params(labelbottom=False)
    above.legend(frameon=False, fontsize=6, handlelength=1.2, loc="upper right", labelspacing=0.25)
