"""The knot group's generators and relations as a diagram shows them, and an order to solve them in.

An arc is what is drawn in one stroke, from one under-passage to the next. At each crossing the arc `v`
goes under the arc `over` and comes out as `u`, where u and v are so named that

    u = t v + (1 - t) over        in the Alexander module,
    u = over^-1 v over            in the knot group;

u is the arc that enters a positive crossing, and the one that leaves a negative one. Of the three arcs,
`over` and either of the others say what the third is, so a few arcs, the seeds, decide the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

from torsade.topology.invariants.code import Code

__all__ = ["Plan", "Relation", "Step", "plan", "relations"]


@dataclass(frozen=True, slots=True)
class Relation:
    """u = t v + (1 - t) over, with arcs numbered by the crossing where they begin."""

    u: int
    v: int
    over: int


@dataclass(frozen=True, slots=True)
class Step:
    """The relation at crossing `row` gives arc `target`, its u if `forwards`, else its v."""

    row: int
    target: int
    forwards: bool


@dataclass(frozen=True, slots=True)
class Plan:
    """Seeds in order, and the steps that each of them makes possible after those before it."""

    seeds: tuple[int, ...]
    steps: tuple[tuple[Step, ...], ...]


def relations(code: Code) -> list[Relation] | None:
    """The relation at each crossing; None if a component is never under, and so split from the rest."""
    arc_of: dict[int, int] = {}
    for edges in code.components:
        starts = [k for k, edge in enumerate(edges) if code.ends[edge][0][1] == 2]
        if not starts:
            return None
        arc = -1
        for edge in edges[starts[0] :] + edges[: starts[0]]:
            c, slot = code.ends[edge][0]
            arc = c if slot == 2 else arc
            arc_of[edge] = arc
    found = []
    for (a, b, c, _), sign in zip(code.crossings, code.signs, strict=True):
        u, v = (a, c) if sign > 0 else (c, a)
        found.append(Relation(arc_of[u], arc_of[v], arc_of[b]))
    return found


def plan(rows: list[Relation]) -> Plan:
    """Few seeds, found greedily: each is an arc that settles the most others, after the ones before it."""
    touching: dict[int, list[int]] = {}
    for k, row in enumerate(rows):
        for arc in {row.u, row.v, row.over}:
            touching.setdefault(arc, []).append(k)
    known: set[int] = set()
    used: set[int] = set()
    seeds, stages = [], []
    while len(known) < len(rows):
        best: tuple[int, list[Step]] | None = None
        for arc in range(len(rows)):
            if arc not in known:
                steps = _settled(rows, touching, known, used, arc)
                if best is None or len(steps) > len(best[1]):
                    best = arc, steps
        assert best is not None
        seed, steps = best
        seeds.append(seed)
        stages.append(tuple(steps))
        known.update([seed], (step.target for step in steps))
        used.update(step.row for step in steps)
    return Plan(tuple(seeds), tuple(stages))


def _settled(
    rows: list[Relation], touching: dict[int, list[int]], known: set[int], used: set[int], seed: int
) -> list[Step]:
    """The steps that become possible, in order, when one more arc is known."""
    fresh = {seed}
    taken: set[int] = set()
    steps = []
    todo = [seed]
    while todo:
        for k in touching[todo.pop()]:
            row = rows[k]
            if k in used or k in taken or not (row.over in known or row.over in fresh):
                continue
            u_known, v_known = (arc in known or arc in fresh for arc in (row.u, row.v))
            if u_known != v_known:
                target = row.v if u_known else row.u
                steps.append(Step(k, target, forwards=not u_known))
                taken.add(k)
                fresh.add(target)
                todo.append(target)
    return steps
