"""Many runs at once in the threads of one process, beside the same runs one after another.

Writes tables into docs/sweeps.md and docs/performance.md, between marks, unless `--no-write` is given.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks import common
from torsade._compile import Kernel
from torsade.protocols import PrisonEscape, SnapQuench, SnapTwist, Spec, ensemble

DOCS = Path(__file__).parents[1] / "docs"

HEADS = (
    "runs",
    "threads",
    "one after another [s]",
    "one thread [s]",
    "together [s]",
    "over one after another",
    "over one thread",
    "same bits",
)
SHARES = ("a run of", "processor time [ms]", "in compiled loops", "calls of them")


def bends(count: int) -> list[Spec]:
    """Reefs pulled for a fifth of a second, each with another force."""
    return [PrisonEscape(knot="reef", force=f, duration=0.2, frames=4) for f in np.linspace(5, 20, count)]


def cascades(count: int) -> list[Spec]:
    """Twisted rods whose strength scatters."""
    return [SnapTwist(twist="60 deg", disorder=0.05, seed=k, frames=1) for k in range(count)]


def quenches(count: int) -> list[Spec]:
    """Rods driven together whose strength scatters."""
    return [SnapQuench(speed="0.5 m/s", disorder=0.05, seed=k, frames=1) for k in range(count)]


def timed(call: Callable[[], list[Any]]) -> tuple[float, list[Any]]:
    """Wall time of a call [s] and what it gave."""
    began = common.WALL()
    found = call()
    return common.WALL() - began, found


def compare(name: str, specs: Sequence[Spec], threads: int, rounds: int) -> dict[str, Any]:
    """Times of the three ways, in turn, as medians."""
    ensemble(specs[:1])
    alone, single, together, same = [], [], [], True
    for _ in range(rounds):
        taken, singles = timed(lambda: [spec.run() for spec in specs])
        alone.append(taken)
        single.append(timed(lambda: ensemble(specs, 1))[0])
        taken, members = timed(lambda: ensemble(specs, threads))
        together.append(taken)
        same &= all(
            np.array_equal(one.dataset["position"], other.dataset["position"], equal_nan=True)
            for one, other in zip(singles, members, strict=True)
        )
    one, thread, many = (statistics.median(taken) for taken in (alone, single, together))
    return {
        "runs": f"{len(specs)} {name}",
        "threads": threads,
        "alone_s": one,
        "one_thread_s": thread,
        "together_s": many,
        "over_alone": one / many,
        "over_one_thread": thread / many,
        "same": same,
    }


def shares(name: str, specs: Sequence[Spec]) -> dict[str, Any]:
    """Processor time of a run, and how much of it goes into compiled loops, which let other threads go on.

    Taking arguments apart and handing results back counts with the loops, though other threads wait for it.
    """
    call, inside, calls = Kernel.__call__, 0.0, 0

    def timed(kernel: Kernel, *arguments: Any) -> Any:
        nonlocal inside, calls
        began = common.CLOCK()
        try:
            return call(kernel, *arguments)
        finally:
            inside += common.CLOCK() - began
            calls += 1

    whole = common.seconds(lambda: [spec.run() for spec in specs], 3)
    with patch.object(Kernel, "__call__", timed):
        began = common.CLOCK()
        for spec in specs:
            spec.run()
        watched = common.CLOCK() - began
    return {
        "protocol": name,
        "run_ms": 1e3 * whole / len(specs),
        "share": inside / watched,
        "calls": round(calls / len(specs)),
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--no-write", action="store_true", help="leave the pages of docs/ as they are")
    options.add_argument("--threads", type=int, default=2, help="how many runs at a time")
    options.add_argument("--rounds", type=int, default=3, help="how often each way is timed")
    given = options.parse_args(arguments)
    rounds, few = (1, 2) if given.quick else (given.rounds, 0)
    families = (
        ("bends, 0.2 s each", bends(few or 16)),
        ("cascades, twisted", cascades(few or 200)),
        ("cascades, quenched", quenches(few or 20)),
    )
    rows = [compare(name, specs, given.threads, rounds) for name, specs in families]
    body = [[*list(row.values())[:-1], "yes" if row["same"] else "no"] for row in rows]
    inside = [shares(name, specs[:10]) for name, specs in families]
    parts = [[r["protocol"], r["run_ms"], f"{100 * r['share']:.0f} %", r["calls"]] for r in inside]
    texts = [common.table(HEADS, body), common.table(SHARES, parts)]
    if not (given.quick or given.no_write):
        common.put(texts[0], DOCS / "sweeps.md", "ensembles")
        common.put(texts[1], DOCS / "performance.md", "ensembles")
    return common.show({"rows": rows, "shares": inside}, texts, given.json)


if __name__ == "__main__":
    main()
