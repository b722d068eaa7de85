"""Time until the first answer: with nothing compiled yet, with everything compiled, and of the help."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from typing import Any

from benchmarks import common

RUN = ("run", "prison-escape", "--knot", "reef", "--duration", "0.01 s", "--json")


def wall(command: Sequence[str], cache: str | None = None) -> float:
    """Wall time [s] of a torsade command in a process of its own."""
    environment = dict(os.environ)
    if cache is not None:
        environment["TORSADE_CACHE_DIR"] = cache
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "torsade", *command], env=environment, capture_output=True, check=False
    )
    taken = time.perf_counter() - began
    if done.returncode != 0:
        raise RuntimeError(f"torsade {' '.join(command)} failed: {done.stderr.decode().strip()}")
    return taken


def cold() -> float:
    """Wall time [s] of a run with an empty cache of kernels."""
    with tempfile.TemporaryDirectory() as cache:
        return wall(RUN, cache)


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    given = common.parser(__doc__).parse_args(arguments)
    if given.quick:
        found: dict[str, Any] = {"help_s": wall(["--help"])}
        return common.show(found, [f"torsade --help: {found['help_s']:.2f} s"], given.json)
    wall(RUN)
    found = {
        "help_s": statistics.median(wall(["--help"]) for _ in range(9)),
        "warm_s": statistics.median(wall(RUN) for _ in range(5)),
        "cold_s": statistics.median(cold() for _ in range(3)),
    }
    rows = [
        ("`torsade --help`", found["help_s"], found["help_s"] / found["warm_s"]),
        ("warm start", found["warm_s"], 1.0),
        ("cold start, compiling", found["cold_s"], found["cold_s"] / found["warm_s"]),
    ]
    heads = ("command", "wall time [s]", "relative to a warm start")
    return common.show(found, [common.table(heads, rows)], given.json)


if __name__ == "__main__":
    main()
