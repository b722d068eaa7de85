"""The rows that a run prints for people, of a suture."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from torsade.protocols.suture import SIX

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["ROWS"]


def _suture(result: Result, report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    spec, model = result.spec, json.loads(result.dataset.attrs["model"])
    yield "protocol", result.protocol
    named = f", {SIX[report['throws']]}" if report["throws"] in SIX else ""
    yield "throws", report["throws"] + named
    yield "preset", report["preset"]
    fiber = f"{spec['material']}, radius {1e3 * result.dataset.attrs['radius']:g} mm"
    yield "fiber", f"{fiber}, {result.dataset.sizes['node']} nodes"
    yield "pull", f"{1e3 * spec['force']:g} mN at each end for {spec['duration']:g} s"
    skin = f"radius {1e3 * model['skin_radius']:g} mm, gap {1e3 * model['gap']:g} mm at rest"
    yield "skin", f"{skin}, stiffness {spec['skin_stiffness']:g} N/m"
    writhe = report["writhe"]
    counts = f"N = {report['crossings']}, Wr = {f'{writhe:+d}' if writhe else 0}"
    yield "knot", f"{counts}, tau = {report['tau']:.4g}"
    closed = report["closed_at_s"]
    yield (
        "gap of the wound",
        f"{1e3 * report['gap_m']:.4g} mm" + (f", closed at {closed:.3g} s" if closed is not None else ""),
    )
    for name, moved in (("z_displacement_m", "moved along z"), ("z_peak_m", "most on the way")):
        a, b, relative = (1e6 * report[name][side] for side in ("a", "b", "relative"))
        yield moved, f"a {a:.3g} um, b {b:.3g} um, relative {relative:.3g} um"
    force = report["skin_force_N"]
    for name in ("normal", "shear"):
        yield (
            f"{name} force on skin",
            ", ".join(f"{side} {1e3 * value:.4g} mN" for side, value in zip("ab", force[name], strict=True)),
        )
    if report["slip_speed_m_per_s"] is not None:
        c_f = f", c_f = {report['c_f']:.3g}" if report["c_f"] is not None else ""
        yield "ends run out at", f"{1e3 * report['slip_speed_m_per_s']:.3g} mm/s{c_f}"
    if report["gap_after_release_m"] is not None:
        yield "gap when let go", f"{1e3 * report['gap_after_release_m']:.4g} mm"
    yield "steps", str(report["steps"])
    yield "wall time", f"{report['wall_s']:.2f} s"


ROWS = {"suture": _suture}
