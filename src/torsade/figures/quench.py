"""Quenches for the figures of chapter 3: rods driven together at many speeds, with strengths that scatter.

The equations of rods hardly know the speed: up to 500 mm/s the kinetic energy is small against that of
bending. What changes with speed in experiments is lambda, the least length of a fragment, which the model is
given. So rods are broken twice, with one lambda at all speeds, and with the thesis's lambda ~ v^(-1/4).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.errors import TorsadeError
from torsade.figures import breaking
from torsade.figures.base import Cell, Choice, Table
from torsade.fracture.fits import Fit, power_law, saturation
from torsade.fracture.statistics import mean, smallest_fragment
from torsade.fracture.theory.quench import fracture_sites, fragment_length
from torsade.view._extra import require

if TYPE_CHECKING:
    from torsade.protocols.snap_quench import SnapQuench
    from torsade.results import Result

__all__ = ["SPEEDS", "draw_breaks", "fit_table", "runs", "speed_table", "trial_table"]

SPEEDS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
"""Speeds [m/s] at which the ends near each other."""

LAMBDA, AT = 0.03, 0.003
"""Length of the smallest fragment [m] at a speed [m/s] (3.3)."""

LAWS = ("fixed", "scaled")


def least_length(v: float, law: str) -> float:
    """lambda [m] that rods driven at v [m/s] are given."""
    return LAMBDA if law == "fixed" else float(fragment_length(v, LAMBDA, at=AT))


def runs(which: int, choice: Choice, law: str = "scaled") -> dict[str, SnapQuench]:
    """Quenches of a set of rods, by label."""
    from torsade.protocols.snap_quench import SnapQuench

    rod = breaking.RODS[which]
    speeds, seeds = (SPEEDS[::4], 1) if choice.quick else (SPEEDS, 6)
    return {
        f"quench-{which}-{law}-{1e3 * v:g}-{seed}": SnapQuench(
            length=rod.L,
            radius=rod.h,
            sigma_c=breaking.SIGMA_C[which],
            speed=v,
            min_fragment=least_length(v, law),
            approach=0.01,
            disorder=breaking.DISORDER,
            seed=seed,
            frames=4,
        )
        for v in speeds
        for seed in range(1, seeds + 1)
    }


def trial_table(results: Mapping[str, Result], which: int, law: str = "scaled") -> Table:
    """What came of each rod."""
    columns = ("speed_mm_per_s", "seed", "given_lambda_mm", "limit_curvature_per_m", "pieces", "smallest_mm")
    rows: list[tuple[Cell, ...]] = []
    for label, result in results.items():
        if label.startswith(f"quench-{which}-{law}-"):
            spec, attrs = result.spec, result.dataset.attrs
            rows.append(
                (
                    1e3 * float(spec["speed"]),
                    int(spec["seed"]),
                    1e3 * float(spec["min_fragment"]),
                    float(attrs["critical_curvature_per_m"]),
                    int(attrs["fragments"]),
                    1e3 * min(attrs["lengths_m"]),
                )
            )
    return Table(columns, rows)


def speed_table(results: Mapping[str, Result], which: int, law: str = "scaled") -> Table:
    """Means at each speed, with standard errors."""
    trials = trial_table(results, which, law)
    c = {name: np.asarray(trials.column(name), np.float64) for name in trials.columns}
    columns = (
        "speed_mm_per_s", "trials", "given_lambda_mm", "breaks", "breaks_se", "lambda_mm", "lambda_se_mm",
        "limit_curvature_per_m", "limit_curvature_sd_per_m",
    )  # fmt: skip
    rows: list[tuple[Cell, ...]] = []
    for v in sorted(set(c["speed_mm_per_s"])):
        at = c["speed_mm_per_s"] == v
        breaks = mean(c["pieces"][at] - 1)
        length = 1e3 * breaking.RODS[which].L
        measured = [
            smallest_fragment(int(n), x, length)
            for n, x in zip(c["pieces"][at], c["smallest_mm"][at], strict=True)
        ]
        shortest, kappa = mean(np.asarray(measured, np.float64)), mean(c["limit_curvature_per_m"][at])
        rows.append(
            (
                float(v),
                breaks.n,
                float(c["given_lambda_mm"][at][0]),
                breaks.value,
                breaks.error,
                shortest.value,
                shortest.error,
                kappa.value,
                kappa.deviation,
            )
        )
    return Table(columns, rows)


def fit_table(speeds: Mapping[str, Table]) -> Table:
    """Exponents and saturation, with intervals, for each law of lambda; none where all rods break alike."""
    rows: list[tuple[Cell, ...]] = []
    for law, table in speeds.items():
        v = 1e-3 * np.asarray(table.column("speed_mm_per_s"), np.float64)
        breaks = np.asarray(table.column("breaks"), np.float64)
        length = np.asarray(table.column("lambda_mm"), np.float64)
        if np.ptp(breaks) == 0:
            rows.append((law, "breaks", "exponent", 0.0, None, None, 0.25))
            continue
        try:
            fits: tuple[tuple[str, Fit, str, float | None], ...] = (
                ("lambda", power_law(v, length), "exponent", -0.25),
                ("breaks", power_law(v, breaks), "exponent", 0.25),
                ("saturation", saturation(v, breaks), "limit", None),
                ("saturation", saturation(v, breaks), "B_squared", 1e-3),
            )
        except TorsadeError:
            continue
        for what, fit, name, expected in fits:
            p = fit.parameters[name]
            rows.append((law, what, name, p.value, p.low, p.high, expected))
    return Table(("lambda_given", "of", "parameter", "value", "low", "high", "thesis"), rows)


def draw_breaks(axes: Any, table: Table, colour: str, label: str) -> None:
    """Breaks against speed with their saturation (3.8)."""
    v = np.asarray(table.column("speed_mm_per_s"), np.float64)
    breaks = np.asarray(table.column("breaks"), np.float64)
    error = np.nan_to_num(np.asarray(table.column("breaks_se"), np.float64))
    axes.errorbar(v, breaks, yerr=error, fmt="o", color=colour, markersize=3.8, elinewidth=0.8, label=label)
    if len(v) > 3 and np.ptp(breaks) > 0:
        fit = saturation(1e-3 * v, breaks).parameters
        fine = np.geomspace(v.min(), v.max(), 200)
        curve = fit["limit"].value * fracture_sites(1e-3 * fine, fit["B_squared"].value)
        axes.plot(fine, curve, color=colour, linewidth=0.9, linestyle=(0, (4, 2)))
    axes.set_xscale("log")
    axes.yaxis.set_major_locator(require("matplotlib.ticker").MaxNLocator(integer=True))
    axes.set_xlabel("quench speed v (mm/s)")
    axes.set_ylabel(r"number of breaks $N_f$")
