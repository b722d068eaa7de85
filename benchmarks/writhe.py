"""Time of the writhe of a closed polygon against its number of nodes, beside plain numpy.

The polygon is a trefoil on a torus. Times are on the clock on the wall, because threads share the work of
large polygons. Plain numpy forms arrays of all pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks import common
from torsade.topology.measures import writhe

SIZES = (100, 400, 1_000, 4_000, 10_000)
NUMPY_UP_TO = 2_000
"""Nodes up to which plain numpy is timed: its arrays take 400 bytes for every pair."""


def trefoil(n: int) -> np.ndarray:
    """T(2, 3) on a torus of radii 2 and 1; shape (n, 3)."""
    t = 2 * np.pi * np.arange(n) / n
    r = 2 + np.cos(3 * t)
    return np.stack([r * np.cos(2 * t), r * np.sin(2 * t), np.sin(3 * t)], axis=1)


def plain(x: np.ndarray) -> float:
    """The same sum in plain numpy: two arctangents for every pair of edges, over arrays of all pairs."""
    n = len(x)
    p, q = x, np.roll(x, -1, axis=0)
    i, j = np.triu_indices(n, 2)
    i, j = i[j - i < n - 1], j[j - i < n - 1]
    a, b, c, d = (
        r / np.linalg.norm(r, axis=1, keepdims=True)
        for r in (p[j] - p[i], q[j] - p[i], q[j] - q[i], p[j] - q[i])
    )
    total = 0.0
    for u, v, w in ((a, b, c), (a, c, d)):
        dots = [np.einsum("ec,ec->e", r, s) for r, s in ((u, v), (v, w), (w, u))]
        total -= np.arctan2(np.einsum("ec,ec->e", u, np.cross(v, w)), 1 + sum(dots)).sum()
    return float(total / np.pi)


def measure(n: int, repeats: int) -> dict[str, float]:
    """Times of one size; that of plain numpy is left out where it would take too much memory."""
    x = trefoil(n)
    pairs = n * (n - 3) / 2
    one = common.seconds(lambda: writhe(x, True, threads=1), repeats, common.WALL)
    row = {
        "nodes": n,
        "ms": 1e3 * one,
        "ns_per_pair": 1e9 * one / pairs,
        "ms_two_threads": 1e3 * common.seconds(lambda: writhe(x, True, threads=2), repeats, common.WALL),
    }
    if n <= NUMPY_UP_TO:
        row["ms_numpy"] = 1e3 * common.seconds(lambda: plain(x), min(repeats, 3), common.WALL)
        row["off_numpy"] = abs(plain(x) - writhe(x, True))
    return row


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    given = common.parser(__doc__).parse_args(arguments)
    rows = [measure(n, 3 if given.quick else 15) for n in (SIZES[:2] if given.quick else SIZES)]
    heads = ("nodes", "ms", "ns/pair", "ms, two threads", "ms, numpy", "off from numpy")
    keys = ("nodes", "ms", "ns_per_pair", "ms_two_threads", "ms_numpy", "off_numpy")
    tables = [common.table(heads, [[row.get(k) for k in keys] for row in rows])]
    return common.show({"rows": rows}, tables, given.json)


if __name__ == "__main__":
    main()
