"""What an evaluation of the rates has to compute and move, beside what the machine can do; to 10^6 nodes.

Operations are counted by hand from the kernels: an addition, multiplication, division or square root is one
operation; every number that a loop reads or writes is counted once for every loop, as if nothing stayed in
registers between loops; indices count with the bytes they have. Counts are per node, listed pair, contact,
entry of the factor and product of two entries, and each kernel is a sum over these.
"""

from __future__ import annotations

import gc
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numba
import numpy as np

from benchmarks import common, kernels, step

PAGE = Path(__file__).parents[1] / "docs" / "cost.md"

UNITS = ("node", "pair", "contact", "entry", "product")


class Count(NamedTuple):
    """Operations and bytes of a kernel per unit, in the order of UNITS."""

    operations: tuple[float, ...]
    bytes: tuple[float, ...]


MODEL: dict[str, Count] = {
    "geometry": Count((19,), (120,)),
    "reference twist": Count((87,), (136,)),
    "elastic forces": Count((90,), (272,)),
    "contacts found": Count((0, 8, 5), (24, 24, 96)),
    "contact forces": Count((0, 0, 25), (0, 0, 288)),
    "drag found": Count((0, 0, 6), (0, 0, 120)),
    "matrix assembled": Count((1, 0, 11, 1), (16, 0, 256, 16)),
    "matrix factorised": Count((1, 0, 0, 9, 2), (64, 0, 0, 84, 28)),
    "substituted": Count((3, 0, 0, 6), (176, 0, 0, 36)),
    "torques of drag": Count((1, 0, 47), (40, 0, 304)),
    "spin": Count((22,), (162,)),
    "material angles": Count((26,), (96,)),
    "work and dissipation": Count((16,), (98,)),
    "stages": Count((36,), (352,)),
}
"""By kernel, named as in `benchmarks.kernels`; checking of contacts and of bodies is left out."""

SIZES = (1_000, 10_000, 100_000, 1_000_000)
CACHED, STREAMED = 1_500, 20_000_000
"""Numbers in the arrays of the two triads: they fit into the nearest cache, or into none."""


@numba.njit(fastmath={"contract"})
def _triad(times, a, b, c):  # type: ignore[no-untyped-def]
    for _ in range(times):
        for i in range(a.shape[0]):
            a[i] = b[i] + 0.5 * c[i]


@numba.njit(fastmath={"contract"})
def _fused(times, a):  # type: ignore[no-untyped-def]
    """Eight multiplications and additions on every number read."""
    for _ in range(times):
        for i in range(a.shape[0]):
            x = a[i]
            for _ in range(8):
                x = 0.999 * x + 0.001
            a[i] = x


@numba.njit(fastmath={"contract"})
def _one_by_one(times, a):  # type: ignore[no-untyped-def]
    """The same, on eight numbers that no vector holds."""
    p, q, r, s, t, u, v, w = a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7]
    for _ in range(times):
        p, q, r, s = p * q + 0.1, q * r - 0.1, r * s + 0.2, s * p - 0.2
        t, u, v, w = t * u + 0.1, u * v - 0.1, v * w + 0.2, w * t - 0.2
    a[0] = p + q + r + s + t + u + v + w


def limits(quick: bool) -> dict[str, float]:
    """What the machine can do: operations [1e9/s] and traffic [1e9 bytes/s], of one core."""
    at_least = 1e-3 if quick else 0.1
    small, large = CACHED, STREAMED // (100 if quick else 1)

    def traffic(n: int) -> float:
        a, b, c = (np.ones(n) for _ in range(3))
        return 24e-9 * n / common.in_loop(lambda times: _triad(times, a, b, c), at_least)

    numbers = np.linspace(0.1, 0.2, small)
    fused = 16e-9 * small / common.in_loop(lambda times: _fused(times, numbers), at_least)
    single = 16e-9 / common.in_loop(lambda times: _one_by_one(times, numbers), at_least)
    return {
        "operations, vectors": fused,
        "operations, one by one": single,
        "traffic, cache": traffic(small),
        "traffic, memory": traffic(large),
    }


def size(now: common.Moment) -> dict[str, float]:
    """How many units of each kind there are in one evaluation."""
    contacts, factor = now.near.contacts, now.factor
    return {
        "node": float(len(now.guess)),
        "pair": float(contacts.count[2]),
        "contact": float(now.contacts),
        "entry": float(len(factor.value)),
        "product": float(len(factor.tape)),
    }


def totals(units: dict[str, float]) -> dict[str, tuple[float, float]]:
    """Operations and bytes of every kernel in one evaluation."""
    many = [units[name] for name in UNITS]
    return {
        name: (
            sum(k * n for k, n in zip(count.operations, many, strict=False)),
            sum(k * n for k, n in zip(count.bytes, many, strict=False)),
        )
        for name, count in MODEL.items()
    }


