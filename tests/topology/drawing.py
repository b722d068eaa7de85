"""PD codes for tests: closed braids, moves that keep the link, sums, and the shared codes."""

from __future__ import annotations

import json
import os
import random
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest

from torsade.topology.invariants import Code, oriented
from torsade.topology.table import contents

PD = list[tuple[int, int, int, int]]
SHARED = Path(os.environ.get("TORSADE_SHARED", Path(__file__).resolve().parents[3] / "shared"))


def knot_codes() -> dict[str, PD]:
    """The PD codes of the table."""
    return {name: [tuple(c) for c in row["pd"]] for name, row in contents()["knots"].items()}


@lru_cache
def shared(name: str) -> Any:
    """A file of the shared codes."""
    file = SHARED / "data" / "knots" / name
    if not file.exists():
        pytest.skip("the shared codes are not here; give their folder in TORSADE_SHARED")
    return json.loads(file.read_text(encoding="utf-8"))


def braid(word: Sequence[int], strands: int | None = None) -> tuple[PD, int]:
    """The closure of a braid, PD code and circles: letter +i is a positive crossing of strands i, i + 1."""
    n = strands or max(map(abs, word)) + 1
    at = list(range(1, n + 1))
    rows: PD = []
    fresh = n
    for letter in word:
        i = abs(letter) - 1
        left, right = at[i : i + 2]
        at[i : i + 2] = fresh + 1, fresh + 2
        rows.append(
            (right, fresh + 2, fresh + 1, left) if letter > 0 else (left, right, fresh + 2, fresh + 1)
        )
        fresh += 2
    closed = {top: bottom for bottom, top in enumerate(at, 1)}
    circles = sum(top == bottom for top, bottom in closed.items())
    return [tuple(closed.get(x, x) for x in row) for row in rows], circles  # type: ignore[misc]


def mirrored(pd: PD) -> PD:
    return [(a, d, c, b) for a, b, c, d in pd]


def crossings_changed(pd: PD) -> PD:
    """The other mirror image, in the plane of the drawing: every crossing changed."""
    code = oriented(pd)
    return [
        (d, a, b, c) if sign > 0 else (b, c, d, a) for (a, b, c, d), sign in zip(pd, code.signs, strict=True)
    ]


def turned_round(pd: PD) -> PD:
    """All components the other way."""
    return [(-c, -d, -a, -b) for a, b, c, d in pd]


def relabelled(pd: PD, rng: random.Random) -> PD:
    """Other labels, which need not rise along a component, and crossings in another order."""
    old = sorted({x for row in pd for x in row})
    new = dict(zip(old, rng.sample(range(1000), len(old)), strict=True))
    rows = [tuple(new[x] for x in row) for row in pd]
    rng.shuffle(rows)
    return rows  # type: ignore[return-value]


def _with_heads(code: Code, heads: dict[int, int]) -> list[list[int]]:
    """The rows in which some edges end under another label."""
    rows = [list(row) for row in code.crossings]
    for edge, label in heads.items():
        c, slot = code.ends[edge][1]
        rows[c][slot] = label
    return rows


def with_kink(pd: PD, rng: random.Random) -> PD:
    """A Reidemeister I move: one of four kinks on some edge."""
    code = oriented(pd)
    e = rng.choice(sorted(code.ends))
    x, y = 1000, 1001
    kink = rng.choice([(e, y, x, x), (e, x, x, y), (x, x, y, e), (x, e, y, x)])
    return [*map(tuple, _with_heads(code, {e: y})), kink]  # type: ignore[list-item]


def with_bigon(pd: PD, rng: random.Random) -> PD:
    """A Reidemeister II move: of two edges at one face, one is pushed over the other."""
    code = oriented(pd)
    sides: dict[int, list[tuple[int, bool]]] = {}
    for edge, ((c, slot), _) in code.ends.items():
        sides.setdefault(code.corners[c][slot], []).append((edge, True))
        sides.setdefault(code.corners[c][slot - 1], []).append((edge, False))
    face = rng.choice([edges for edges in sides.values() if len(edges) > 1])
    (e, e_left), (f, f_left) = rng.sample(face, 2)
    e1, e2, f1, f2 = 1000, 1001, 1002, 1003
    new = [(f1, e1, f2, e), (f, e1, f1, e2)] if e_left == f_left else [(f, e, f1, e1), (f1, e2, f2, e1)]
    if not e_left:
        new = mirrored(new)
    return [*map(tuple, _with_heads(code, {e: e2, f: f2})), *new]  # type: ignore[list-item]


def connected_sum(one: PD, two: PD) -> PD:
    """The connected sum at one edge of each."""
    apart = [*one, *(tuple(x + 500 for x in row) for row in two)]
    code = oriented(apart)  # type: ignore[arg-type]
    e, f = code.components[0][0], code.components[-1][0]
    return [tuple(row) for row in _with_heads(code, {e: f, f: e})]  # type: ignore[misc]


def closed_bend(pd: list[list[str]], joins: str) -> PD:
    """The closure of a two-strand tangle by arcs between ends; B runs backwards where that is needed."""
    last = {strand: max(int(x[1:]) for row in pd for x in row if x[0] == strand) for strand in "AB"}
    number = {
        f"{strand}{k}": 100 * "AB".index(strand) + k for strand in "AB" for k in range(last[strand] + 1)
    }
    one, two = (
        (f"{end[0]}{last[end[0]] if end[1] == '1' else 0}" for end in j.split("-")) for j in joins.split()
    )
    name = dict(number)
    for a, b in (tuple(one), tuple(two)):
        same = {x for x, n in name.items() if n == name[b]}
        name.update(dict.fromkeys(same, name[a]))
    pairs = {frozenset(j.split("-")) for j in joins.split()}
    backwards = frozenset(("A0", "B0")) in pairs or frozenset(("A1", "B1")) in pairs
    rows = []
    for row in pd:
        a, b, c, d = (name[x] for x in row)
        rows.append((c, d, a, b) if backwards and row[0][0] == "B" else (a, b, c, d))
    return rows
