"""Amphichiral knots tightened with a mirror symmetry kept: can the tight shape be its own mirror image?

Random closed curves with x(s + L/q) = Q x(s), of a few Fourier modes, are named. Those that are the knot in
question are shrunk, and made exactly symmetric again after every few steps. With q = 4, Q turns by a right
angle and reflects; with q = 2, Q = -1. Writes its table into docs/batteries.md, between marks, unless
`--no-write` is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.random import Generator

from benchmarks import common
from benchmarks.batteries import PAGE
from torsade.arrays import Floats
from torsade.curve import length, resample
from torsade.errors import TorsadeError
from torsade.knots.loops import tight_loop
from torsade.knots.ropelength import thickness
from torsade.knots.shrink import Relaxed, Settings, loops_of, relax
from torsade.topology.identify import identify_curves
from torsade.topology.isotopy import thinned

STUDIED = (("4_1", 4, 1500), ("6_3", 4, 5000), ("6_3", 2, 1500))
"""Knots, the order of Q, and how many curves are drawn."""

NODES = 240
SHRUNK, FINISHED = 8, 2
"""How many of the shortest curves are shrunk, and how many of the shortest of these to the end."""

LONGEST = 400.0
"""Ropelength of a curve that is looked at, at most."""

COARSE = Settings(30.0, 0.8, 10, 2e-2, 4)
SPACINGS = (0.35, 0.2)
TOLERANCE = 3e-3

Found = dict[str, Any]

MAPS = {2: -np.eye(3), 4: np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])}
"""Q, by its order."""


def symmetric(x: Floats, q: int) -> Floats:
    """The mean of a closed polygon (n, 3) and its images, laid on it; q divides n."""
    total, power = np.zeros_like(x), np.eye(3)
    for k in range(q):
        total += np.roll(x, -k * len(x) // q, axis=0) @ power
        power = power @ MAPS[q]
    return total / q


def random_curve(random: Generator, q: int) -> Floats:
    """A symmetric closed curve (NODES, 3): of each coordinate the modes that Q allows."""
    s = np.arange(NODES) / NODES

    def waves(modes: Sequence[int], damping: float) -> Any:
        size = [complex(*random.normal(size=2)) / (1 + damping * abs(k)) for k in modes]
        return sum(a * np.exp(2j * np.pi * k * s) for a, k in zip(size, modes, strict=True))

    if q == 2:
        return np.stack([waves((1, 3, 5, 7), 0.3).real for _ in range(3)], axis=1)
    flat, up = waves((1, -3, 5, -7, 9), 0.25), waves((2, 6, 10), 0.2)
    return np.stack([flat.real, flat.imag, 1.5 * up.real], axis=1)


def spaced(x: Floats, spacing: float, q: int) -> Floats:
    """A symmetric curve (n, 3) with nodes so far apart; q divides their number."""
    n = q * max(8, round(length(x, True) / spacing / q))
    return symmetric(resample(x, n=n, closed=True), q)


def relaxed(x: Floats, how: Settings, q: int) -> tuple[Floats, Relaxed]:
    found = relax(x, loops_of(np.array([len(x)])), how)
    return symmetric(found.x, q), found


def shrunk(x: Floats, q: int) -> tuple[Floats, float]:
    """With few nodes, spread anew as the curve shortens; and its energy, about its ropelength."""
    last = np.inf
    for _ in range(60):
        x, found = relaxed(spaced(x, 0.7, q), COARSE, q)
        now = length(x, True)
        if found.residual < COARSE.tolerance or now > 0.9995 * last:
            break
        last = now
    return x, found.energy


def finished(x: Floats, q: int) -> Floats:
    """Tight, at the resolution of other tight knots."""
    first, last = SPACINGS
    x, _ = relaxed(spaced(x, first, q), Settings(100.0, 0.3, 25, TOLERANCE), q)
    x = spaced(x, last, q)
    stiffness = 120 / last**2
    for share in (0.1, 1 / 3, 1.0):
        x, _ = relaxed(x, Settings(share * stiffness, 0.3, 50, TOLERANCE), q)
    return x


def named(x: Floats) -> str | None:
    """Which knot a curve is; None of one that is too long or passes through itself."""
    try:
        measured = thickness([x], 1)
        thick = measured.length < LONGEST * measured.radius
        return str(identify_curves([thinned(x)])) if thick else None
    except TorsadeError:
        return None


def study(knot: str, q: int, curves: int) -> Found:
    """How many curves were the knot, and the ropelengths that the best of them come to."""
    random = np.random.default_rng([q, 1])
    drawn = [random_curve(random, q) for _ in range(curves)]
    mine = [x / thickness([x], 1).radius for x in drawn if named(x) == knot]
    mine.sort(key=lambda x: length(x, True))
    coarse = [(energy, x) for x, energy in (shrunk(x, q) for x in mine[:SHRUNK]) if named(x) == knot]
    coarse.sort(key=lambda one: one[0])
    tight = [thickness([finished(x, q)]).ropelength for _, x in coarse[:FINISHED]]
    shipped = tight_loop(knot).ropelength
    return {
        "knot": knot,
        "order": q,
        "curves": curves,
        "found": len(mine),
        "ropelength": tight,
        "shipped": shipped,
    }


def table(rows: Sequence[Found]) -> str:
    cells = [
        [row["knot"], row["order"], row["curves"], row["found"], f"{min(row['ropelength']):.3f}"
         if row["ropelength"] else None, f"{row['shipped']:.3f}"] for row in rows
    ]  # fmt: skip
    return common.table(
        ["knot", "order of Q", "curves", "of the knot", "L/h, symmetric", "L/h, shipped"], cells
    )


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    parser = common.parser(__doc__)
    parser.add_argument("--no-write", action="store_true", help=f"leave {PAGE.name} as it is")
    options = parser.parse_args(arguments)
    studied = (("4_1", 4, 40),) if options.quick else STUDIED
    rows = [study(*one) for one in studied]
    if not (options.no_write or options.quick):
        common.put(table(rows), PAGE, "symmetric")
    return common.show({"symmetric": rows}, [table(rows)], options.json)


if __name__ == "__main__":
    main()
