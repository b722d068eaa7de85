"""Curves through what was measured at several speeds: power laws, and saturation as (3.8) has it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares
from scipy.special import stdtrit

from torsade.errors import TorsadeError
from torsade.fracture.statistics import CONFIDENCE
from torsade.fracture.theory.quench import fracture_sites

__all__ = ["Fit", "Parameter", "power_law", "saturation"]

Floats = NDArray[np.float64]


class Parameter(NamedTuple):
    """A fitted number, its standard error, and its interval of confidence."""

    value: float
    error: float
    low: float
    high: float


class Fit(NamedTuple):
    """A fitted curve.

    Attributes
    ----------
    parameters : by name
    residual : root of the mean square of residuals, in standard errors where these were given, else relative
    n : number of points
    """

    parameters: dict[str, Parameter]
    residual: float
    n: int


def power_law(
    v: ArrayLike, y: ArrayLike, error: ArrayLike | None = None, confidence: float = CONFIDENCE
) -> Fit:
    """y = amplitude (v/v_0)^exponent, a straight line through the logarithms; v_0 is one SI unit.

    Parameters
    ----------
    v, y : at least three points, above 0
    error : standard errors of y; points weigh as the inverse of their squares. How large they are together
        does not matter: intervals come from the scatter about the line (Student, n - 2 degrees of freedom)
    confidence : of the intervals

    Raises
    ------
    TorsadeError
        When there are too few points, or not all are above 0.
    """
    x, z = _points(v, y, "a power law")
    spread = np.ones(len(x)) if error is None else np.asarray(error, dtype=np.float64) / z
    _check_errors(spread)
    w = 1 / spread**2
    a, b = np.log(x), np.log(z)
    centre = float((w * a).sum() / w.sum())
    square = float((w * (a - centre) ** 2).sum())
    exponent = float((w * (a - centre) * b).sum() / square)
    at_centre = float((w * b).sum() / w.sum())
    residuals = (b - at_centre - exponent * (a - centre)) / spread
    variance = float((residuals**2).sum()) / (len(x) - 2)
    slope_error = math.sqrt(variance / square)
    level_error = math.sqrt(variance * (1 / float(w.sum()) + centre**2 / square))
    t = float(stdtrit(len(x) - 2, 0.5 * (1 + confidence)))
    parameters = {
        "exponent": Parameter(exponent, slope_error, exponent - t * slope_error, exponent + t * slope_error),
        "amplitude": _exponential(at_centre - exponent * centre, level_error, t),
    }
    return Fit(parameters, math.sqrt(float((residuals**2).mean())), len(x))


def saturation(
    v: ArrayLike, y: ArrayLike, error: ArrayLike | None = None, confidence: float = CONFIDENCE
) -> Fit:
    """y = limit erfc(sqrt(B^2/v)) (3.8): the number of breaks at speed v, which has a limit at high speed.

    Parameters, errors and intervals as in `power_law`; `B_squared` is in m/s. Both are fitted by their
    logarithms, by least squares from several starts.

    Raises
    ------
    TorsadeError
        When there are too few points, or not all are above 0.
    """
    x, z = _points(v, y, "a saturation")
    spread = np.ones(len(x)) * float(z.mean()) if error is None else np.asarray(error, dtype=np.float64)
    _check_errors(spread)

    def misfit(p: Floats) -> Floats:
        return np.asarray((math.exp(p[0]) * fracture_sites(x, math.exp(p[1])) - z) / spread)

    # Beyond these B^2 cannot be told from 0, or from infinity.
    low, high = math.log(1e-8 * float(x.min())), math.log(30 * float(x.max()))
    starts = [float(s) for s in np.linspace(low + 1, high - 1, 8)]
    solved = [_solved(misfit, (math.log(float(z.max())), s), low, high) for s in starts]
    best, jacobian, cost = min(solved, key=lambda found: found[2])
    variance = 2 * cost / (len(x) - 2)
    normal = jacobian.T @ jacobian
    known = np.linalg.cond(normal) < 1e14
    errors = np.sqrt(variance * np.diag(np.linalg.inv(normal))) if known else np.full(2, math.inf)
    t = float(stdtrit(len(x) - 2, 0.5 * (1 + confidence)))
    parameters = {
        "limit": _exponential(best[0], float(errors[0]), t),
        "B_squared": _exponential(best[1], float(errors[1]), t),
    }
    return Fit(parameters, math.sqrt(2 * cost / len(x)), len(x))


def _solved(
    misfit: Callable[[Floats], Floats], start: tuple[float, float], low: float, high: float
) -> tuple[Floats, Floats, float]:
    """Parameters, derivatives of the misfit and half the sum of its squares."""
    bounds = ([-np.inf, low], [np.inf, high])
    found = least_squares(misfit, start, bounds=bounds, xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return np.asarray(found.x), np.asarray(found.jac), float(found.cost)


def _exponential(logarithm: float, error: float, t: float) -> Parameter:
    """A parameter that was fitted by its logarithm."""
    value = math.exp(logarithm)
    reach = min(t * error, 700.0)
    return Parameter(value, value * error, value * math.exp(-reach), value * math.exp(reach))


def _points(v: ArrayLike, y: ArrayLike, what: str) -> tuple[Floats, Floats]:
    x, z = np.asarray(v, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if len(np.unique(x)) < 3:
        raise TorsadeError(
            f"{what} cannot be fitted to {len(np.unique(x))} different speeds; give at least 3"
        )
    if not ((x > 0).all() and (z > 0).all()):
        raise TorsadeError(f"{what} cannot be fitted where something is not above 0; leave such points out")
    return x, z


def _check_errors(spread: Floats) -> None:
    if not (np.isfinite(spread).all() and (spread > 0).all()):
        raise TorsadeError(
            "standard errors of a fit must be finite and above 0; leave them out to weigh all alike"
        )
