"""The map of chapter 5: 14 knots with 17 twist densities, which of them are slow, and what goes with that.

A battery is resonant when its discharge time is longer than the median of all batteries with its |h theta'|
by more than `SIGNIFICANT` times the spread that is left where twist has washed topology out: the robust
standard deviation (1.4826 times the median absolute deviation) of the logarithms of times at |h theta'| >
`WASHED_OUT` about the medians there. It is a peak when both its neighbours along the twist are shorter by the
factor `PEAK` or more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.arrays import Bools, Floats
from torsade.figures.base import Cell, Choice, Swept, Table
from torsade.figures.ranking import agreement
from torsade.protocols import battery

if TYPE_CHECKING:
    from torsade.sweep import Catalogue, Sweep

__all__ = ["KNOTS", "SWEPT", "TWISTS", "Slow", "causes", "design", "label", "of_known", "slow", "split"]

KNOTS = ("3_1", "4_1", "5_1", "5_2", "6_1", "6_2", "6_3", *(f"7_{k}" for k in range(1, 8)))
"""The prime knots through 7 crossings."""

TWISTS = tuple(-4 + 0.5 * k for k in range(17))
"""Twist densities h theta' at the start."""

KINDS, SHARES = battery.KINDS, tuple(map(str, battery.SHARES))

SIGNIFICANT = 3.0
WASHED_OUT = 1.0
PEAK = 1.25

QUICK: Mapping[str, Any] = {"nodes": 60, "charging": "0.5 s", "duration": "1 s", "frames": 8}
QUICK_KNOTS, QUICK_TWISTS = ("3_1", "4_1", "5_1", "7_4"), (-3.0, -1.5, 0.0, 1.5, 3.0)


def label(knot: str, twist: float) -> str:
    """Name of the run of a battery that figures show."""
    return f"battery {knot} twist {twist:g}"


def design(choice: Choice) -> Sweep:
    """What is run."""
    from torsade.sweep import Sweep

    if choice.quick:
        return Sweep("battery", fixed=QUICK, grid={"knot": QUICK_KNOTS, "twist": QUICK_TWISTS})
    return Sweep("battery", grid={"knot": KNOTS, "twist": {"from": -4, "to": 4, "step": 0.5}})


COLUMNS: Mapping[str, str] = {
    "knot": "knot",
    "twist": "twist_density",
    **{f"energy_E0_{kind}": f"{kind}_E0" for kind in KINDS},
    "energy_E0_total": "energy_E0",
    "link": "Lk",
    "twist_found": "Tw",
    "writhe": "Wr",
    "link_error": "link_error",
    "knot_kept": "knot_kept",
    **{f"discharge_time_T0_{share}": f"T{share}_T0" for share in SHARES},
    "non_planarity_charged": "non_planarity_charged",
    "non_planarity_on_the_way": "non_planarity",
    "torsion_on_the_way": "torsion",
    "cut_at": "cut_at",
    "intermediate_knots": "knots_on_the_way",
    "wall_s": "seconds",
}
"""Columns of the catalogue, and what they are called in the table."""


def measure(catalogue: Catalogue, choice: Choice) -> dict[str, Table]:
    """The map, a row for every battery; its sum by knot; shares of energy; what goes with slowness."""
    names = ", ".join(f'"{column}"' for column in COLUMNS)
    found = catalogue.query(f"SELECT status, {names} FROM runs ORDER BY point").arrays()
    numbers = {title: found[column] for column, title in COLUMNS.items()}
    resonant = slow(numbers)
    numbers |= {"slowness": resonant.slowness, "resonant": resonant.resonant, "peak": resonant.peak}
    return {
        "": _by_knot(numbers),
        "map": _table({"knot": numbers.pop("knot"), "status": found["status"], **numbers}),
        "split": split(numbers),
        "causes": causes(numbers),
    }


class Slow(NamedTuple):
    """Which batteries are slow.

    Attributes
    ----------
    slowness : discharge time to 10 % over the median at that |h theta'|, shape (n,)
    resonant : whether it is significantly slow
    peak : whether both neighbours along the twist are shorter by the factor `PEAK` or more
    least : slowness of a resonant battery, at least
    """

    slowness: Floats
    resonant: Bools
    peak: Bools
    least: float


def of_known(f: Callable[[Floats], Any], values: Floats) -> float:
    """f of those values that are finite; NaN where none is: what failed or never got there has none."""
    known = values[np.isfinite(values)]
    return float(f(known)) if len(known) else math.nan


