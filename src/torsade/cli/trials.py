"""What `torsade trials` does: read trials of broken rods, and say what they say together."""

from __future__ import annotations

import json as json_format
import math
import re
from collections.abc import Iterator
from typing import Any

from torsade.errors import QuantityError, TorsadeError, counted, quoted
from torsade.fracture.analysis import Analysis, Broken, analyse
from torsade.fracture.criteria import CRITERIA
from torsade.fracture.fits import Fit
from torsade.fracture.rod import Rod
from torsade.fracture.statistics import Mean, Share
from torsade.fracture.theory.bending_wave import AMPLIFICATION
from torsade.fracture.trials import Trials, read_trials
from torsade.material import named_material
from torsade.units import bearable

__all__ = ["number_of", "report", "trials"]

RAYS = ("ellipse", "printed")


def trials(
    file: str,
    length: str,
    radius: str,
    material: str,
    strength: str,
    criterion: str,
    amplification: str | None,
    sectors: str,
    rays: str,
    slow: str | None,
    json: bool,
) -> int:
    """Read, analyse, print."""
    rod = Rod.of(
        named_material(material),
        h=number_of("--radius", radius, "length"),
        L=number_of("--length", length, "length"),
    )
    if criterion not in CRITERIA:
        raise TorsadeError(f"--criterion is {quoted(criterion)}; give one of {', '.join(CRITERIA)}")
    if rays not in RAYS:
        raise TorsadeError(f"--rays is {quoted(rays)}; give one of {' or '.join(RAYS)}")
    if not re.fullmatch(r"[1-9]\d{0,2}", sectors, re.A):
        raise TorsadeError(f"--sectors is {quoted(sectors)}; give a whole number from 1 to 999")
    C = AMPLIFICATION if amplification is None else number_of("--amplification", amplification, "number")
    if C < 1:
        raise TorsadeError(f"--amplification is {C:g}; give 1 or more, such as 1.5")
    read = read_trials(file, rod)
    found = analyse(
        read.trials,
        rod,
        number_of("--strength", strength, "pressure"),
        criterion=criterion,  # type: ignore[arg-type]
        C=C,
        count=int(sectors),
        rays=rays,  # type: ignore[arg-type]
        slow=math.inf if slow is None else number_of("--slow", slow, "velocity"),
    )
    if json:
        print(json_format.dumps(report(file, read, rod, found), allow_nan=False), flush=True)
    else:
        _print(file, read, found)
    return 0


def number_of(option: str, text: str, dimension: str) -> float:
    """The value of an option, above 0, in SI units."""
    try:
        value = bearable(text, dimension)
    except QuantityError as error:
        raise TorsadeError(f"{option} {error}") from None
    if value <= 0:
        raise TorsadeError(f"{option} is {quoted(text)}; give more than 0")
    return value


def report(file: str, read: Trials, rod: Rod, found: Analysis) -> dict[str, Any]:
    """Everything, in SI units; None where it is not known."""
    fits = found.fits
    return {
        "input": file,
        "ignored_columns": list(read.ignored),
        "rod": {
            "E_Pa": rod.E,
            "mu_Pa": rod.mu,
            "rho_kg_per_m3": rod.rho,
            "radius_m": rod.h,
            "length_m": rod.L,
        },
        "trials": [_each(b) for b in found.each],
        "stress_Pa": _mean(found.stress),
        "speeds": [
            {
                "speed_m_per_s": s.speed,
                "pieces": _mean(s.pieces),
                "binary": _share(s.binary),
                "fragment_m": _mean(s.fragment),
                "limit_curvature_per_m": _mean(s.kappa),
            }
            for s in found.speeds
        ],
        "sectors": [
            {
                "from_deg": math.degrees(s.low),
                "to_deg": math.degrees(s.high),
                "twist_rad": _mean(s.twist),
                "limit_curvature_per_m": _mean(s.kappa),
                "pieces": _mean(s.pieces),
            }
            for s in found.sectors
        ],
        "fits": {
            "fragment_m": _fit(fits.fragment),
            "breaks": _fit(fits.breaks),
            "breaks_saturation": _fit(fits.saturation),
            "not_fitted": fits.reasons,
        },
        "binary_threshold": {
            "twist_rad": found.threshold.twist,
            "limit_curvature_per_m": found.threshold.kappa,
            "li": found.threshold.li,
            "binary_above": _share(found.beyond),
            "binary_below": _share(found.before),
        },
    }


