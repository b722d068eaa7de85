"""The rows that a run prints for people, of protocols that break or turn straight rods."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["ROWS"]

Rows = Iterator[tuple[str, str]]


def _rod(result: Result) -> Rows:
    spec, radius = result.spec, result.dataset.attrs["radius"]
    yield "protocol", result.protocol
    rod = f"{spec['material']}, length {1e3 * spec['length']:g} mm, radius {1e3 * radius:g} mm"
    yield "rod", f"{rod}, {spec['edges']} edges"


def _snapped(result: Result, report: dict[str, Any]) -> Rows:
    spec = result.spec
    yield from _rod(result)
    if "twist" in spec:
        yield "twist", f"{math.degrees(spec['twist']):.4g} deg"
    else:
        yield "speed", f"{1e3 * spec['speed']:.4g} mm/s"
    strength = f"{1e-6 * spec['sigma_c']:.4g} MPa by {spec['criterion']}"
    disorder = f", disorder {spec['disorder']:g}, seed {spec['seed']}" if spec["disorder"] else ""
    yield "strength", strength + disorder
    yield "least fragment length", f"{1e3 * spec['min_fragment']:.4g} mm"
    if not report["breaks"]:
        yield "fragments", f"1: it did not break within {1e3 * report['duration_s']:.4g} ms"
        return
    yield "critical curvature", f"{report['critical_curvature_per_m']:.4g} 1/m"
    yield "end distance", f"{1e3 * report['end_distance_m']:.2f} mm, at the first break"
    yield "Li", f"{report['li']:.3f}"
    lengths = ", ".join(f"{1e3 * length:.1f}" for length in report["lengths_m"])
    yield "fragments", f"{report['fragments']}: {lengths} mm"
    begin = report["breaks"][0]["time_s"]
    for k, at in enumerate(report["breaks"]):
        after = "" if k == 0 else f" after {1e6 * (at['time_s'] - begin):.0f} us,"
        ratio = f"stress {at['stress_ratio']:.3f} of the strength"
        yield f"break {k + 1}", f"at {1e3 * at['place_m']:.1f} mm{after or ','} {ratio}"
    yield from _spent(report)


def _pendulum(result: Result, report: dict[str, Any]) -> Rows:
    spec = result.spec
    yield from _rod(result)
    height = f", height {1e3 * spec['mass_height']:g} mm" if spec["mass_height"] else ""
    yield "cylinder", f"{1e3 * spec['mass']:g} g, radius {1e3 * spec['mass_radius']:g} mm{height}"
    yield "frequency", f"{report['frequency_Hz']:.4f} Hz, period {1e3 * report['period_s']:.2f} ms"
    half = report["swings_to_half"]
    swings = "no decay" if half is None else f"{half:.2f} swings to half the amplitude"
    yield "decay", f"{report['decay_per_s']:.4g} 1/s, {swings}"
    yield "shear modulus mu", f"{1e-9 * report['mu_Pa']:.4f} GPa, from the frequency"
    yield "twist damping b", f"{report['twist_damping_per_s']:.4g} 1/s, from the decay"
    yield from _spent(report)


def _spent(report: dict[str, Any]) -> Rows:
    yield "steps", f"{report['steps']}"
    yield "wall time", f"{report['wall_s']:.2f} s"


ROWS = {"snap-twist": _snapped, "snap-quench": _snapped, "pendulum": _pendulum}
"""The rows of each protocol, from its result and its report."""
