"""The direct solve of the mobility system against the alternatives, on systems of a pulled reef.

Conjugate gradients start from the velocities of the step before, as they would in a run. What the
sparse solvers of scipy get is favourable to them: the matrix is there already, in their format.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np
from scipy import linalg, sparse
from scipy.sparse.csgraph import reverse_cuthill_mckee

from benchmarks import common
from torsade.motion.overdamped import Motion
from torsade.rod.damping import solve_mobility
from torsade.rod.factor import WORTH, pattern


@numba.njit
def _solve(times, a, eta_A, contacts, factor, force, fixed, tolerance, guess, v, work):  # type: ignore[no-untyped-def]
    for _ in range(times):
        v[:] = guess
        solve_mobility(a, eta_A, contacts, factor, (), force, fixed, tolerance, v, work)


def matrix(motion: Motion, now: common.Moment) -> sparse.csc_matrix:
    """M with the rows and columns of held nodes replaced by the identity."""
    a, contacts, w = motion.assembly, now.near.contacts, now.stages.work
    n = len(a.node_length)
    count = int(contacts.count[1])
    parts = (len(a.edges), count)
    rows = np.repeat(np.arange(sum(parts)), [2] * parts[0] + [4] * parts[1])
    columns = np.concatenate([a.edges.ravel(), contacts.drag_nodes[:count].ravel()])
    signs = np.concatenate([np.tile([1.0, -1.0], parts[0]), np.tile([0.5, 0.5, -0.5, -0.5], parts[1])])
    weights = np.concatenate([motion.model.eta_A / a.rest_length, contacts.drag_weight[:count]])
    difference = sparse.csr_matrix((signs, (rows, columns)), shape=(sum(parts), n))
    full = difference.T @ sparse.diags(weights) @ difference
    free = sparse.diags((~w.held).astype(float))
    return (free @ full @ free + sparse.diags(w.held.astype(float))).tocsc()


def _band(M: sparse.csc_matrix, order: np.ndarray) -> np.ndarray:
    """Lower band of the reordered matrix, as `solveh_banded` takes it."""
    P = M[order][:, order].tocoo()
    width = int(np.max(P.row - P.col))
    band = np.zeros((width + 1, M.shape[0]))
    lower = P.row >= P.col
    band[P.row[lower] - P.col[lower], P.col[lower]] = P.data[lower]
    return band


def compare(spacing: float, until: float, at_least: float, repeats: int) -> dict[str, float]:
    """Times [us] of one solve for three right sides, and how far the solutions are apart."""
    motion = common.pulled_bend("reef", spacing, until)
    now = common.capture(motion)
    a, m, w, contacts = motion.assembly, motion.model, now.stages.work, now.near.contacts
    force, held = w.force.copy(), w.held.copy()
    direct = pattern(a, contacts, w.mid, m.diameter, np.inf)
    operations = float(np.mean(np.diff(direct.start) ** 2.0))  # what the choice of a solver is made on
    zero, v = np.zeros_like(now.guess), np.zeros_like(now.guess)
    guess = np.where(held[:, None], 0.0, now.guess)

    def ours(factor: Any, start: np.ndarray) -> float:
        def call(times: int) -> None:
            _solve(
                times, a, m.eta_A, contacts, factor, force, held, motion.control.solver_tolerance, start, v,
                w.mobility,
            )  # fmt: skip

        return 1e6 * common.in_loop(call, at_least, repeats)

    taken = {"direct": ours(direct, zero)}
    exact = v.copy()
    taken["conjugate gradients"] = ours((), guess)
    off = float(np.abs(v - exact).max() / np.abs(exact).max())
    M = matrix(motion, now)
    right = np.where(held[:, None], 0.0, force)
    taken["sparse LU (splu)"] = _python(lambda: sparse.linalg.splu(M).solve(right), at_least, repeats)
    order = reverse_cuthill_mckee(M.tocsr(), symmetric_mode=True)
    band, ordered = _band(M, order), right[order]
    taken["banded (solveh_banded)"] = _python(
        lambda: linalg.solveh_banded(band, ordered, lower=True, check_finite=False), at_least, repeats
    )
    residual = np.abs(M @ exact - right).max() / np.abs(right).max()
    return {
        "spacing": spacing,
        "nodes": len(a.node_length),
        "contacts": now.contacts,
        "operations_per_node": operations,
        "residual_of_direct": float(residual),
        "off_by_conjugate_gradients": off,
        **taken,
    }


def _python(call: Callable[[], object], at_least: float, repeats: int) -> float:
    def many(times: int) -> None:
        for _ in range(times):
            call()

    return 1e6 * common.in_loop(many, at_least, repeats)


SOLVERS = ("direct", "conjugate gradients", "sparse LU (splu)", "banded (solveh_banded)")


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    given = options.parse_args(arguments)
    spacings = (0.6,) if given.quick else (0.6, 0.5, 0.3, 0.2, 0.15, 0.1, 0.07)
    at_least, repeats = (1e-5, 1) if given.quick else (2e-2, 9)
    rows = [compare(s, 0.005 if given.quick or s < 0.25 else 0.3, at_least, repeats) for s in spacings]
    found: dict[str, Any] = {"rows": rows, "worth": WORTH, "worth_measured": _break_even(rows)}
    heads = ("spacing [radii]", "nodes", "contacts", "operations/node", "direct [µs]", *SOLVERS[1:])
    body = [
        [
            row["spacing"], row["nodes"], row["contacts"], row["operations_per_node"], row["direct"],
            *(f"{row[name] / row['direct']:.1f} x" for name in SOLVERS[1:]),
        ]
        for row in rows
    ]  # fmt: skip
    measured = found["worth_measured"]
    tables = [
        common.table(heads, body),
        f"The direct solve is used up to {WORTH:g} operations per node; "
        + (f"it breaks even at about {measured:.0f}." if measured else "here it is always faster."),
    ]
    return common.show(found, tables, given.json)


def _break_even(rows: Sequence[dict[str, float]]) -> float | None:
    """Operations per node at which conjugate gradients catch up, or None when they do not."""
    by_work = sorted(rows, key=lambda row: row["operations_per_node"])
    for low, high in itertools.pairwise(by_work):
        a, b = (np.log(row["conjugate gradients"] / row["direct"]) for row in (low, high))
        if a > 0 >= b:
            x, y = (np.log(row["operations_per_node"]) for row in (low, high))
            return float(np.exp(x + (y - x) * a / (a - b)))
    return None


if __name__ == "__main__":
    main()
