"""A torsion pendulum's track: frequency and decay of the swing, fitted to angles against time."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from torsade.errors import TorsadeError

__all__ = ["Swing", "fit_swing"]

Floats = NDArray[np.float64]

FEWEST = 12
"""Fewest points of a track."""

FASTEST = 200.0
"""Decay or growth over a track, as a logarithm, beyond which the search for it is not followed."""


class Swing(NamedTuple):
    """theta = rest + amplitude exp(-decay t) cos(omega t + phase), t from the first point.

    Attributes
    ----------
    omega, decay : angular frequency and decay rate of the amplitude [1/s]
    omega_error, decay_error : standard errors, from the residuals taken as independent
    amplitude, rest : [rad]
    residual : root mean square [rad]
    """

    omega: float
    decay: float
    omega_error: float
    decay_error: float
    amplitude: float
    rest: float
    residual: float


def fit_swing(time: ArrayLike, angle: ArrayLike) -> Swing:
    """Fit a swing to a track.

    For given omega and decay the rest is linear, so that only two numbers are searched for. The first omega
    is where the spectrum of the track is largest; times need not be even.

    Parameters
    ----------
    time : increasing [s], shape (n,)
    angle : [rad], shape (n,)

    Raises
    ------
    TorsadeError
        When the track is too short, does not move, shows less than one oscillation, or too little of each.
    """
    t, theta = np.asarray(time, dtype=np.float64), np.asarray(angle, dtype=np.float64)
    if len(t) < FEWEST:
        raise TorsadeError(
            f"a pendulum's track has {len(t)} points; give at least {FEWEST}, over some swings"
        )
    if not (np.diff(t) > 0).all():
        raise TorsadeError(
            "the times of a pendulum's track do not increase; give its points in order of time"
        )
    if not float(np.ptp(theta)) > 0:
        raise TorsadeError("a pendulum's track does not move; give angles against time")
    t = t - t[0]
    span = float(t[-1])
    first = _first_frequency(t, theta)
    if first * span < 2 * math.pi:
        raise TorsadeError("a pendulum's track shows less than one oscillation; give a longer one")

    def residual_of(p: Floats) -> Floats:
        return _linear(t, theta, p)[1]

    starts = [(first, decay) for decay in (0.0, 1 / span, 0.1 * first)]
    fits = [least_squares(residual_of, start, x_scale=(first, first)) for start in starts]
    best = min(fits, key=lambda found: found.cost)
    omega, decay = abs(float(best.x[0])), float(best.x[1])
    c, residuals = _linear(t, theta, best.x)
    freedom = len(t) - 5
    variance = float((residuals**2).sum()) / freedom
    slopes = np.asarray(best.jac, dtype=np.float64)
    try:
        errors = np.sqrt(variance * np.diag(np.linalg.inv(slopes.T @ slopes)))
    except np.linalg.LinAlgError:
        raise TorsadeError(
            "a pendulum's track does not tell its frequency and decay; give several points of every swing"
        ) from None
    return Swing(
        omega=omega,
        decay=decay,
        omega_error=float(errors[0]),
        decay_error=float(errors[1]),
        amplitude=math.hypot(float(c[0]), float(c[1])),
        rest=float(c[2]),
        residual=math.sqrt(float((residuals**2).mean())),
    )


def _linear(t: Floats, theta: Floats, p: Floats) -> tuple[Floats, Floats]:
    """Coefficients of cos, sin and 1 for given frequency and decay, and the residuals."""
    envelope = np.exp(np.clip(-p[1] * t, -FASTEST, FASTEST))
    columns = np.column_stack([envelope * np.cos(p[0] * t), envelope * np.sin(p[0] * t), np.ones(len(t))])
    c = np.linalg.lstsq(columns, theta, rcond=None)[0]
    return c, theta - columns @ c


def _first_frequency(t: Floats, theta: Floats) -> float:
    """Angular frequency at which the spectrum is largest, from half an oscillation to the spacing."""
    span = float(t[-1])
    highest = math.pi / float(np.median(np.diff(t)))
    count = int(min(20000, max(64, 4 * highest * span / math.pi)))
    grid = np.linspace(math.pi / span, highest, count)
    centred = theta - theta.mean()
    power = np.array([abs(np.exp(-1j * w * t) @ centred) for w in grid])
    return float(grid[np.argmax(power)])
