"""What a picture of a movie takes: tubes moved in place, and beside it, the same moments drawn anew each.

Reported is processor time, one kind after the other: medians of one run.
"""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from benchmarks import common
from torsade.protocols import SnapTwist, Tighten
from torsade.results import Result
from torsade.view.colours import stress_colour
from torsade.view.film import movie
from torsade.view.moments import Moments
from torsade.view.scene import render

SIZE, QUICK_SIZE = (1280, 720), (128, 96)


def moving(result: Result, size: tuple[int, int], pictures: int) -> float:
    """Processor time [s] of a picture of a movie, with what is written on it and encoding."""
    ticks: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        movie(
            result.dataset,
            Path(folder) / "movie.mp4",
            seconds=1.0,
            fps=pictures,
            size=size,
            progress=lambda share, note: ticks.append(common.CLOCK()),
        )
    return statistics.median(b - a for a, b in pairwise(ticks[1:]))


def anew(result: Result, size: tuple[int, int], pictures: int) -> float:
    """Processor time [s] of a picture as `--picture` draws it, from one direction."""
    moments = Moments(result.dataset)
    options: dict[str, Any] = {"size": size, "direction": (0.0, 0.0, 1.0)}
    if moments.breaking:
        options["palette"] = stress_colour
    taken = []
    with tempfile.TemporaryDirectory() as folder:
        for k in range(pictures):
            moment = moments.at(
                moments.times[0] + (k + 0.5) / pictures * (moments.times[-1] - moments.times[0])
            )
            began = common.CLOCK()
            render(
                moment.strands, False, moments.radius, Path(folder) / "p.png", values=moment.values, **options
            )
            taken.append(common.CLOCK() - began)
    return statistics.median(taken)


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    given = common.parser(__doc__).parse_args(arguments)
    size, pictures = (QUICK_SIZE, 4) if given.quick else (SIZE, 24)
    frames = 10 if given.quick else 100
    results = {
        "rod that breaks": SnapTwist(duration="0.5 ms" if given.quick else None, frames=frames).run(),
        "overhand": Tighten(knot="overhand", duration="0.1 s", frames=frames).run(),
    }
    found: dict[str, Any] = {}
    for name, result in results.items():
        found[name] = {"anew_s": anew(result, size, pictures), "moved_s": moving(result, size, pictures)}
    rows = [
        (name, n["anew_s"], n["moved_s"], n["anew_s"] / n["moved_s"], 1.0 / n["moved_s"])
        for name, n in found.items()
    ]
    heads = ("movie", "drawn anew [s]", "moved [s]", "ratio", "pictures a second")
    return common.show(found, [common.table(heads, rows)], given.json)


if __name__ == "__main__":
    main()
