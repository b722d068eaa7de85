"""Equilibria: how errors fall with the number of edges, what they cost, and where the twisted arch gives way.

Writes its tables into docs/statics.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from benchmarks import common
from torsade.errors import TorsadeError
from torsade.motion.equilibrium import Bent, bent, bent_until
from torsade.motion.spectrum import lowest
from torsade.motion.supports import Fiber, Support, chain, controls_at, shape_along
from torsade.motion.trust import minimise

PAGE = Path(__file__).parents[1] / "docs" / "statics.md"
SIZES = (50, 100, 200, 400)
C_OVER_B = 1 / 1.3
MOST_TWIST = 2000.0
"""Beyond which nobody asks [deg]."""

ACROSS, NOWHERE = (False, True, True), (False, False, False)

Number = Callable[[int], float]


def elastica(d: float) -> tuple[float, float]:
    """Thrust L^2/B and largest curvature L of a hinged elastica, in elliptic integrals."""
    m = brentq(lambda m: 2 * ellipe(m) / ellipk(m) - 1 - d, 1e-9, 0.9)
    return 4 * ellipk(m) ** 2, 4 * math.sqrt(m) * ellipk(m)


def arch(edges: int, d: float, twist: float = 0.0) -> Bent:
    return bent(Fiber(1.0, edges, 1.0, C_OVER_B), d, twist)


def buckling(edges: int, first: Support, last: Support, near: float, torque: bool = False) -> float:
    """Thrust, or torque, at which a straight fiber buckles."""
    c = chain(Fiber(edges=edges), (first, last))
    x = shape_along(c, np.tile([1.0, 0.0, 0.0], (len(c.mass), 1)))

    def least(load: float) -> float:
        given = controls_at(c, torque=load) if torque else controls_at(c, force=(-load, 0.0, 0.0))
        return float(lowest(c, c.system(x, given))[0][0])

    return float(brentq(least, 0.6 * near, 1.2 * near))


def root(edges: int) -> float:
    """Curvature at the root of a cantilever under 10 B/L^2 across its tip."""
    c = chain(Fiber(edges=edges), (Support("fixed"), Support("free", NOWHERE)))
    shape = shape_along(c, np.tile([1.0, 0.0, 0.0], (edges + 1, 1)))
    shape = minimise(c, shape, controls_at(c, force=(0.0, 10.0, 0.0)))
    tangent = shape.edge / np.linalg.norm(shape.edge, axis=1)[:, None]
    return float(2 * math.tan(0.5 * math.acos(tangent[0] @ tangent[1])) / c.assembly.hinge_length[0])


def cases() -> dict[str, tuple[Number, float]]:
    """What is computed, and what is exact."""
    thrust, kappa = elastica(0.49)
    x = float(brentq(lambda x: math.tan(x) - x, 4.4, 4.6))
    hinge, clamp, pivot = Support(), Support("fixed"), Support("plane")
    twisted = (17.595 / 24, 2 * math.pi)
    return {
        "elastica, d/L = 0.49: largest curvature": (lambda n: arch(n, 0.49).kappa_max, kappa),
        "elastica, d/L = 0.49: thrust": (lambda n: arch(n, 0.49).thrust, thrust),
        "24 cm rod, ends 17.595 cm apart, 360°: largest curvature": (
            lambda n: arch(n, *twisted).kappa_max / 0.24,
            16.78441,
        ),
        "the same: thrust over Euler load": (lambda n: arch(n, *twisted).thrust / math.pi**2, 1.05428),
        "cantilever, P L²/B = 10: curvature at the root": (root, 4.45004402246),
        "Euler load, hinged": (
            lambda n: buckling(n, hinge, Support("free", ACROSS), math.pi**2),
            math.pi**2,
        ),
        "Euler load, one end free": (
            lambda n: buckling(n, clamp, Support("free", NOWHERE), math.pi**2 / 4),
            math.pi**2 / 4,
        ),
        "Euler load, clamped": (
            lambda n: buckling(n, clamp, Support("fixed", ACROSS), 4 * math.pi**2),
            4 * math.pi**2,
        ),
        "Euler load, clamped and hinged": (
            lambda n: buckling(n, clamp, Support("free", ACROSS), x * x),
            x * x,
        ),
        "Greenhill torque, pivots": (
            lambda n: buckling(n, pivot, Support("plane", ACROSS), 2 * math.pi, True),
            2 * math.pi,
        ),
        "Greenhill torque, clamps": (
            lambda n: buckling(n, clamp, Support("fixed", ACROSS), 2 * x, True),
            2 * x,
        ),
    }


def convergence(sizes: Sequence[int]) -> list[dict[str, Any]]:
    """Errors with so many edges, and the order at which they fall, by regression."""
    rows = []
    for name, (number, exact) in cases().items():
        errors = [number(n) / exact - 1 for n in sizes]
        order = -float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
        rows.append({"what": name, "exact": exact, "errors": errors, "order": order})
    return rows


def costs(edges: int, repeats: int) -> dict[str, float]:
    """Processor time [ms] of what is done most."""
    rod = Fiber(0.24, edges, 1.0, C_OVER_B)
    near = bent(rod, 0.19, 2.0)
    what: dict[str, Callable[[], object]] = {
        "planar arch from nothing": lambda: bent(rod, 0.19),
        "arch with 270° from nothing": lambda: bent(rod, 0.19, 1.5 * math.pi),
        "the same, 9° from a neighbour": lambda: bent(rod, 0.19, 2.157, near),
        "end distance at a curvature, near a neighbour": lambda: bent_until(rod, near.kappa_max, 2.157, near),
        "least eigenvalue": near.stiffness,
    }
    return {name: 1e3 * common.seconds(call, repeats) for name, call in what.items()}


def limits(edges: int, distances: Sequence[float]) -> list[dict[str, float]]:
    """Total twist [deg] at which the arch loses its symmetry, and at which it snaps."""
    rows = []
    for d in distances:
        fiber = Fiber(1.0, edges, 1.0, C_OVER_B)
        try:
            bent(fiber, d, math.radians(MOST_TWIST))
            snaps = MOST_TWIST
        except TorsadeError as error:
            snaps = float(str(error).split("snaps at ")[1].split(" deg")[0])
        last = 0.999 * math.radians(min(snaps, 450.0))
        stable = bent(fiber, d, last).stable
        lost = (
            math.nan
            if stable
            else float(brentq(lambda t, f=fiber, d=d: bent(f, d, t).stiffness(), 1.0, last))
        )
        rows.append({"end_distance": d, "symmetric_until": math.degrees(lost), "snaps_at": snaps})
    return rows


def tables(found: dict[str, Any]) -> dict[str, str]:
    """Of the page, by the name of their marks."""
    heads = ["", "exact", *(f"{n} edges" for n in found["sizes"]), "order"]
    body = [
        [r["what"], f"{r['exact']:.7g}", *(f"{e:+.1e}" for e in r["errors"]), f"{r['order']:.2f}"]
        for r in found["convergence"]
    ]
    times = [[name, f"{ms:.1f}"] for name, ms in found["ms"].items()]
    gives = [
        [
            f"{r['end_distance']:g}",
            *("-" if math.isnan(r[k]) else f"{r[k]:.1f}°" for k in ("symmetric_until", "snaps_at")),
        ]
        for r in found["limits"]
    ]
    for row, r in zip(gives, found["limits"], strict=True):
        if r["snaps_at"] == MOST_TWIST:
            row[2] = f"beyond {MOST_TWIST:g}°"
    return {
        "convergence": common.table(heads, body),
        "cost": common.table(["", "ms"], times),
        "limits": common.table(["end distance / L", "symmetric until", "snaps at"], gives),
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/statics.md as it is")
    given = options.parse_args(arguments)
    sizes = (20, 40) if given.quick else SIZES
    found = {
        "sizes": list(sizes),
        "convergence": convergence(sizes),
        "ms": costs(sizes[-1] // 2, 2 if given.quick else 20),
        "limits": limits(40, [0.5])
        if given.quick
        else limits(200, [0.999, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.25, 0.0]),
    }
    text = tables(found)
    if not (given.quick or given.no_write):
        for name, table in text.items():
            common.put(table, PAGE, name)
    return common.show(found, list(text.values()), given.json)


if __name__ == "__main__":
    main()
