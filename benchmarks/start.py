"""Time until the first answer: of the help, with everything compiled, and with nothing compiled yet.

Writes a table into docs/performance.md, between marks, with `--write`.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks import common

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"

RUNS = {
    "10 ms of a reef": ("run", "prison-escape", "--knot", "reef", "--duration", "0.01 s", "--json"),
    "a rod that snaps": ("run", "snap-twist", "--json"),
}
HELP = ("--help",)


class Took(NamedTuple):
    """Time on the wall and of processors that a command took [s]."""

    wall: float
    processor: float


def took(command: Sequence[str], cache: str | None = None) -> Took:
    """Time of a torsade command in a process of its own."""
    environment = dict(os.environ)
    if cache is not None:
        environment["TORSADE_CACHE_DIR"] = cache
    began, before = common.WALL(), _of_children()
    done = subprocess.run(
        [sys.executable, "-m", "torsade", *command], env=environment, capture_output=True, check=False
    )
    taken = Took(common.WALL() - began, _of_children() - before)
    if done.returncode != 0:
        raise RuntimeError(f"torsade {' '.join(command)} failed: {done.stderr.decode().strip()}")
    return taken


def _of_children() -> float:
    """Processor time of all processes that were waited for [s]."""
    times = os.times()
    return times.children_user + times.children_system


def cold(command: Sequence[str]) -> Took:
    """Time of a run with an empty cache of kernels."""
    with tempfile.TemporaryDirectory() as cache:
        return took(command, cache)


def median(times: Sequence[Took]) -> Took:
    """Medians of either time."""
    return Took(*(statistics.median(each) for each in zip(*times, strict=True)))


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the table into docs/performance.md")
    options.add_argument("--rounds", type=int, default=3, help="how often everything is compiled anew")
    given = options.parse_args(arguments)
    if given.quick:
        quick = {"help_s": took(HELP).wall}
        return common.show(quick, [f"torsade --help: {quick['help_s']:.2f} s"], given.json)
    found = {"`torsade --help`": median([took(HELP) for _ in range(9)])}
    for name, command in RUNS.items():
        took(command)
        found[f"{name}, kernels compiled"] = median([took(command) for _ in range(3)])
        found[f"{name}, nothing compiled"] = median([cold(command) for _ in range(given.rounds)])
    rows = [(name, each.wall, each.processor) for name, each in found.items()]
    text = common.table(("command", "wall time [s]", "processor time [s]"), rows)
    if given.write:
        common.put(text, PAGE, "start")
    return common.show({name: each._asdict() for name, each in found.items()}, [text], given.json)


if __name__ == "__main__":
    main()
