"""Reidemeister moves made on fibers: their energy paths, and what each costs (Fig 4-2F)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.arrays import Floats
from torsade.figures import panels
from torsade.figures.base import Cell, Choice, Table
from torsade.protocols.moves import LOOP, planar_loop
from torsade.protocols.reidemeister import Reidemeister, elastic_energy
from torsade.view.camera import SAMPLE, frame, knot_body
from torsade.view.scene import picture
from torsade.view.tube import smooth_centerline

if TYPE_CHECKING:
    from torsade.protocols.base import Spec
    from torsade.results import Result

__all__ = ["MOVES", "barrier_of", "barriers", "draw_move", "draw_shapes", "energies", "move_paths", "runs"]

MOVES: Mapping[str, tuple[str, str]] = {
    "R1, gripped": ("R1", "gripped"),
    "R1, swivel": ("R1", "swivel"),
    "R2": ("R2", "gripped"),
    "R3": ("R3", "gripped"),
}
"""Labels of runs: which move, and whether an end may spin."""

COLOURS: Mapping[str, str] = {"R1": "#c9543f", "R2": "#2f6fa8", "R3": "#3d8b78"}
KINDS = ("bend", "stretch", "twist", "contact")
SIZE = (512, 384)  # pixels
WIDTH = 1.05
"""Of the pictures, in free lengths."""

ALONG_Z = (0.0, 0.0, 1.0)


def label_of(move: str) -> str:
    """The run of a move."""
    return f"reidemeister {move}"


def runs(choice: Choice) -> dict[str, Spec]:
    """All moves, with the standard model: these are equilibria, which drag does not change."""
    quick: dict[str, Any] = {"length": "8 mm", "duration": "30 s", "frames": 12} if choice.quick else {}
    return {
        label_of(name): Reidemeister.model_validate({"move": move, "ends": ends} | quick)
        for name, (move, ends) in MOVES.items()
    }


def energies(result: Result) -> tuple[Floats, Floats]:
    """Displacement in units of L, and the energy beyond that of strands lying apart, in units of B/L."""
    report = Reidemeister.report(result)
    energy = (elastic_energy(result) - report["energy_apart_J"]) / report["B_over_L_J"]
    return result.dataset["displacement"].values / report["length_m"], energy


def move_paths(results: Mapping[str, Result]) -> Table:
    """Stored energies of each move in units of B/L and crossings seen, at every frame."""
    rows: list[Any] = []
    for name in MOVES:
        data, report = results[label_of(name)].dataset, Reidemeister.report(results[label_of(name)])
        way = data["displacement"].values / report["length_m"]
        parts = [data[f"energy_{kind}"].values / report["B_over_L_J"] for kind in KINDS]
        columns = zip(data["time"].values, way, data["crossings"].values, *parts, strict=True)
        rows += [(name, float(t), float(d), int(n), *map(float, e)) for t, d, n, *e in columns]
    heads = ("move", "time_s", "displacement_per_L", "crossings")
    return Table((*heads, *(f"{kind}_L_per_B" for kind in KINDS)), rows)


def barrier_of(result: Result) -> dict[str, float | int | None]:
    """Energies of a move beyond those of strands that lie apart, in units of B/L, and when crossings change.

    `start` is at rest before the move, `top` the highest on its way, `end` after it.
    """
    report = Reidemeister.report(result)
    way, energy = energies(result)
    began = int(np.searchsorted(result.dataset["time"], result.dataset.attrs["move_from_s"] * (1 - 1e-9)))
    top = began + int(energy[began:].argmax())
    crossings = np.array(report["crossings"])
    changed = np.nonzero(np.diff(crossings))[0]
    return {
        "length_m": float(report["length_m"]),
        "B_per_L_J": float(report["B_over_L_J"]),
        "start_L_per_B": float(energy[began]),
        "top_L_per_B": float(energy[top]),
        "end_L_per_B": float(energy[-1]),
        "top_at_per_L": float(way[top]),
        "crossings_before": int(crossings[0]),
        "crossings_after": int(crossings[-1]),
        "crossings_change_at_per_L": float(way[changed[0] + 1]) if changed.size else None,
    }


def barriers(results: Mapping[str, Result]) -> Table:
    """What each move costs, a row for every run; see `barrier_of`."""
    every = {name: barrier_of(results[label_of(name)]) for name in MOVES}
    rows: list[tuple[Cell, ...]] = [(name, *numbers.values()) for name, numbers in every.items()]
    return Table(("move", *next(iter(every.values()))), rows)


def draw_move(axes: Any, results: Mapping[str, Result], move: str) -> None:
    """The energy path of a move; for R1 both kinds of ends, and the planar loop in closed form."""
    for name, (own, ends) in MOVES.items():
        if own != move:
            continue
        way, energy = energies(results[label_of(name)])
        # At the very start strands have not come to rest yet.
        rest = way > 0 if move == "R1" else slice(None)
        dashed = {"linestyle": (0, (3, 1.5)), "linewidth": 1.2} if ends == "swivel" else {}
        axes.plot(way[rest], energy[rest], color=COLOURS[move], label=ends, **dashed)
        crossings = results[label_of(name)].dataset["crossings"].values
        for k in np.nonzero(np.diff(crossings))[0] + 1:
            dot = {
                "ms": 4.0,
                "color": COLOURS[move],
                "mec": "white",
                "mew": 0.6,
                "zorder": 4,
                "clip_on": False,
            }
            axes.plot(way[k], energy[k], "o", **dot)
            if ends == "gripped":
                axes.annotate(
                    f"{crossings[k - 1]:.0f} → {crossings[k]:.0f} crossings", (way[k], energy[k]),
                    xytext=(4, 5), textcoords="offset points", fontsize=6.5,
                )  # fmt: skip
    if move == "R1":
        planar = np.linspace(0.0, 0.32, 60)
        loop = [planar_loop(LOOP[0] + d).energy for d in planar]
        axes.plot(planar, loop, color=panels.MUTED, linewidth=0.9, linestyle=":", label="planar elastica")
        axes.legend(frameon=False, fontsize=6.5, handlelength=2.0, loc="lower left")
    axes.set(xlabel="way of moved ends / L", ylabel="energy (B/L)" if move == "R1" else None)
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.02)


def draw_shapes(before: Any, after: Any, result: Result) -> None:
    """The strands of a move as they are seen along z, at rest before it and after it, coloured by strain."""
    data = result.dataset
    cuts = np.asarray(data["node_start"].values, np.int64)[1:-1]
    first = int(np.searchsorted(data["time"], data.attrs["move_from_s"] * (1 - 1e-9)))
    h, L = float(data.attrs["radius"]), Reidemeister.report(result)["length_m"]
    for axes, k in ((before, first), (after, -1)):
        strands = np.split(data["position"].values[k].astype(float), cuts)
        strain = np.split(data["log_strain"].values[k].astype(float), cuts)
        options: dict[str, Any] = {"values": strain, "size": SIZE, "direction": ALONG_Z}
        image = picture(strands, False, h, bar=False, fill=_fill([x / h for x in strands], L / h), **options)
        axes.imshow(image, interpolation="antialiased")
        axes.axis("off")


def _fill(strands: list[Floats], length: float) -> float:
    """How much of a frame the knot takes when the frame is a little wider than the length; all in radii."""
    middle = np.concatenate(strands).mean(axis=0)
    curves = [smooth_centerline(x - middle, False, SAMPLE) for x in strands]
    body = np.concatenate(knot_body(curves, [False] * len(curves), 1.0))
    alone = frame(body, 1.0, SIZE, np.array([1.0, 0.0, 0.0]), np.array(ALONG_Z), 1.0).half_height
    return alone / (0.5 * WIDTH * length * SIZE[1] / SIZE[0])
