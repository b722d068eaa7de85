"""Many runs at once in the threads of one process, beside the same runs one after another.

Writes its table into docs/sweeps.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.protocols import PrisonEscape, SnapTwist, Spec, ensemble

PAGE = Path(__file__).parents[1] / "docs" / "sweeps.md"

HEADS = ("runs", "threads", "one after another [s]", "together [s]", "ratio", "same bits")


def bends(count: int) -> list[Spec]:
    """Reefs pulled for a fifth of a second, each with another force."""
    return [PrisonEscape(knot="reef", force=f, duration=0.2, frames=4) for f in np.linspace(5, 20, count)]


def cascades(count: int) -> list[Spec]:
    """Rods whose strength scatters."""
    return [SnapTwist(twist="60 deg", disorder=0.05, seed=k, frames=1) for k in range(count)]


def timed(call: Callable[[], list[Any]]) -> tuple[float, list[Any]]:
    """Wall time of a call [s] and what it gave."""
    began = common.WALL()
    found = call()
    return common.WALL() - began, found


def compare(name: str, specs: Sequence[Spec], threads: int, rounds: int) -> dict[str, Any]:
    """Times of the two ways, in turn, as medians."""
    ensemble(specs[:1])
    alone, together, same = [], [], True
    for _ in range(rounds):
        taken, singles = timed(lambda: [spec.run() for spec in specs])
        alone.append(taken)
        taken, members = timed(lambda: ensemble(specs, threads))
        together.append(taken)
        same &= all(
            np.array_equal(one.dataset["position"], other.dataset["position"], equal_nan=True)
            for one, other in zip(singles, members, strict=True)
        )
    one, other = statistics.median(alone), statistics.median(together)
    return {
        "runs": f"{len(specs)} {name}",
        "threads": threads,
        "alone_s": one,
        "together_s": other,
        "ratio": one / other,
        "same": same,
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave docs/sweeps.md as it is")
    options.add_argument("--threads", type=int, default=2, help="how many runs at a time")
    given = options.parse_args(arguments)
    rounds = 1 if given.quick else 3
    rows = [
        compare("bends, 0.2 s each", bends(2 if given.quick else 16), given.threads, rounds),
        compare("cascades", cascades(2 if given.quick else 64), given.threads, rounds),
    ]
    body = [[*list(row.values())[:-1], "yes" if row["same"] else "no"] for row in rows]
    text = common.table(HEADS, body)
    if not (given.quick or given.no_write):
        common.put(text, PAGE, "ensembles")
    return common.show({"rows": rows}, [text], given.json)


if __name__ == "__main__":
    main()
