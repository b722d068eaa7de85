"""What many trials say together: means with errors, shares, the smallest fragment, averages over sectors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri, stdtrit

from torsade.fracture.rod import Rod

__all__ = [
    "CONFIDENCE",
    "Mean",
    "Rays",
    "Sector",
    "Share",
    "mean",
    "sector_angle",
    "sectors",
    "share",
    "smallest_fragment",
]

Floats = NDArray[np.float64]

CONFIDENCE = 0.95
"""Of intervals, unless another is asked for."""

Rays = Literal["ellipse", "printed"]


class Mean(NamedTuple):
    """A mean of n values.

    Attributes
    ----------
    value, deviation : mean and standard deviation; the deviation of one value is NaN
    error : standard error of the mean
    low, high : interval of confidence (Student)
    n : how many values
    """

    value: float
    deviation: float
    error: float
    low: float
    high: float
    n: int


class Share(NamedTuple):
    """k of n, with an interval of confidence (Wilson)."""

    value: float
    low: float
    high: float
    k: int
    n: int


def mean(values: ArrayLike, confidence: float = CONFIDENCE) -> Mean:
    """The mean of at least one value, its errors, and an interval for values that scatter normally."""
    x = np.asarray(values, dtype=np.float64)
    n = len(x)
    centre = float(x.mean())
    if n < 2:
        return Mean(centre, math.nan, math.nan, math.nan, math.nan, n)
    deviation = float(x.std(ddof=1))
    error = deviation / math.sqrt(n)
    reach = error * float(stdtrit(n - 1, 0.5 * (1 + confidence)))
    return Mean(centre, deviation, error, centre - reach, centre + reach, n)


def share(k: int, n: int, confidence: float = CONFIDENCE) -> Share:
    """k of n trials, with Wilson's interval, which stays between 0 and 1 and holds for few trials too."""
    z = float(ndtri(0.5 * (1 + confidence)))
    p = k / n
    centre = (p + z * z / (2 * n)) / (1 + z * z / n)
    reach = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return Share(p, max(0.0, centre - reach), min(1.0, centre + reach), k, n)


def smallest_fragment(pieces: int, smallest: float | None, L: float) -> float | None:
    """lambda* of a trial [m] (3.3): L/4 of two pieces, else the smallest length; None when not measured.

    The first break is near the middle, so a rod breaks in two when no further break fits: when the smallest
    fragment is longer than L/4. The mean of lambda* over trials estimates lambda. It is an upper bound where
    pieces are longer than they had to be, and bounded by L/4.
    """
    return L / 4 if pieces == 2 else smallest


class Sector(NamedTuple):
    """Trials between two rays of the plane of twist and limit curvature.

    Attributes
    ----------
    low, high : angles of the rays [rad], from the axis of twist
    twist : [rad]; of its absolute value
    kappa : limit curvature [1/m]
    pieces : number of pieces
    """

    low: float
    high: float
    twist: Mean
    kappa: Mean
    pieces: Mean

    @property
    def row(self) -> tuple[float, float, int, float, float, float, float, float, float]:
        """For tables: rays [deg], trials; means and standard deviations of twist [deg], kappa, pieces."""
        return (
            math.degrees(self.low),
            math.degrees(self.high),
            self.pieces.n,
            math.degrees(self.twist.value),
            math.degrees(self.twist.deviation),
            self.kappa.value,
            self.kappa.deviation,
            self.pieces.value,
            self.pieces.deviation,
        )


def sector_angle(twist: ArrayLike, kappa: ArrayLike, rod: Rod, rays: Rays = "ellipse") -> Floats:
    """Angle [rad] of trials in the plane of twist and limit curvature, 0 without bending, pi/2 without twist.

    With `ellipse` the plane is scaled so that curves of constant effective stress are circles,

        tan phi = sqrt(E^2 I) kappa L/(sqrt(mu^2 J) |Tw|);

    with `printed` it is that of Fig. 3-4F, whose rays go through (mu^2 J L^-1 cos phi, E^2 I sin phi), as
    numbers in SI units: squares of the scales, with L where dimensions disagree.
    """
    bent = np.asarray(kappa, dtype=np.float64)
    twisted = np.abs(np.asarray(twist, dtype=np.float64))
    ratio = rod.E**2 / (2 * rod.mu**2)  # E^2 I/(mu^2 J)
    scale = math.sqrt(ratio) * rod.L if rays == "ellipse" else 1 / (ratio * rod.L)
    return np.arctan2(scale * bent, twisted)


def sectors(
    twist: Sequence[float],
    kappa: Sequence[float],
    pieces: Sequence[int],
    rod: Rod,
    count: int = 10,
    rays: Rays = "ellipse",
) -> list[Sector]:
    """Averages over sectors of equal angle that are not empty, from twist alone to bending alone.

    Parameters
    ----------
    twist, kappa, pieces : of each trial: total twist [rad], limit curvature [1/m], number of pieces
    rod : that was broken
    count : of sectors
    rays : as in `sector_angle`
    """
    angle = sector_angle(twist, kappa, rod, rays)
    which = np.clip((angle / (math.pi / 2) * count).astype(np.int64), 0, count - 1)
    found = []
    for k in range(count):
        inside = np.flatnonzero(which == k)
        if len(inside):
            found.append(
                Sector(
                    low=k * math.pi / (2 * count),
                    high=(k + 1) * math.pi / (2 * count),
                    twist=mean(np.abs(_chosen(twist, inside))),
                    kappa=mean(_chosen(kappa, inside)),
                    pieces=mean(_chosen(pieces, inside)),
                )
            )
    return found


def _chosen(values: Iterable[float], inside: NDArray[np.int64]) -> Floats:
    return np.asarray(list(values), dtype=np.float64)[inside]
