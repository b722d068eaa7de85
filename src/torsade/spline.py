"""A smooth curve through given nodes, measured in its own arclength."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["ArclengthSpline"]

FloatArray = NDArray[np.float64]

_PARTS = 8


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

        self.curve = CubicSpline(parameter, knots, bc_type="periodic" if closed else "not-a-knot")
        self.velocity = self.curve.derivative()
        # Where nodes are few the speed varies much within a piece of the cubic: measure it in parts.
        part = np.linspace(0, 1, _PARTS, endpoint=False)
        inner = parameter[:-1, None] + np.diff(parameter)[:, None] * part
        self._parameter = np.append(inner, parameter[-1])
        spans = self._span(self._parameter[:-1], self._parameter[1:])
        self._arclength = np.concatenate([[0.0], np.cumsum(spans)])
        self.arclength = self._arclength[::_PARTS]

    def _span(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Arclength from parameter `start` to `end`, each within one part (Gauss, 8 points)."""
        nodes, weights = np.polynomial.legendre.leggauss(8)
        half = (end - start) / 2
        speed = np.linalg.norm(self.velocity((start + half)[:, None] + half[:, None] * nodes), axis=-1)
        return np.asarray(half * (speed @ weights))

    def at(self, s: FloatArray) -> FloatArray:
        """Points at arclengths `s`, by Newton steps kept within the part each belongs to."""
        part = np.clip(np.searchsorted(self._arclength, s, side="right") - 1, 0, len(self._parameter) - 2)
        start, before = self._parameter[part], self._arclength[part]
        low, high = start, self._parameter[part + 1]
        q = start + (s - before) / (self._arclength[part + 1] - before) * (high - low)
        for _ in range(30):
            excess = before + self._span(start, q) - s
            if np.all(np.abs(excess) <= 1e-13 * self.arclength[-1]):
                break
            low, high = np.where(excess < 0, q, low), np.where(excess < 0, high, q)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = q - excess / np.linalg.norm(self.velocity(q), axis=-1)
            q = np.where((newton >= low) & (newton <= high), newton, (low + high) / 2)
        return np.asarray(self.curve(q))
