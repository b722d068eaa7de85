"""The mobility solve as one block of threads would do it, a thread to a node: how many barriers it takes.

Nothing here runs on a graphics processor. The same operations are carried out on arrays, each between two
barriers: what a thread reads was written before the last barrier. Solutions are compared with the direct
solve, and barriers are counted; docs/gpu.md makes an estimate of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from benchmarks import common
from benchmarks.mobility import matrix

Floats = NDArray[np.float64]

PAGE = Path(__file__).parents[1] / "docs" / "gpu.md"

HEADS = ("spacing [radii]", "nodes", "contacts", "iterations", "barriers", "off the direct solve")


class Block:
    """Operations of a block on arrays (n,) or (n, 3); `barriers` counts those passed."""

    def __init__(self, M: sparse.csr_matrix) -> None:
        self.M = M
        self.barriers = 0
        diagonal, off = M.diagonal(), np.append(M.diagonal(1), 0.0)
        self._stages, self._scale = self._reduced(np.concatenate([[0.0], off[:-1]]), diagonal, off)

    def _reduced(
        self, below: Floats, diagonal: Floats, above: Floats
    ) -> tuple[list[tuple[Floats, Floats]], Floats]:
        """Factors of cyclic reduction in parallel, made once per matrix (Hockney 1965): of every round, what
        of the rows a stride before and after is taken away; then the diagonal that is left."""
        n, stride, stages = len(diagonal), 1, []
        while stride < n:
            before, after = _shifted(diagonal, -stride, 1.0), _shifted(diagonal, stride, 1.0)
            p, q = below / before, above / after
            stages.append((p, q))
            diagonal = diagonal - p * _shifted(above, -stride) - q * _shifted(below, stride)
            below, above = -p * _shifted(below, -stride), -q * _shifted(above, stride)
            stride *= 2
            self.barriers += 1
        return stages, diagonal

    def precondition(self, r: Floats) -> Floats:
        """Solve with the tridiagonal part of M."""
        stride = 1
        for p, q in self._stages:
            r = r - p[:, None] * _shifted(r, -stride) - q[:, None] * _shifted(r, stride)
            stride *= 2
            self.barriers += 1
        return r / self._scale[:, None]

    def product(self, v: Floats) -> Floats:
        """M v: every thread gathers what its row needs."""
        self.barriers += 1
        return np.asarray(self.M @ v)

    def dot(self, a: Floats, b: Floats) -> float:
        """A sum in a fixed order: within warps of 32 without a barrier, then over warps."""
        self.barriers += 2
        parts = np.sum(a * b, axis=1)
        width = 32
        warps = np.pad(parts, (0, -len(parts) % width)).reshape(-1, width)
        return float(warps.sum(axis=1).sum())


def _shifted(a: Floats, by: int, fill: float = 0.0) -> Floats:
    """Row i holds row i + by of a, or the fill beyond its ends."""
    out = np.full_like(a, fill)
    if by < 0:
        out[-by:] = a[:by]
    else:
        out[:-by] = a[by:]
    return out


def solve(M: sparse.csr_matrix, force: Floats, guess: Floats, tolerance: float) -> tuple[Floats, int, int]:
    """Velocities (n, 3) by preconditioned conjugate gradients, iterations, and barriers."""
    block = Block(M)
    v = guess.copy()
    r = force - block.product(v)
    p = z = block.precondition(r)
    rz = block.dot(r, z)
    for k in range(10 * len(v)):
        if rz <= tolerance**2 * abs(block.dot(v, force)):
            return v, k, block.barriers
        q = block.product(p)
        alpha = rz / block.dot(p, q)
        v, r = v + alpha * p, r - alpha * q
        z = block.precondition(r)
        previous, rz = rz, block.dot(r, z)
        p = z + rz / previous * p
    raise ArithmeticError("conjugate gradients do not converge, so there is nothing to count")


def compare(spacing: float, until: float) -> dict[str, Any]:
    """Iterations and barriers of one solve on a pulled reef, and how far it is from the direct one."""
    motion = common.pulled_bend("reef", spacing, until)
    now = common.capture(motion)
    w = now.stages.work
    M = matrix(motion, now).tocsr()
    force = np.where(w.held[:, None], 0.0, w.force)
    guess = np.where(w.held[:, None], 0.0, now.guess)
    v, iterations, barriers = solve(M, force, guess, motion.control.solver_tolerance)
    exact = sparse.linalg.splu(M.tocsc()).solve(force)
    return {
        "spacing": spacing,
        "nodes": len(v),
        "contacts": now.contacts,
        "iterations": iterations,
        "barriers": barriers,
        "off": float(np.abs(v - exact).max() / np.abs(exact).max()),
    }


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--write", action="store_true", help="put the table into docs/gpu.md")
    given = options.parse_args(arguments)
    spacings = (0.6,) if given.quick else (0.6, 0.5, 0.3, 0.2)
    rows = [compare(s, 0.005 if given.quick else 0.3) for s in spacings]
    rounds = [math.ceil(math.log2(row["nodes"])) for row in rows]
    text = common.table(HEADS, [list(row.values()) for row in rows])
    if given.write:
        common.put(text, PAGE, "block")
    return common.show({"rows": rows, "rounds": rounds}, [text], given.json)


if __name__ == "__main__":
    main()
