"""Share of every kernel in one evaluation of the rates, and of what else a step does.

Kernels run inside compiled loops on one moment of a pulled bend: a call from Python takes longer than
most of them. What cannot be called alone is the remainder of the whole evaluation.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numba
import numpy as np

from benchmarks import common
from torsade.motion.guard import first_crossing, largest_move
from torsade.motion.near import find_near, list_near
from torsade.motion.overdamped import Motion
from torsade.motion.rates import _material_rates, hold_bodies, powers
from torsade.motion.scheme import ONE_STAGE, START, embedded_error, evaluate
from torsade.rod.contact import add_contact_forces, add_drag_torques, find_contacts, find_drag
from torsade.rod.elasticity import add_elastic_forces, hinge_twist
from torsade.rod.factor import WORTH, assemble, eliminate, pattern, substitute
from torsade.rod.kinematics import (
    carry_directors,
    edge_geometry,
    reference_twist_change,
)
from torsade.rod.neighbours import edge_midpoints
from torsade.rod.spin import solve_spin

PAGE = Path(__file__).parents[1] / "docs" / "performance.md"

WHOLE, ASSEMBLED, FACTORISED = "evaluation", "matrix assembled", "matrix factorised"

NUMBERS = (embedded_error, first_crossing, largest_move)
"""Kernels that do nothing but return a number."""


@numba.njit
def _matrix(a, eta_A, contacts, fixed, factor, v):  # type: ignore[no-untyped-def]
    """Assemble and factorise: factors replace the matrix, so one cannot be repeated without the other."""
    assemble(a, eta_A, contacts, fixed, factor)
    return eliminate(factor, v)


def evaluation(motion: Motion, now: common.Moment, timed: _Kernels) -> None:
    """Add the kernels of an evaluation, and the whole."""
    a, m, bc, state, control = motion.assembly, motion.model, motion.boundary, motion.state, motion.control
    g, contacts, factor, add = now.stages, now.near.contacts, now.factor, timed.add
    w = g.work
    whole = (START, False, a, m, bc, state, contacts, factor, control, 0.0, ONE_STAGE, g)
    add(WHOLE, evaluate, *whole)
    # Scratch for kernels that add to what they are given, so that what the others read stays as it is.
    force, torque, weight = np.zeros_like(w.force), np.zeros_like(w.torque), np.zeros_like(w.spin_weight)
    omega, v = g.omega.copy(), g.v.copy()
    add("geometry", edge_geometry, a, g.x, w.length, w.tangent)
    add("geometry", edge_midpoints, g.x, a.edges, w.mid)
    add("reference twist", reference_twist_change, a, g.tangent, w.tangent, w.change)
    add("reference twist", hinge_twist, g.theta, state.reference_twist, a.hinges, w.m)
    add(
        "elastic forces", add_elastic_forces, a, m.EA, m.B, m.C, m.bend_present, w.length, w.tangent, w.m,
        w.edge_force, force, torque,
    )  # fmt: skip
    add("contacts found", find_contacts, m, w.mid, contacts)
    add("contact forces", add_contact_forces, a, m, w.length, w.tangent, contacts, force)
    add("drag found", find_drag, a, m, g.x, w.length, w.mid, contacts)
    add("bodies held", hold_bodies, a, bc, contacts, w.held, w.component)
    add("torques of drag", add_drag_torques, a, m, g.v, w.tangent, contacts, torque, weight)
    add("spin", solve_spin, a, m.eta_J, w.tangent, w.torque, w.spin_weight, bc.turned, bc.spin, omega, w.spin)
    add(
        "material angles", _material_rates, a, g.tangent, w.tangent, w.length, g.v, g.omega,
        g.angular.copy(),
    )  # fmt: skip
    add("work and dissipation", powers, a, m, bc, g.v, g.omega, contacts, w)
    if factor.tape.size:
        add(ASSEMBLED, assemble, a, m.eta_A, contacts, w.held, factor)
        add(FACTORISED, _matrix, a, m.eta_A, contacts, w.held, factor, v)
        add("substituted", substitute, factor, v)


def step(motion: Motion, now: common.Moment, timed: _Kernels) -> None:
    """Add what a step does besides evaluations."""
    a, m, state, control = motion.assembly, motion.model, motion.state, motion.control
    g, near, add = now.stages, now.near, timed.add
    w = g.work
    moved = state.x + 1e-3 * control.radius * np.sin(np.arange(state.x.size)).reshape(-1, 3)
    director = state.director.copy()
    add("error estimate", embedded_error, state, g, 1e-4, control.radius)
    add("guard against crossing", largest_move, state.x, moved)
    add(
        "guard against crossing", first_crossing, a, near.apart, near.guarded, near.count[0], state.x,
        moved, g.length, g.mid, largest_move(state.x, moved),
    )  # fmt: skip
    add("directors", carry_directors, a.edge_start, director, g.tangent, w.tangent)
    add("pairs listed (when nodes have moved)", list_near, m, control, g.mid, g.length, near)
    add("pairs found (when they have gone far)", find_near, a, m, control, g.mid, g.length)
    add("pattern (when another pair touches)", pattern, a, near.contacts, g.mid, m.diameter, WORTH)


class _Kernels:
    """Kernels to be timed in turn, round after round, so that all see the same ups and downs."""

    def __init__(self, at_least: float, rounds: int, compiled: bool) -> None:
        self.at_least, self.rounds, self.compiled = at_least, rounds, compiled
        self.calls: dict[str, list[Callable[[int], None]]] = {}

    def add(self, name: str, kernel: Any, *arguments: Any) -> None:
        """Time a kernel; what is added under one name counts together."""
        if self.compiled:
            many = common.loop(kernel, kernel in NUMBERS)
            call = lambda times: many(times, arguments)  # noqa: E731
        else:
            call = lambda times: [kernel(*arguments) for _ in range(times)] and None  # noqa: E731
        self.calls.setdefault(name, []).append(call)

    def medians(self) -> dict[str, float]:
        """Time of every kernel [s]."""
        flat = [(name, call) for name, calls in self.calls.items() for call in calls]
        times = [common.passes(call, self.at_least) for _, call in flat]
        taken: list[list[float]] = [[] for _ in flat]
        for _ in range(self.rounds):
            for k, (_, call) in enumerate(flat):
                began = common.CLOCK()
                call(times[k])
                taken[k].append((common.CLOCK() - began) / times[k])
        total = dict.fromkeys(self.calls, 0.0)
        for (name, _), each in zip(flat, taken, strict=True):
            total[name] += statistics.median(each)
        return total


def main(arguments: Sequence[str] | None = None) -> dict[str, Any]:
    options = common.parser(__doc__)
    options.add_argument("--knot", default="reef", choices=common.BUILT_IN)
    options.add_argument("--write", action="store_true", help="put the tables into docs/performance.md")
    given = options.parse_args(arguments)
    at_least, rounds = (1e-6, 1) if given.quick else (2e-3, 51)
    inner, outer = (_Kernels(at_least, rounds, not given.quick) for _ in range(2))
    motion = common.pulled_bend(given.knot, 0.5, 0.01 if given.quick else 0.3)
    before = motion.counts
    now = common.capture(motion)
    evaluation(motion, now, inner)
    step(motion, now, outer)
    inside, beside = inner.medians(), outer.medians()
    whole = inside.pop(WHOLE)
    if FACTORISED in inside:
        inside[FACTORISED] = max(0.0, inside[FACTORISED] - inside[ASSEMBLED])
    inside["all else"] = max(0.0, whole - sum(inside.values()))
    motion.advance(motion.time + (0.005 if given.quick else 0.1))
    done = {k: n - before[k] for k, n in motion.counts.items()}
    found = {
        "knot": given.knot,
        "nodes": len(motion.state.x),
        "contacts": now.contacts,
        "pairs": int(now.near.contacts.count[2]),
        "guarded": int(now.near.count[0]),
        "us_evaluation": 1e6 * whole,
        "share": {name: taken / whole for name, taken in inside.items()},
        "us_step": {name: 1e6 * taken for name, taken in beside.items()},
        "evaluations_per_step": done["evaluations"] / done["steps"],
        "refused_per_step": done["refused"] / done["steps"],
        "lists_per_step": done["neighbour_lists"] / done["steps"],
    }
    tables = [
        f"{found['knot']}, {found['nodes']} nodes, {found['contacts']} contacts among {found['pairs']} "
        f"listed and {found['guarded']} guarded pairs: {found['us_evaluation']:.1f} µs per evaluation",
        common.table(
            ("kernel", "share of an evaluation"),
            [(k, f"{100 * s:.1f} %") for k, s in sorted(found["share"].items(), key=lambda i: -i[1])],
        ),
        common.table(("once a step", "evaluations it costs"), [(k, t / whole) for k, t in beside.items()]),
        f"{found['evaluations_per_step']:.1f} evaluations, {found['refused_per_step']:.2f} refused steps and "
        f"{found['lists_per_step']:.3f} neighbour lists per step",
    ]
    if given.write:
        common.put("\n\n".join(tables), PAGE, "kernels")
    return common.show(found, tables, given.json)


if __name__ == "__main__":
    main()
