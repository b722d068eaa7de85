"""The rows that a run prints for people, of a battery."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from torsade.results import Result

__all__ = ["ROWS"]


def _battery(result: Result, report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    spec, unit = result.spec, report["T0_s"]
    yield "protocol", result.protocol
    yield "knot", report["knot"]
    fiber = f"{spec['material']}, radius {1e3 * result.dataset.attrs['radius']:g} mm"
    yield "fiber", f"{fiber}, L/h = {spec['slenderness']:g}"
    yield "twist density h theta'", f"{spec['twist']:g}"
    yield "units", f"T_0 = {unit:.4g} s, E_0 = {report['E0_J']:.4g} J"
    rest = f"loses {report['loss_per_T0']:.1e} of its energy in T_0 then"
    yield "charged", f"in {report['charged_in_T0']:.3g} T_0; {rest}"
    parts = "Lk = Tw + Wr", f"{report['link']:.4f} = {report['twist']:.4f} + {report['writhe']:.4f}"
    yield parts[0], f"{parts[1]} turns, kept to {report['link_error']:.1e}"
    energies = report["energy_E0"]
    kinds = ", ".join(f"{kind} {energies[kind]:.4f}" for kind in ("bend", "twist", "stretch", "contact"))
    joules = energies["total"] * report["E0_J"]
    yield "energy", f"{energies['total']:.4f} E_0, {joules:.4g} J: {kinds}"
    if spec["stop"] == "charged":
        yield from _spent(report)
        return
    yield "cut", f"at {report['cut_at']:.3f} of its length"
    for share, time in report["discharge_time_T0"].items():
        yield (
            f"down to {share} %",
            "not reached" if time is None else f"in {time:.4g} T_0, {time * unit:.4g} s",
        )
    yield "knots", ", ".join(f"{k['knot']} from {k['from_T0']:.3g} T_0" for k in report["knots"])
    lost = ", ".join(f"{time:.3g}" for time in report["crossings_lost_T0"])
    yield "crossings lost", f"at {lost} T_0" if lost else "none"
    yield "greatest power", f"{report['power_E0_per_T0']:.4g} E_0/T_0"
    yield "left", f"{report['energy_final_E0']:.2e} E_0; balance with drag to {report['balance_error']:.1e}"
    yield from _spent(report)


def _spent(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    yield "steps", f"{report['charge_steps']} before the cut, {report['steps']} after"
    yield "wall time", f"{report['wall_s']:.2f} s after the cut"


ROWS = {"battery": _battery}
