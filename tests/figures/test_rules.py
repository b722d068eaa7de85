"""Counting rules against friction: tables made up so that the outcome is known."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
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
            "N_fewest": bends.fewest_crossings(knot),
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

    assert found[rules.FITTED]["kendall"] == pytest.approx(1, abs=1e-12)
    assert found[rules.FITTED]["pairs_wrong"] == found[rules.ALL_THREE]["pairs_wrong"] == 0
    assert found[rules.FITTED]["net"] == found[rules.FITTED]["pairs_right"] / 190
    assert (found[rules.ALL_THREE]["kendall"], found[rules.ALL_THREE]["net"]) == (None, None)
    assert found["N"]["n"] == 20


def noisy(seed, slope, noise):
    """Columns of the thesis's bends whose log c_f is linear in the counts, by a slope, with noise by knot."""
    rng = np.random.default_rng(seed)
    of_knot = {bends.family(knot): noise * rng.normal() for knot in variants()}

    def c_f(row):
        true = slope * (0.15 * row["N"] + 0.8 * row["tau"] + 0.1 * row["Gamma"])
        return math.exp(true + of_knot[bends.family(row["knot"])] + 0.05 * noise * rng.normal())

    return bends.distinct(made_up(c_f), "standard")["thesis"]


def net(order, c_f):
    """(right - wrong)/all pairs, pair by pair."""
    pairs = list(combinations(range(len(c_f)), 2))
    return sum(order[i, j] * np.sign(c_f[i] - c_f[j]) for i, j in pairs) / len(pairs)


def test_a_pair_is_ordered_by_a_fit_that_sees_neither_of_its_knots():
    found = noisy(1, 1.0, 0.3)
    order = rules.scores(found)[rules.FITTED]
    families = [bends.family(knot) for knot in found["knot"]]
    counts = np.array([[found[name][k] for name in ("N", "tau", "Gamma")] for k in range(20)], float)
    for i, j in combinations(range(20), 2):
        seen = [k for k in range(20) if families[k] not in (families[i], families[j])]
        slopes = counts[seen] - counts[seen].mean(0)
        fit = np.linalg.solve(slopes.T @ slopes, slopes.T @ np.log([found["c_f"][k] for k in seen]))
        apart = fit @ (counts[i] - counts[j])
        assert order[i, j] == -order[j, i] == (0 if abs(apart) < 1e-9 else np.sign(apart))


def test_the_fit_is_right_about_a_linear_law_with_noise_and_says_nothing_of_noise_alone():
    law = [noisy(seed, 1.0, 0.1) for seed in range(12)]
    chance = [noisy(seed, 0.0, 1.0) for seed in range(60)]
    right, none = (
        [net(rules.scores(found)[rules.FITTED], found["c_f"]) for found in made] for made in (law, chance)
    )

    assert np.mean(right) > 0.75
    spread = np.std(none) / math.sqrt(len(none))
    assert abs(np.mean(none)) < 3 * spread < 0.2  # leaving out one knot at a time and pooling gives -0.2


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
    assert row[3:-1] == pytest.approx((6, 1, 4, 31, 6, 1, 1, 35, 31 / 35))
    assert row[-1] is True


def test_a_drawing_that_has_crossings_to_spare_is_said_to():
    """In the thesis's drawings the zeppelin bend has 12 and the sheet bend 7, where 10 and 6 are enough."""
    knots = ("zeppelin13", "zeppelin14", "bowline14", "ashley14")
    assert [bends.fewest_crossings(knot) for knot in knots] == [10, 10, 6, 12]
    table = made_up(lambda row: {"zeppelin14": 30.0, "alpine23": 31.0, "ashley14": 32.0}.get(row["knot"], 40))
    listed = {row[1:3]: row[-1] for row in rules.disagreements(table, STANDARD).rows}

    assert listed["zeppelin14", "ashley14"] is False
    assert listed["alpine23", "ashley14"] is True
