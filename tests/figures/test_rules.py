"""Counting rules against friction: tables made up so that the outcome is known."""

from __future__ import annotations

import math
from itertools import combinations

import pytest

from torsade.figures import bends, rules
from torsade.figures.base import Choice, Table
from torsade.knots import variants

STANDARD = Choice(presets=("standard",))


def made_up(c_f):
    """A table of all variants with their own counts and this friction of them."""
    rows = []
    for knot in variants():
        counted = bends.counts(knot)
        own = {
            "knot": knot,
            "preset": "standard",
            "N": counted.crossings,
            "tau": counted.tau,
            "Gamma": counted.gamma,
            "Gamma_least": counted.gamma,
            "Gamma_greatest": counted.gamma,
            "Whitney": counted.whitney,
        }
        rows.append(tuple((own | {"c_f": c_f(own)}).get(name) for name in bends.COLUMNS))
    return Table(bends.COLUMNS, rows)


def of_thesis(table):
    found = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    return {row["rule"]: row for row in found if row["bends"] == "thesis"}


def test_friction_that_follows_the_fit_is_ordered_without_a_fault():
    table = made_up(lambda row: math.exp(0.1 * row["N"] + row["tau"] + 0.01 * row["Gamma"]))
    found = of_thesis(rules.rules_table(table, STANDARD))

    assert found[rules.FITTED]["kendall"] == pytest.approx(1, abs=0.02)  # ties of equal counts are broken
    assert found[rules.FITTED]["pairs_wrong"] == 0
    assert found[rules.ALL_THREE]["kendall"] == 1
    assert found["N"]["n"] == 20


def test_the_order_in_turn_is_that_of_triples():
    table = made_up(lambda row: 1000 * row["N"] + 10 * row["tau"] + 0.1 * row["Gamma"])
    found = of_thesis(rules.rules_table(table, STANDARD))["N, then tau, then Gamma"]

    assert found["kendall"] == pytest.approx(1, abs=1e-12)
    assert (found["kendall_low"], found["pairs_wrong"]) == (pytest.approx(1, abs=1e-12), 0)


def test_pairs_are_counted_as_by_hand():
    table = made_up(lambda row: 50 - row["N"] + 20 * row["tau"] + row["Gamma"])
    found = rules.rules_table(table, STANDARD)
    single = bends.distinct(table, "standard")["thesis"]
    right = wrong = 0
    for i, j in combinations(range(20), 2):
        a, b = ([single[name][k] for name in ("N", "tau", "Gamma")] for k in (i, j))
        if a == b or not (
            all(x >= y for x, y in zip(a, b, strict=True)) or all(x <= y for x, y in zip(a, b, strict=True))
        ):
            continue
        side = (a > b) - (a < b)
        apart = single["c_f"][i] - single["c_f"][j]
        right, wrong = right + (side * apart > 0), wrong + (side * apart < 0)

    row = of_thesis(found)[rules.ALL_THREE]
    assert (row["pairs_right"], row["pairs_wrong"]) == (right, wrong)
    listed = rules.disagreements(table, STANDARD)
    assert len(listed.rows) == wrong > 0
    assert all(ratio < 1 for ratio in listed.column("c_f_ratio"))


def test_the_reef_and_the_thief_are_told_apart_by_gamma_alone():
    table = made_up(lambda row: {"reef": 31.0, "thief": 35.0}.get(row["knot"], 30.0 + row["N"]))
    listed = rules.disagreements(table, STANDARD)

    assert ("reef", "thief") in {row[1:3] for row in listed.rows}
    row = next(row for row in listed.rows if row[1:3] == ("reef", "thief"))
    assert row[3:] == pytest.approx((6, 1, 4, 31, 6, 1, 1, 35, 31 / 35))
