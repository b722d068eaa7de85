"""Runs and numbers of sutures that figures share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from torsade.figures.base import Choice, Table
from torsade.protocols.suture import SIX, Suture

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["FRICTIONS", "label", "suture", "table"]

FRICTIONS = (0.0, 0.3)
"""Coefficients of dry friction on skin: the thesis's model has none."""


def label(throws: str, friction: float) -> str:
    """Name of a run."""
    return f"suture {throws.replace(',', ' ')} friction {friction:g}"


def suture(throws: str, friction: float, choice: Choice) -> Suture:
    """A suture as figures show it."""
    options: dict[str, Any] = {"duration": 0.2, "frames": 10} if choice.quick else {}
    return Suture(throws=throws, friction=friction, **options)


def table(results: Mapping[str, Result]) -> Table:
    """What every suture does to the skin, at the end of the pull and where z was largest."""
    columns = (
        "throws", "knot", "friction", "N", "Wr", "tau", "z_a_m", "z_b_m", "z_relative_m", "z_largest_a_m",
        "z_largest_relative_m", "gap_m", "normal_a_N", "shear_a_N", "slip_speed_m_per_s", "c_f",
    )  # fmt: skip
    rows: list[tuple[Any, ...]] = []
    for throws, name in SIX.items():
        for friction in FRICTIONS:
            found = results.get(label(throws, friction))
            if found is None:
                continue
            r = Suture.report(found)
            z, most, force = r["z_displacement_m"], r["z_peak_m"], r["skin_force_N"]
            rows.append(
                (
                    throws, name, friction, r["crossings"], r["writhe"], r["tau"], z["a"], z["b"],
                    z["relative"], most["a"], most["relative"], r["gap_m"], force["normal"][0],
                    force["shear"][0],
                    r["slip_speed_m_per_s"], r["c_f"],
                )
            )  # fmt: skip
    return Table(columns, rows)
