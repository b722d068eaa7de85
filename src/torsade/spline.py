"""A smooth curve through given nodes, measured in its own arclength."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["ArclengthSpline"]

FloatArray = NDArray[np.float64]


class ArclengthSpline:
    """A C2 cubic through nodes at their chord lengths, measured in its own arclength.

    Attributes:
        arclength: of the nodes along the cubic [m], shape (n,), from 0 to the whole length.
    """

    def __init__(self, knots: FloatArray, parameter: FloatArray, closed: bool) -> None:
        """Run the cubic through `knots` [m], shape (n, 3), at increasing `parameter`, shape (n,).

        A closed curve repeats its first node at the end.
        """
        from scipy.interpolate import CubicSpline

        self.parameter = parameter
        self.curve = CubicSpline(parameter, knots, bc_type="periodic" if closed else "not-a-knot")
        self.velocity = self.curve.derivative()
        spans = self._span(parameter[:-1], parameter[1:])
        self.arclength = np.concatenate([[0.0], np.cumsum(spans)])

    def _span(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Arclength from parameter `start` to `end`, each within one cubic piece (Gauss, 8 points)."""
        nodes, weights = np.polynomial.legendre.leggauss(8)
        half = (end - start) / 2
        speed = np.linalg.norm(self.velocity((start + half)[:, None] + half[:, None] * nodes), axis=-1)
        return np.asarray(half * (speed @ weights))

    def at(self, s: FloatArray) -> FloatArray:
        """Points at arclengths `s`, by Newton steps kept within the piece each belongs to."""
        piece = np.clip(np.searchsorted(self.arclength, s, side="right") - 1, 0, len(self.parameter) - 2)
        start, end = self.parameter[piece], self.parameter[piece + 1]
        low, high = start.copy(), end.copy()
        span = self.arclength[piece + 1] - self.arclength[piece]
        q = start + (s - self.arclength[piece]) / span * (end - start)
        for _ in range(30):
            excess = self.arclength[piece] + self._span(start, q) - s
            low, high = np.where(excess < 0, q, low), np.where(excess < 0, high, q)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = q - excess / np.linalg.norm(self.velocity(q), axis=-1)
            q = np.where((newton >= low) & (newton <= high), newton, (low + high) / 2)
            if np.all(np.abs(excess) <= 1e-14 * self.arclength[-1]):
                break
        return np.asarray(self.curve(q))