def reached(quick: bool) -> dict[str, Any]:
    """Kernels of one evaluation of a rope of 250 nodes: counted, timed, and as shares of the limits."""
    motion = common.rope(250)
    motion.advance(1.0, 2 if quick else step.SETTLE)
    now = common.capture(motion)
    timed = kernels._Kernels(1e-6 if quick else 1e-3, 1 if quick else 31, not quick)
    kernels.evaluation(motion, now, timed)
    taken = timed.medians()
    taken["matrix factorised"] = max(1e-12, taken["matrix factorised"] - taken["matrix assembled"])
    units, limit = size(now), limits(quick)
    rows = []
    for name, (operations, moved) in totals(units).items():
        seconds = taken.get(name)
        rows.append(
            {
                "kernel": name,
                "operations_per_node": operations / units["node"],
                "bytes_per_node": moved / units["node"],
                "ns_per_node": None if seconds is None else 1e9 * seconds / units["node"],
                "of_operations": None
                if seconds is None
                else 1e-9 * operations / seconds / limit["operations, vectors"],
                "of_traffic": None if seconds is None else 1e-9 * moved / seconds / limit["traffic, cache"],
            }
        )
    whole = taken[kernels.WHOLE]
    operations, moved = (sum(row[key] for row in rows) for key in ("operations_per_node", "bytes_per_node"))
    rows.append(
        {
            "kernel": "evaluation",
            "operations_per_node": operations,
            "bytes_per_node": moved,
            "ns_per_node": 1e9 * whole / units["node"],
            "of_operations": 1e-9 * operations * units["node"] / whole / limit["operations, vectors"],
            "of_traffic": 1e-9 * moved * units["node"] / whole / limit["traffic, cache"],
        }
    )
    return {"units": units, "limits": limit, "rows": rows}


def _highest_bytes(anew: bool = False) -> int:
    """The most memory that this process had since the count was begun anew, where the system counts it."""
    status, counter = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    if anew and counter.exists():
        counter.write_text("5")
    lines = status.read_text().splitlines() if status.exists() else []
    found = [int(line.split()[1]) for line in lines if line.startswith("VmHWM")]
    return 1024 * found[0] if found else step._peak_bytes()


def scaled(nodes: int, steps: int, repeats: int) -> dict[str, float]:
    """Time of an evaluation and memory of a rope of so many nodes."""
    gc.collect()
    before = step._present_bytes()
    _highest_bytes(anew=True)
    motion = common.rope(nodes)
    made = step._present_bytes()
    motion.advance(1.0, step.SETTLE)
    taken, counts = step.timed(motion, steps, repeats)
    evaluations = counts["evaluations"]
    return {
        "nodes": nodes,
        "contacts": len(motion.measure().contacts),
        "evaluations": evaluations,
        "us_per_evaluation": 1e6 * taken / evaluations,
        "ns_per_node": 1e9 * taken / evaluations / nodes,
        "bytes_at_start": max(1.0, (made - before) / nodes),
        "bytes_at_peak": max(1.0, (_highest_bytes() - before) / nodes),
    }


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.0f} %"


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the tables into docs/cost.md")
    given = options.parse_args(arguments)
    common.rope(100).advance(1.0, 2)  # compile, or load what is compiled
    found = reached(given.quick)
    sizes = (100, 200) if given.quick else SIZES
    rows = [scaled(n, 16 if n < 10**5 else 3, 5 if n < 10**5 else 1) for n in sizes]
    exponents = {key: step.exponent(rows, key) for key in ("us_per_evaluation",)} | {
        "memory": 1.0 + step.exponent(rows[-2:], "bytes_at_peak")
    }
    units = found["units"]
    text = {
        "limits": common.table(
            ("limit of one core", "1e9/s"), [(name, value) for name, value in found["limits"].items()]
        ),
        "kernels": common.table(
            ("kernel", "operations/node", "bytes/node", "ns/node", "of operations", "of traffic"),
            [
                [r["kernel"], r["operations_per_node"], r["bytes_per_node"], r["ns_per_node"],
                 _share(r["of_operations"]), _share(r["of_traffic"])]
                for r in found["rows"]
            ],
        )
        + "\n\nPer node: "
        + ", ".join(f"{units[u] / units['node']:.2g} {p}" for u, p in PLURALS.items())
        + ".",
        "scaling": common.table(
            ("nodes", "contacts", "evaluations", "µs/evaluation", "ns/node-evaluation",
             "bytes/node, start", "bytes/node, peak"),
            [list(r.values()) for r in rows],
        )
        + f"\n\nTime of an evaluation grows as nodes to the power {exponents['us_per_evaluation']:.2f}, "
        f"memory to the power {exponents['memory']:.2f}.",
    }  # fmt: skip
    if given.write:
        for name, table in text.items():
            common.put(table, PAGE, f"cost-{name}")
    return common.show(found | {"scaling": rows, "exponents": exponents}, list(text.values()), given.json)


PLURALS = {
    "pair": "listed pairs",
    "contact": "contacts",
    "entry": "entries of the factor",
    "product": "products",
}


if __name__ == "__main__":
    main()
