"""What `torsade material` does: the material of a rod from a laboratory's measurements (3.11)."""

from __future__ import annotations

import json as json_format
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from torsade.cli.trials import number_of
from torsade.errors import TorsadeError
from torsade.files.measurements import Column, Row, read_table
from torsade.files.regular import Kind
from torsade.fracture.measured import (
    Measured,
    density,
    exactly,
    poisson_ratio,
    shear_modulus,
    twist_damping,
    young_modulus,
)
from torsade.fracture.pendulum import Swing, fit_swing

__all__ = ["material"]

SAMPLES = (Column("mass", "mass", "g", required=True), Column("length", "length", "mm", required=True))
TRACK = (
    Column("time", "time", "s", required=True),
    Column("angle", "angle", "deg", required=True),
    Column("length", "length", "mm", required=True, aliases=("rod_length",)),
    Column("sample", ""),
)
MOST_POINTS = 20_000
"""Most points of all tracks: their fit takes seconds."""

MASSES = Kind("samples", "masses.csv", "a table of samples", "split it", "one sample")
ANGLES = Kind("angles", "pendulum.csv", "a track", "take every few points", "one angle")


def material(
    radius: str,
    radius_error: str | None,
    buckling: str | None,
    weights: str | None,
    pendulum: str | None,
    inertia: str | None,
    inertia_error: str | None,
    mass_height: str | None,
    json: bool,
) -> int:
    """Read what there is, and say what follows."""
    if not any((buckling, weights, pendulum)):
        raise TorsadeError(
            "nothing was measured; give --buckling, --weights or --pendulum, each with a CSV file"
        )
    h = _measured("radius", radius, radius_error, "length")
    found: dict[str, Measured] = {}
    swings: dict[str, Swing] = {}
    if buckling is not None:
        found["E_Pa"] = young_modulus(*_samples(buckling), h)
    if weights is not None:
        found["rho_kg_per_m3"] = density(*_samples(weights), h)
    if pendulum is not None:
        if inertia is None:
            raise TorsadeError(
                '--pendulum comes without --inertia; give that of the mass, such as "2 kg mm^2"'
            )
        I_0 = _measured("inertia", inertia, inertia_error, "moment of inertia")
        height = None if mass_height is None else number_of("--mass-height", mass_height, "length")
        tracks = _tracks(pendulum)
        swings = {name: fit_swing(t, angle) for name, (t, angle, _) in tracks.items()}
        found |= _of_pendulums(swings, [length for *_, length in tracks.values()], I_0, h, height, found)
    if "E_Pa" in found and "mu_Pa" in found:
        # Both go as the inverse fourth power of one radius, whose error cancels.
        found["nu"] = poisson_ratio(*(_without_radius(found[name], h) for name in ("E_Pa", "mu_Pa")))
    if json:
        numbers = {name: _numbers(m) for name, m in found.items()}
        print(
            json_format.dumps(
                numbers | {"swings": {k: s._asdict() for k, s in swings.items()}}, allow_nan=False
            )
        )
        return 0
    from torsade.cli.table import print_rows

    print_rows(_rows(found, swings))
    return 0


def _measured(name: str, text: str, error: str | None, dimension: str) -> Measured:
    value = number_of(f"--{name}", text, dimension)
    spread = 0.0 if error is None else number_of(f"--{name}-error", error, dimension)
    if spread >= value:
        raise TorsadeError(f"--{name}-error is as large as --{name} itself; give a smaller one")
    return exactly(value, spread)


def _without_radius(m: Measured, h: Measured) -> Measured:
    """The same with the part of its error taken out that comes from the radius, as h^-4."""
    part = 4 * abs(m.value) * h.error / h.value
    return m._replace(error=math.sqrt(max(m.error**2 - part**2, 0.0)))


def _samples(path: str) -> tuple[list[float], list[float]]:
    """Masses and lengths of samples."""
    rows = read_table(Path(path), SAMPLES, MASSES).rows
    return [_above(row, "mass") for row in rows], [_above(row, "length") for row in rows]


def _above(row: Row, name: str) -> float:
    value = row.cells[name]
    if not isinstance(value, float) or value <= 0:
        raise TorsadeError(
            f"{row.where} has a {name} that is not above 0; give what was measured, or leave it out"
        )
    return value


def _tracks(path: str) -> dict[str, tuple[list[float], list[float], float]]:
    """Times, angles and length of the rod of each pendulum."""
    found: dict[str, tuple[list[float], list[float], float]] = {}
    rows = read_table(Path(path), TRACK, ANGLES).rows
    if len(rows) > MOST_POINTS:
        raise TorsadeError(
            f"{path!r} has {len(rows)} points; take every few of them, {MOST_POINTS} at most in all"
        )
    for row in rows:
        length = _above(row, "length")
        name = str(row.cells.get("sample") or "1")
        times, angles, first = found.setdefault(name, ([], [], length))
        if length != first:
            raise TorsadeError(
                f"{row.where} has another length than sample {name} before; name samples apart"
            )
        times.append(float(row.cells["time"]))  # type: ignore[arg-type]
        angles.append(float(row.cells["angle"]))  # type: ignore[arg-type]
    return found


def _of_pendulums(
    swings: dict[str, Swing],
    lengths: list[float],
    inertia: Measured,
    h: Measured,
    height: float | None,
    known: dict[str, Measured],
) -> dict[str, Measured]:
    omega, decay = [s.omega for s in swings.values()], [s.decay for s in swings.values()]
    found = {"mu_Pa": shear_modulus(omega, decay, lengths, inertia, h)}
    rho = known.get("rho_kg_per_m3")
    if rho is None or min(decay) <= 0:
        return found
    found["b_per_s"] = twist_damping(decay, lengths, inertia, h, rho)
    if height is not None:
        found["b_printed_per_s"] = twist_damping(decay, lengths, inertia, h, rho, height)
    return found


def _numbers(m: Measured) -> dict[str, Any]:
    return {
        "value": m.value,
        "error": m.error,
        "scatter": m.scatter if math.isfinite(m.scatter) else None,
        "samples": m.n,
    }


NAMES = {
    "E_Pa": ("Young's modulus E", 1e-9, "GPa"),
    "rho_kg_per_m3": ("density rho", 1.0, "kg/m^3"),
    "mu_Pa": ("shear modulus mu", 1e-9, "GPa"),
    "b_per_s": ("twist damping b", 1.0, "1/s"),
    "b_printed_per_s": ("b, as printed", 1.0, "1/s"),
    "nu": ("Poisson's ratio nu", 1.0, ""),
}


def _rows(found: dict[str, Measured], swings: dict[str, Swing]) -> Iterator[tuple[str, str]]:
    for name, m in found.items():
        label, scale, unit = NAMES[name]
        yield label, f"{scale * m.value:.4g} ± {scale * m.error:.2g} {unit}".rstrip()
    for name, s in swings.items():
        yield (
            f"pendulum {name}",
            f"omega {s.omega:.5g} ± {s.omega_error:.1g} 1/s, decay {s.decay:.4g} ± {s.decay_error:.1g} 1/s",
        )
