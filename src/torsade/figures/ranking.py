"""How alike two orders are: rank correlations, their intervals, and the pairs that are out of order.

All follows from the signs of differences s_ij = sign(x_i - x_j). With w_i the number of times that item i
occurs in a sample, the sample's correlations are (sums over i and j)

    Kendall's tau_b   Σ w_i w_j s_ij t_ij / √(Σ w_i w_j s_ij² · Σ w_i w_j t_ij²)
    Spearman's rho    Σ w_i a_i b_i / √(Σ w_i a_i² · Σ w_i b_i²),   a_i = Σ w_j s_ij,  b_i = Σ w_j t_ij

since a_i/2 is the mid-rank of item i less the mean rank. So all samples of a bootstrap are one product of
arrays, ties that come of drawing an item twice included. Nothing in them asks that s_ij come of numbers x_i:
an order may as well be told pair by pair, as a matrix s (n, n), antisymmetric.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from torsade.arrays import Floats

__all__ = ["Agreement", "Correlation", "agreement", "correlation", "dominance", "kendall", "spearman"]

RESAMPLES = 4000
SEED = 20
LEVEL = 0.95


class Correlation(NamedTuple):
    """A rank correlation and its confidence interval; nan where one order is all ties."""

    value: float
    low: float
    high: float


class Agreement(NamedTuple):
    """How two orders agree.

    Attributes
    ----------
    kendall, spearman : correlations with their intervals
    n : items
    right, wrong : pairs that both orders tell apart, and tell apart the same way or not
    net : (right - wrong) over all pairs, ties and all
    """

    kendall: Correlation
    spearman: Correlation
    n: int
    right: int
    wrong: int

    @property
    def net(self) -> float:
        """nan for fewer than two items."""
        pairs = self.n * (self.n - 1) // 2
        return (self.right - self.wrong) / pairs if pairs else float("nan")


def kendall(x: ArrayLike, y: ArrayLike, weights: ArrayLike | None = None) -> Floats:
    """Kendall's tau_b of x and y (n,), or of samples in which items occur so often, weights (..., n).

    x may be the order of pairs instead, (n, n), here and below.
    """
    s, t, w = _signs(x), _signs(y), _weights(y, weights)

    def total(matrix: Floats) -> Floats:
        return np.asarray(((w @ matrix) * w).sum(-1))

    return _ratio(total(s * t), total(s * s) * total(t * t))


def spearman(x: ArrayLike, y: ArrayLike, weights: ArrayLike | None = None) -> Floats:
    """Spearman's rho, ties at their mid-rank, of x and y (n,), or of samples, weights (..., n)."""
    w = _weights(y, weights)
    a, b = w @ _signs(x).T, w @ _signs(y).T
    return _ratio((w * a * b).sum(-1), (w * a * a).sum(-1) * (w * b * b).sum(-1))


def correlation(
    x: ArrayLike, y: ArrayLike, rank: str = "kendall", groups: Sequence[object] | None = None
) -> Correlation:
    """A rank correlation with its 95 % interval: bias-corrected and accelerated bootstrap over items, seeded.

    Where a correction cannot be estimated, as of a perfect order, the interval is that of percentiles.

    Parameters
    ----------
    x : (n,) a value of each item, or (n, n) the order of pairs
    y : (n,) another value
    rank : kendall or spearman
    groups : (n,) what each item belongs to: whole groups are drawn then, as items of one are not independent
    """
    of = {"kendall": kendall, "spearman": spearman}[rank]
    value = float(of(x, y))
    named = np.arange(np.size(y)) if groups is None else np.array([str(g) for g in groups])
    _, group = np.unique(named, return_inverse=True)
    n = len(set(group))
    if not np.isfinite(value) or n < 3:
        return Correlation(value, np.nan, np.nan)

    def of_samples(drawn: NDArray[np.int64], axis: int = -1) -> Floats:
        """The correlations of samples, which are groups drawn, numbered along an axis."""
        counts = (np.moveaxis(drawn, axis, -1)[..., None] == np.arange(n)).sum(-2)
        found = of(x, y, counts[..., group])
        return np.where(np.isfinite(found), found, 0.0)  # a sample of ties orders nothing

    def interval(method: Literal["BCa", "percentile"]) -> tuple[float, float]:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore"
            )  # where samples do not differ, the interval is nan, and tells that
            found = stats.bootstrap(
                (np.arange(n),),
                of_samples,
                n_resamples=RESAMPLES,
                batch=500,
                vectorized=True,
                confidence_level=LEVEL,
                method=method,
                rng=np.random.default_rng(SEED),
            ).confidence_interval
        return float(found.low), float(found.high)

    corrected = interval("BCa")
    return Correlation(value, *(corrected if np.isfinite(corrected).all() else interval("percentile")))


def agreement(x: ArrayLike, y: ArrayLike, groups: Sequence[object] | None = None) -> Agreement:
    """Both correlations of x, (n,) or (n, n), and y (n,), and how many pairs they order alike."""
    product = np.triu(_signs(x) * _signs(y))
    return Agreement(
        correlation(x, y, "kendall", groups),
        correlation(x, y, "spearman", groups),
        len(product),
        int((product > 0).sum()),
        int((product < 0).sum()),
    )


def dominance(rules: ArrayLike) -> Floats:
    """The order that several rules agree on, for each pair of items.

    Parameters
    ----------
    rules : (n, k) k values of each item

    Returns
    -------
    (n, n) : 1 where item i is nowhere less than j and somewhere more, -1 where j is so, 0 where rules
        disagree or all are ties
    """
    signs = np.stack([_signs(rule) for rule in np.asarray(rules, np.float64).T])
    more, less = (signs > 0).any(0), (signs < 0).any(0)
    return np.asarray(1.0 * (more & ~less) - 1.0 * (less & ~more))


def _signs(x: ArrayLike) -> Floats:
    """sign(x_i - x_j), shape (n, n), of x (n,); what is a matrix already, as it is."""
    values = np.asarray(x, np.float64)
    if values.ndim == 2:
        return values
    return np.asarray(np.sign(values[:, None] - values[None]))


def _weights(x: ArrayLike, weights: ArrayLike | None) -> Floats:
    return np.ones(len(np.asarray(x))) if weights is None else np.asarray(weights, np.float64)


def _ratio(above: Floats, below: Floats) -> Floats:
    """above/√below, nan where that is 0."""
    root = np.sqrt(below)
    return np.asarray(np.divide(above, root, out=np.full_like(root, np.nan), where=root > 0))