def slow(numbers: Mapping[str, NDArray[Any]], share: str = "10") -> Slow:
    """Which batteries discharge slowly to so many per cent; those that do not get there are not."""
    log = np.log(np.asarray(numbers[f"T{share}_T0"], np.float64))
    size = np.abs(np.asarray(numbers["twist_density"], np.float64))
    medians = {s: of_known(np.median, log[size == s]) for s in np.unique(size)}
    middle = np.array([medians[s] for s in size])
    beyond = log - middle
    least = SIGNIFICANT * 1.4826 * of_known(np.median, np.abs(beyond[size > WASHED_OUT]))
    peak = np.zeros(len(log), bool)
    for knot in dict.fromkeys(numbers["knot"]):
        own = np.flatnonzero(numbers["knot"] == knot)
        own = own[np.argsort(numbers["twist_density"][own])]
        inner = own[1:-1]
        beside = np.maximum(log[own[:-2]], log[own[2:]])
        peak[inner] = log[inner] - beside > np.log(PEAK)
    return Slow(np.exp(beyond), beyond > least, peak, float(np.exp(least)))


def split(numbers: Mapping[str, NDArray[Any]]) -> Table:
    """Medians and extremes over knots, at each |h theta'|, of shares of energy at the cut and of times.

    Batteries that failed are counted in `batteries` and nowhere else.
    """
    size = np.abs(numbers["twist_density"])
    total = numbers["energy_E0"]
    rows: list[tuple[Cell, ...]] = []
    for s in np.unique(size):
        here = size == s
        shares = [of_known(np.median, numbers[f"{kind}_E0"][here] / total[here]) for kind in KINDS]
        ratio = numbers["twist_E0"][here] / numbers["bend_E0"][here]
        more = of_known(lambda known: np.mean(known > 1), ratio)
        times = numbers["T10_T0"][here]
        spread = [of_known(f, times) for f in (np.min, np.median, np.max)]
        rows.append((float(s), int(here.sum()), *shares, more, *spread))
    kinds = tuple(f"{kind}_share" for kind in KINDS)
    heads = ("h_theta_prime", "batteries", *kinds, "twist_above_bend", "T10_least", "T10_median", "T10_most")
    return Table(heads, rows)


CAUSES = {
    "non_planarity": "non-planarity on the way",
    "non_planarity_charged": "non-planarity, charged",
    "torsion": "torsion on the way",
    "abs_Wr": "size of the writhe",
    "energy_E0": "energy at the cut",
    "stretch_share": "share of stretch and contact",
}
"""What discharge times may go with."""


def causes(numbers: Mapping[str, NDArray[Any]]) -> Table:
    """Spearman's correlations of discharge times with shapes and energies, by parts of the map."""
    size = np.abs(numbers["twist_density"])
    beside = dict(numbers) | {
        "abs_Wr": np.abs(numbers["Wr"]),
        "stretch_share": (numbers["stretch_E0"] + numbers["contact_E0"]) / numbers["energy_E0"],
    }
    parts = {"0": size == 0, "0.5 to 1": (size > 0) & (size <= WASHED_OUT), "above 1": size > WASHED_OUT}
    rows: list[tuple[Cell, ...]] = []
    for name, where in parts.items():
        for cause, title in CAUSES.items():
            for share in SHARES:
                x, y = (np.asarray(beside[key], np.float64)[where] for key in (cause, f"T{share}_T0"))
                known = np.isfinite(x) & np.isfinite(y)
                if known.sum() > 3:
                    rho = agreement(x[known], y[known]).spearman
                    rows.append((name, title, f"{share} %", int(known.sum()), *rho))
    return Table(("h_theta_prime", "cause", "time_to", "batteries", "spearman", "low", "high"), rows)


def _by_knot(numbers: Mapping[str, NDArray[Any]]) -> Table:
    """A row for every knot: its times to 10 % without twist and at most, and where it is resonant."""
    rows: list[tuple[Cell, ...]] = []
    for knot in dict.fromkeys(numbers["knot"]):
        own = numbers["knot"] == knot
        twist, times = numbers["twist_density"][own], numbers["T10_T0"][own]
        longest = int(np.nanargmax(times)) if np.isfinite(times).any() else 0
        where = ", ".join(f"{t:+g}" for t in twist[numbers["resonant"][own]])
        plain = np.flatnonzero(twist == 0)
        untwisted = float(times[plain[0]]) if len(plain) else None
        energy = float(numbers["energy_E0"][own][plain[0]]) if len(plain) else None
        rows.append((str(knot), energy, untwisted, float(times[longest]), float(twist[longest]), where))
    heads = ("knot", "energy_E0", "T10_untwisted_T0", "T10_longest_T0", "at_h_theta_prime", "resonant_at")
    return Table(heads, rows)


def _table(numbers: Mapping[str, NDArray[Any]]) -> Table:
    return Table(tuple(numbers), [tuple(map(_cell, row)) for row in zip(*numbers.values(), strict=True)])


def _cell(value: Any) -> Cell:
    """A value of the catalogue as a cell: what is a list becomes text."""
    if isinstance(value, list):
        return ", ".join(v if isinstance(v, str) else f"{v:g}" for v in value)
    plain: Cell = value.item() if isinstance(value, np.generic) else value
    return plain


SWEPT = Swept("battery-map", design, measure)
