"""How nearly one quantity is proportional to another: slope through the origin, and correlation.

Both intervals come from a bootstrap over groups: bends that are one knot pulled in several ways are not
independent, so whole families are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Floats

__all__ = ["Estimate", "Proportion", "proportion"]

RESAMPLES = 4000
SEED = 43
LEVEL = 0.95


class Estimate(NamedTuple):
    """A number and its confidence interval."""

    value: float
    low: float
    high: float


class Proportion(NamedTuple):
    """y ≈ slope x over n items: least squares through the origin, and Pearson's correlation."""

    slope: Estimate
    correlation: Estimate
    n: int


def proportion(x: ArrayLike, y: ArrayLike, groups: Sequence[object]) -> Proportion:
    """Slope through the origin and correlation of x and y (n,), with 95 % intervals over groups (n,)."""
    a, b = np.asarray(x, np.float64), np.asarray(y, np.float64)
    _, group = np.unique([str(g) for g in groups], return_inverse=True)
    count = int(group.max()) + 1
    drawn = np.random.default_rng(SEED).integers(0, count, (RESAMPLES, count))
    times = (drawn[:, :, None] == np.arange(count)).sum(axis=1)
    weights = np.concatenate([np.ones((1, len(a))), times[:, group].astype(float)])
    found = np.stack([_slope(a, b, weights), _correlation(a, b, weights)])
    outer = 50 * (1 - LEVEL)
    low, high = np.nanpercentile(found[:, 1:], [outer, 100 - outer], axis=1)
    slope, correlation = (
        Estimate(float(v), float(l), float(h)) for v, l, h in zip(found[:, 0], low, high, strict=True)
    )
    return Proportion(slope, correlation, len(a))


def _slope(x: Floats, y: Floats, w: Floats) -> Floats:
    """Σ w x y / Σ w x² of samples w (m, n)."""
    return _ratio(w @ (x * y), w @ (x * x))


def _correlation(x: Floats, y: Floats, w: Floats) -> Floats:
    """Pearson's correlation of samples w (m, n)."""
    n = w.sum(axis=1)
    mean_x, mean_y = w @ x / n, w @ y / n
    covariance = w @ (x * y) / n - mean_x * mean_y
    spread = (w @ (x * x) / n - mean_x**2) * (w @ (y * y) / n - mean_y**2)
    return _ratio(covariance, np.sqrt(np.maximum(spread, 0.0)))


def _ratio(above: Floats, below: Floats) -> Floats:
    """above/below, nan where that is 0."""
    return np.asarray(np.divide(above, below, out=np.full_like(below, np.nan), where=below > 0))
