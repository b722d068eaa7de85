"""Time per step and per evaluation of the rates against the number of nodes, and memory per node.

A rope of two strands in contact all along (see `common.rope`) is pulled with the standard laws and
error-controlled steps. Every size is the same rope, longer, so contacts grow in proportion.
"""

from __future__ import annotations

import resource
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import common
from torsade.motion.overdamped import Motion

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"

SIZES = (100, 250, 1_000, 10_000, 100_000)
SETTLE = 24
"""Steps before the clock starts; by then the strands touch all along."""

STEPS = 16


def _peak_bytes() -> int:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


def _present_bytes() -> int:
    status = Path("/proc/self/statm")
    if not status.exists():
        return _peak_bytes()
    return int(status.read_text().split()[1]) * resource.getpagesize()


def timed(motion: Motion, steps: int, repeats: int) -> tuple[float, dict[str, int]]:
    """Median time of the same steps, taken again and again [s], and what was counted in them."""
    start, counts = motion.checkpoint(), motion.counts
    taken = []
    for _ in range(repeats):
        motion.restore(start)
        began = common.CLOCK()
        motion.advance(1.0, steps)
        taken.append(common.CLOCK() - began)
    return statistics.median(taken), {k: n - counts[k] for k, n in motion.counts.items()}


def measure(nodes: int, repeats: int) -> dict[str, float]:
    """Medians of the same steps taken again and again."""
    before = _present_bytes()
    motion = common.rope(nodes)
    motion.advance(1.0, SETTLE)
    wall, done = timed(motion, STEPS, repeats)
    return {
        "nodes": nodes,
        "contacts": len(motion.measure().contacts),
        "evaluations_per_step": done["evaluations"] / done["steps"],
        "us_per_step": 1e6 * wall / done["steps"],
        "us_per_evaluation": 1e6 * wall / done["evaluations"],
        "ns_per_node_step": 1e9 * wall / done["steps"] / nodes,
        "ns_per_node_evaluation": 1e9 * wall / done["evaluations"] / nodes,
        "bytes_per_node": (_peak_bytes() - before) / nodes,
    }


def euler(nodes: int, steps: int, repeats: int, dt: float = 2e-6) -> float:
    """Time [us] of an explicit step: one evaluation of the rates, and all that goes with a step."""
    settled = common.rope(nodes)
    settled.advance(1.0, SETTLE)
    motion = common.rope(nodes, fixed_step=dt)
    motion.restore(settled.checkpoint())
    start = motion.checkpoint()

    def run() -> None:
        motion.restore(start)
        motion.advance(1.0, steps)

    return 1e6 * common.seconds(run, repeats) / steps


def exponent(rows: Sequence[dict[str, float]], key: str) -> float:
    """Slope of log(key) against log(nodes)."""
    nodes = np.log([row["nodes"] for row in rows])
    return float(np.polyfit(nodes, np.log([row[key] for row in rows]), 1)[0])


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    given = options.parse_args(arguments)
    sizes = (100, 250) if given.quick else SIZES
    repeats = 3 if given.quick else 9
    common.rope(100).advance(1.0, 30)  # compile, or load what is compiled
    rows = [measure(n, repeats) for n in sizes]
    found = {
        "rows": rows,
        "exponent_step": exponent(rows, "us_per_step"),
        "exponent_evaluation": exponent(rows, "us_per_evaluation"),
        "us_per_euler_step_250": euler(250, 50 if given.quick else 2000, repeats),
    }
    heads = (
        "nodes", "contacts", "evaluations/step", "µs/step", "µs/evaluation", "ns/node-step",
        "ns/node-evaluation",
    )  # fmt: skip
    keys = (
        "nodes", "contacts", "evaluations_per_step", "us_per_step", "us_per_evaluation", "ns_per_node_step",
        "ns_per_node_evaluation",
    )  # fmt: skip
    at_250 = next(row for row in rows if row["nodes"] == 250)
    largest = rows[-1]
    tables = [
        common.table(heads, [[row[k] for k in keys] for row in rows]),
        f"exponent of time against nodes: {found['exponent_step']:.2f} per step, "
        f"{found['exponent_evaluation']:.2f} per evaluation\n"
        f"250 nodes, {at_250['contacts']} contacts: {at_250['us_per_evaluation']:.1f} µs per evaluation, "
        f"{at_250['us_per_step']:.0f} µs per error-controlled step of "
        f"{at_250['evaluations_per_step']:.1f} evaluations, {found['us_per_euler_step_250']:.1f} µs per "
        f"explicit step of one evaluation\n"
        f"peak memory at {largest['nodes']:,} nodes: {largest['bytes_per_node'] / 1e3:.2f} kB per node",
    ]
    if given.write:
        common.put("\n\n".join(tables), PAGE, "steps")
    return common.show(found, tables, given.json)


if __name__ == "__main__":
    main()
