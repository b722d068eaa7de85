"""Time to name a knot, from a curve of 200 nodes and from a code, beside SnapPy and pyknotid where they run.

Curves are closed braids turned at random. SnapPy is asked for
the name of the exterior of the same code, which it has for hyperbolic knots, and pyknotid for the names
that the same curve may have. Times are on the clock on the wall.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks import common
from torsade.topology import braid_curves, from_text, identify, identify_curves, project, simplify
from torsade.topology.codes import to_pd

BRAIDS = {
    "3_1": [1, 1, 1],
    "4_1": [1, -2, 1, -2],
    "8_19": [1, 1, 1, 2, 1, 1, 1, 2],
    "9_35": [1, 1, 2, -1, 2, 2, 3, -2, -2, 4, -3, 2, 4, 3],
    "10_103": [-1, -1, -2, 1, 3, -2, -2, 3, -2, -2, 3],
    "L6a4": [1, -2, 1, -2, 1, -2],
    "3_1#m3_1": [1, 1, 1, -2, -2, -2],
}
NODES = 200
TURNS = 20
"""Directions from which each curve is seen."""


def turned(word: Sequence[int], seed: int) -> list[np.ndarray]:
    """The closure of a braid in space, turned at random."""
    rotation = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    return [x @ rotation.T for x in braid_curves(word, nodes=NODES)]


def measure(name: str, word: Sequence[int], turns: int, repeats: int) -> dict[str, Any]:
    """Times of one knot: its curve seen from several directions, and its code."""
    curves = [turned(word, seed) for seed in range(turns)]
    times = [common.seconds(lambda x=x: identify_curves(x), repeats, common.WALL) for x in curves]  # type: ignore[misc]
    drawn = [project(x, True).diagram for x in curves]
    code = from_text("{" + ",".join(map(str, word)) + "}")
    return (
        {
            "name": name,
            "found": sum(str(identify(d)) == name for d in drawn) / turns,
            "crossings_seen": statistics.median(d.n_crossings for d in drawn),
            "ms_curve": 1e3 * statistics.median(times),
            "ms_curve_slowest": 1e3 * max(times),
            "ms_code": 1e3 * common.seconds(lambda: identify(code), repeats, common.WALL),
        }
        | _snappy(code, repeats)
        | _pyknotid(curves[0], repeats)
    )


def _snappy(code: Any, repeats: int) -> dict[str, float]:
    """Time of SnapPy for the exterior of the same code and its name in the census."""
    try:
        import snappy
    except ImportError:
        return {}
    pd = to_pd(simplify(code))
    return {
        "ms_snappy": 1e3 * common.seconds(lambda: snappy.Link(pd).exterior().identify(), repeats, common.WALL)
    }


def _pyknotid(curves: list[np.ndarray], repeats: int) -> dict[str, float]:
    """Time of pyknotid for the candidates of the same curve."""
    try:
        from pyknotid.spacecurves import Knot
    except ImportError:
        return {}
    if len(curves) > 1:
        return {}
    return {
        "ms_pyknotid": 1e3
        * common.seconds(lambda: Knot(curves[0], verbose=False).identify(), repeats, common.WALL)
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    given = common.parser(__doc__).parse_args(arguments)
    turns, repeats = (2, 1) if given.quick else (TURNS, 5)
    chosen = list(BRAIDS.items())[:3] if given.quick else list(BRAIDS.items())
    rows = [measure(name, word, turns, repeats) for name, word in chosen]
    heads = ("knot", "right", "crossings seen", "ms, curve", "slowest view", "ms, code", "SnapPy", "pyknotid")
    keys = ("name", "found", "crossings_seen", "ms_curve", "ms_curve_slowest", "ms_code")
    keys += ("ms_snappy", "ms_pyknotid")
    tables = [common.table(heads, [[row.get(k) for k in keys] for row in rows])]
    return common.show({"rows": rows}, tables, given.json)


if __name__ == "__main__":
    main()
