"""Breaking rods: pieces against twist and speed, how they change with the mesh, and how far curvature rises.

Writes its tables into docs/fracture.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.errors import TorsadeError
from torsade.fracture.cascade import Cascade
from torsade.fracture.fits import power_law
from torsade.fracture.statistics import Mean, mean
from torsade.protocols import SnapQuench, SnapTwist

PAGE = Path(__file__).parents[1] / "docs" / "fracture.md"
DEGREES = tuple(range(0, 360, 10))
MESHES = (40, 50, 60, 70, 80, 100, 120, 200)
NEAR_LAMBDA = (40, 48, 56, 50, 44, 52, 54)
"""Numbers of edges in the order of the shortest piece that exceeds 30 mm."""

AWAY = 0.02
"""Distance from the break and from the ends beyond which the rise of curvature is looked at [m]."""

STEPS = 4000
"""Moments at which it is looked at."""


def twisted(degrees: float, **fields: Any) -> Cascade | None:
    """A rod after its cascade; None when twist alone breaks it."""
    spec = SnapTwist(twist=f"{degrees} deg", **fields)
    try:
        cascade, _ = spec.broken()
    except TorsadeError:
        return None
    cascade.advance(spec.lasting)
    return cascade


def counts(edges: int, degrees: Iterable[int]) -> list[int]:
    """Pieces at every twist [deg], without disorder."""
    return [len(c.lengths) for c in (twisted(d, edges=edges) for d in degrees) if c is not None]


def intervals(found: Sequence[int], degrees: Sequence[int], pieces: int) -> str:
    """At which twists a rod breaks into so many pieces, in words."""
    spans = []
    for same, group in groupby(zip(degrees, found, strict=True), key=lambda pair: pair[1] == pieces):
        span = [degree for degree, _ in group]
        if same:
            last = span[-1] == degrees[-1]
            spans.append(f"from {span[0]}°" if last and len(span) > 1 else f"{span[0]} to {span[-1]}°")
    return ", ".join(spans) or "-"


def shortest(edges: int) -> float:
    """Length [mm] of the shortest piece of whole edges that exceeds 30 mm."""
    l = 240 / edges
    return l * (int(30 / l + 1e-9) + 1)


def rise(edges: int, degrees: float) -> tuple[float, float]:
    """Largest curvature over that at the break: in half the time of the peak to the end, and in all of it."""
    spec = SnapTwist(twist=f"{degrees} deg", edges=edges, min_fragment="240 mm")
    cascade, found = spec.broken()
    a = cascade.motion.assembly
    place = np.cumsum(a.rest_length)[a.hinges[:, 0]]
    inside = (np.abs(place - 0.12) >= AWAY) & (np.minimum(place, 0.24 - place) >= AWAY)
    largest = []
    for k in range(STEPS):
        cascade.advance((k + 1) * spec.lasting / STEPS)
        cascade.measure()
        largest.append(float(cascade.kappa()[inside].max()))
    kappa = found["critical_curvature_per_m"]
    return max(largest[: STEPS // 2]) / kappa, max(largest) / kappa


def disordered(degrees: float, disorder: float, rods: int) -> dict[str, Any]:
    """What many rods break into whose strength scatters."""
    kappa, pieces = [], []
    for seed in range(rods):
        cascade = twisted(degrees, disorder=disorder, seed=seed)
        if cascade is not None:
            kappa.append(cascade.breaks[0].kappa)
            pieces.append(len(cascade.lengths))
    return {
        "pieces": mean(pieces) if pieces else None,
        "two": 100 * pieces.count(2) / len(pieces) if pieces else None,
        "odd": 100 * sum(n % 2 for n in pieces) / len(pieces) if pieces else None,
        "kappa": float(np.mean(kappa)) if pieces else None,
        "by_twist": rods - len(pieces),
    }


def quenched(speed: float, law: str, rods: int) -> dict[str, Mean]:
    """Pieces and smallest pieces [mm] of rods broken at a speed [mm/s], strengths scattering by 0.05."""
    pieces, least = [], []
    for seed in range(rods):
        spec = SnapQuench(speed=f"{speed} mm/s", fragment_law=law, disorder=0.05, seed=seed)
        cascade = spec.driven()
        cascade.advance(spec.lasting)
        pieces.append(len(cascade.lengths))
        least.append(1e3 * float(cascade.lengths.min()))
    return {"pieces": mean(pieces), "least": mean(least)}


def _shown(m: Mean | None) -> str:
    """A mean with its standard error in brackets, in units of the last digit."""
    if m is None:
        return "broken by twist"
    error = 0.0 if np.isnan(m.error) else m.error
    return f"{m.value:.2f} ({round(100 * error)})" if error else f"{m.value:.2f}"


def tables(found: dict[str, Any]) -> dict[str, str]:
    """Of the page, by the name of their marks."""
    degrees = found["degrees"]
    pieces = [
        [str(n), *(intervals(c, degrees[: len(c)], k) for k in (6, 4, 2))] for n, c in found["counts"].items()
    ]
    near = [
        [str(n), f"{shortest(n):.1f} mm", intervals(c, degrees[: len(c)], 4)]
        for n, c in found["near_lambda"].items()
    ]
    heads = ["edges", *(f"{d}°" for d in found["rise_at"])]
    risen = [
        [str(n), *(f"{half:.2f}" + (f" ({all_:.2f})" if all_ - half > 0.005 else "") for half, all_ in row)]
        for n, row in found["rise"].items()
    ]
    scattered = []
    for d, (five, ten) in found["disordered"].items():
        share = [("-" if five[k] is None else f"{five[k]:.0f} %") for k in ("two", "odd")]
        kappa = "-" if five["kappa"] is None else f"{five['kappa']:.1f}"
        two = "-" if ten["two"] is None else f"{ten['two']:.0f} %"
        lost = [f"{five['by_twist']}", f"{ten['by_twist']}"]
        scattered.append(
            [f"{d}°", _shown(five["pieces"]), *share, kappa, lost[0], _shown(ten["pieces"]), two, lost[1]]
        )
    speeds = [
        [f"{v:g} mm/s", _shown(c["pieces"]), _shown(q["pieces"]), f"{q['least'].value:.0f} mm"]
        for v, (c, q) in found["quenched"].items()
    ]
    by = ["by twist alone"]
    return {
        "counts": common.table(["edges", "six pieces", "four", "two"], pieces),
        "near": common.table(["edges", "shortest piece", "four pieces"], near),
        "rise": common.table(heads, risen),
        "disorder": common.table(
            ["twist", "pieces, disorder 0.05", "in two", "odd", "mean limit curvature, 1/m", *by,
             "pieces, disorder 0.1", "in two", *by],
            scattered,
        ),
        "speeds": common.table(
            ["speed", "pieces, λ constant", "pieces, λ falling as v^(−1/4)", "mean of the shortest piece"],
            speeds,
        ),
    }  # fmt: skip


def powers(quench: dict[float, Any]) -> dict[str, Any]:
    """Powers of the speed up to 100 mm/s, with intervals of 95 %, of breaks and of shortest pieces."""
    v = [speed for speed in quench if speed <= 100]
    if len(v) < 3:
        return {}
    scaled = [quench[speed][1] for speed in v]
    fits = {
        "breaks": power_law(v, [q["pieces"].value - 1 for q in scaled]),
        "least": power_law(v, [q["least"].value for q in scaled]),
    }
    return {name: fit.parameters["exponent"]._asdict() for name, fit in fits.items()}


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/fracture.md as it is")
    given = options.parse_args(arguments)
    quick = given.quick
    degrees = (0, 300) if quick else DEGREES
    rods = 2 if quick else 30
    at, twists, speeds = ((0,), (0,), (100.0,)) if quick else (
        (0, 120, 200, 250, 300), (0, 60, 120, 180, 220, 250, 280, 310), (1.0, 3.0, 10.0, 30.0, 100.0, 500.0)
    )  # fmt: skip
    found: dict[str, Any] = {
        "degrees": list(degrees),
        "counts": {n: counts(n, degrees) for n in ((50,) if quick else MESHES)},
        "near_lambda": {n: counts(n, degrees) for n in ((48,) if quick else NEAR_LAMBDA)},
        "rise_at": list(at),
        "rise": {n: [rise(n, d) for d in at] for n in ((50,) if quick else (50, 100, 200, 400))},
        "disordered": {d: (disordered(d, 0.05, rods), disordered(d, 0.1, rods)) for d in twists},
        "quenched": {v: (quenched(v, "constant", rods), quenched(v, "quarter-power", rods)) for v in speeds},
    }
    found["powers"] = powers(found["quenched"])
    text = tables(found)
    if not (quick or given.no_write):
        for name, table in text.items():
            common.put(table, PAGE, name)
    return common.show(found, [*text.values(), str(found["powers"])], given.json)


if __name__ == "__main__":
    main()
