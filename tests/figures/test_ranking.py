"""Rank correlations and their intervals, against scipy and cases made by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from torsade.figures import ranking


def tied(seed, n=20):
    rng = np.random.default_rng(seed)
    x = rng.integers(0, 6, n).astype(float)
    return rng, x, x + rng.integers(0, 6, n)


@pytest.mark.parametrize("seed", range(5))
def test_correlations_are_those_of_scipy_in_samples_too(seed):
    rng, x, y = tied(seed)
    counts = rng.multinomial(20, np.full(20, 1 / 20), size=3)

    for ours, theirs in ((ranking.kendall, stats.kendalltau), (ranking.spearman, stats.spearmanr)):
        assert ours(x, y) == pytest.approx(theirs(x, y).statistic, abs=1e-14)
        for found, count in zip(ours(x, y, counts), counts, strict=True):
            drawn = np.repeat(np.arange(20), count)
            assert found == pytest.approx(theirs(x[drawn], y[drawn]).statistic, abs=1e-14)


def test_orders_of_three():
    assert ranking.kendall([1, 2, 3], [10, 30, 20]) == pytest.approx(1 / 3)
    assert ranking.spearman([1, 2, 3], [10, 30, 20]) == pytest.approx(0.5)
    assert ranking.kendall([1, 2, 3], [3, 2, 1]) == pytest.approx(-1)
    assert ranking.kendall([1, 1, 2], [1, 2, 3]) == pytest.approx(2 / math.sqrt(2 * 3))
    found = ranking.agreement([1, 1, 2, 3], [1, 2, 4, 3])
    assert (found.n, found.right, found.wrong, found.net) == (4, 4, 1, 0.5)


def test_an_order_told_pair_by_pair_is_that_of_numbers_or_none_that_numbers_give():
    _, x, y = tied(2)
    signs = np.sign(x[:, None] - x[None])
    groups = [k // 3 for k in range(20)]
    assert ranking.agreement(signs, y, groups) == ranking.agreement(x, y, groups)

    circle = np.array([[0, 1, -1], [-1, 0, 1], [1, -1, 0]])  # each above the next
    assert ranking.kendall(circle, [3, 2, 1]) == pytest.approx(1 / 3)  # two of three


@pytest.mark.parametrize("rank", ["kendall", "spearman"])
def test_the_interval_is_that_of_scipy_on_the_pairs_themselves(rank):
    _, x, y = tied(7, 25)
    statistic = {"kendall": stats.kendalltau, "spearman": stats.spearmanr}[rank]
    theirs = stats.bootstrap(
        (x, y), lambda a, b: statistic(a, b).statistic, paired=True, vectorized=False, n_resamples=3000,
        rng=np.random.default_rng(1),
    ).confidence_interval  # fmt: skip
    found = ranking.correlation(x, y, rank)

    assert found.low < found.value < found.high
    assert (found.low, found.high) == pytest.approx((theirs.low, theirs.high), abs=0.04)
    assert ranking.correlation(x, y, rank) == found


def test_the_interval_covers_what_is_true():
    r, n, trials = 0.7, 20, 150
    true = 2 / math.pi * math.asin(r)  # Kendall's tau of a normal pair with correlation r (Greiner 1909)
    rng = np.random.default_rng(3)
    covered = 0
    for _ in range(trials):
        x, noise = rng.standard_normal((2, n))
        found = ranking.correlation(x, r * x + math.sqrt(1 - r * r) * noise)
        covered += found.low <= true <= found.high

    assert 0.87 <= covered / trials <= 0.995  # 95 % meant; three standard errors are 0.053


def test_whole_groups_are_drawn():
    _, x, y = tied(4, 12)
    single = ranking.correlation(x, y)
    thrice = ranking.correlation(np.tile(x, 3), np.tile(y, 3), groups=[*range(12)] * 3)
    apart = ranking.correlation(np.tile(x, 3), np.tile(y, 3))

    assert thrice.value == pytest.approx(single.value)
    # Copies of an item in one group say no more than the item; taken for witnesses they narrow the interval.
    numbers = sorted(range(12), key=str)
    renamed = ranking.correlation(x[numbers], y[numbers])
    assert (thrice.low, thrice.high) == pytest.approx((renamed.low, renamed.high))
    assert apart.high - apart.low < 0.8 * (thrice.high - thrice.low)


def test_orders_that_leave_nothing_to_say():
    perfect = ranking.correlation([1, 2, 3, 4, 5], [1, 4, 9, 16, 25])
    assert perfect == (1, 1, 1)
    assert all(math.isnan(x) for x in ranking.correlation([1, 1, 1, 1], [1, 2, 3, 4]))
    assert math.isnan(ranking.correlation([1, 2], [1, 2]).low)


def test_one_item_dominates_another_that_has_more_of_nothing():
    found = ranking.dominance([(6, 1, 4), (6, 1, 1), (6, 0, 4), (6, 1, 4)])

    assert found.tolist() == [[0, 1, 1, 0], [-1, 0, 0, -1], [-1, 0, 0, -1], [0, 1, 1, 0]]