def _each(b: Broken) -> dict[str, Any]:
    trial = b.trial
    return {
        "where": trial.where,
        "twist_rad": trial.twist,
        "speed_m_per_s": trial.speed,
        "end_distance_m": trial.end_distance,
        "limit_curvature_per_m": b.kappa,
        "limit_curvature_low_per_m": b.kappa_low,
        "limit_curvature_high_per_m": b.kappa_high,
        "planar_curvature_of_twisted_rod": b.planar,
        "li": _finite(b.li),
        "stress_Pa": b.stress,
        "pieces": trial.pieces,
        "flakes": trial.flakes,
        "lengths_m": list(trial.lengths),
        "smallest_m": trial.smallest,
        "fragment_estimate_m": b.fragment,
    }


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _mean(m: Mean | None) -> dict[str, Any] | None:
    if m is None:
        return None
    return {
        "mean": m.value,
        "standard_deviation": _finite(m.deviation),
        "standard_error": _finite(m.error),
        "interval": None if m.n < 2 else [m.low, m.high],
        "n": m.n,
    }


def _share(s: Share | None) -> dict[str, Any] | None:
    return None if s is None else {"share": s.value, "interval": [s.low, s.high], "k": s.k, "n": s.n}


def _fit(fit: Fit | None) -> dict[str, Any] | None:
    if fit is None:
        return None
    numbers: dict[str, Any] = {
        name: {
            "value": p.value,
            "standard_error": _finite(p.error),
            "interval": [_finite(p.low), _finite(p.high)],
        }
        for name, p in fit.parameters.items()
    }
    return numbers | {"n": fit.n, "residual": fit.residual}


def _print(file: str, read: Trials, found: Analysis) -> None:
    from torsade.cli.table import print_grid, print_rows

    print_rows(_rows(file, read, found))
    if found.speeds:
        print("\nrods without twist, by speed")
        print_grid(
            ("mm/s", "trials", "pieces", "±", "in two", "lambda mm", "±", "kappa 1/m", "±"),
            [
                (
                    1e3 * s.speed,
                    s.pieces.n,
                    s.pieces.value,
                    s.pieces.error,
                    s.binary.k,
                    *_pair(s.fragment, 1e3),
                    *_pair(s.kappa),
                )
                for s in found.speeds
            ],
        )
    if found.sectors:
        print("\nsectors of the plane of twist and limit curvature; ± are standard deviations")
        print_grid(
            ("from deg", "to deg", "trials", "twist deg", "±", "kappa 1/m", "±", "pieces", "±"),
            [s.row for s in found.sectors],
        )


def _pair(m: Mean | None, scale: float = 1.0) -> tuple[float | None, float | None]:
    """A mean and its standard error."""
    return (None, None) if m is None else (scale * m.value, scale * m.error)


def _rows(file: str, read: Trials, found: Analysis) -> Iterator[tuple[str, str]]:
    flakes = sum(b.trial.flakes for b in found.each)
    left_out = f"; {counted(flakes, 'flake')} left out" if flakes else ""
    yield "trials", f"{len(found.each)} in {file}{left_out}"
    if read.ignored:
        yield "columns not read", ", ".join(read.ignored)
    pieces = [b.trial.pieces for b in found.each]
    counts = ", ".join(f"{pieces.count(n)} of {n}" for n in sorted(set(pieces)))
    yield "pieces", counts
    if found.stress is not None:
        yield "stress at breaking", _plus_minus(found.stress, 1e-6, "MPa")
    planar = sum(b.planar for b in found.each)
    if planar:
        yield (
            "curvature",
            f"of the planar shape in {counted(planar, 'twisted rod')} that no other was found for",
        )
    at = found.threshold
    yield "binary threshold", f"{math.degrees(at.twist):.0f} degrees at {at.kappa:.2f} 1/m, Li {at.li:.3f}"
    for name, part in (("above", found.beyond), ("below", found.before)):
        if part is not None:
            interval = f"95 % interval {100 * part.low:.0f} to {100 * part.high:.0f} %"
            yield f"in two, Li {name} it", f"{part.k} of {part.n}; {interval}"
    yield from _fit_rows(found)


def _fit_rows(found: Analysis) -> Iterator[tuple[str, str]]:
    fits = found.fits
    for name, fit, expected in (("lambda ~ v^p", fits.fragment, -0.25), ("breaks ~ v^p", fits.breaks, 0.25)):
        if fit is not None:
            p = fit.parameters["exponent"]
            agrees = "within" if p.low <= expected <= p.high else "outside"
            yield name, f"p = {p.value:.3f}, {p.low:.3f} to {p.high:.3f}; {expected:g} is {agrees}"
    if fits.saturation is not None:
        limit, B = (fits.saturation.parameters[k] for k in ("limit", "B_squared"))
        yield "breaks saturate", f"at {limit.value:.3g}, {limit.low:.3g} to {limit.high:.3g}"
        yield "B^2", f"{1e3 * B.value:.3g} mm/s, {1e3 * B.low:.3g} to {1e3 * B.high:.3g}"
    for reason in sorted(set(fits.reasons.values())) if found.speeds else []:
        yield "not fitted", reason


def _plus_minus(m: Mean, scale: float, unit: str) -> str:
    spread = "" if m.n < 2 else f" ± {scale * m.error:.2g} (standard error of {m.n})"
    return f"{scale * m.value:.4g}{spread} {unit}"
