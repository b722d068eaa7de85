"""Shapes for a run: centerlines read, resampled and checked, and no more of them than can be moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

from torsade.centerline import Centerline, check
from torsade.curve import length, resample
from torsade.errors import TorsadeError
from torsade.files import read_centerline
from torsade.variables import BYTES_PER_NODE

if TYPE_CHECKING:
    from torsade.protocols.knotted import Knotted

__all__ = ["check_built", "check_count", "check_frames", "open_strands"]

LARGEST_COUNT = 100_000
"""Most nodes of a run: a step then takes about a second."""

LARGEST_RESULT = 4_000_000_000
"""Most that positions, velocities, strains and torques of all frames may take in memory [bytes]."""


def open_strands(path: str, spec: Knotted, strands: int, wanted: str) -> Centerline:
    """Open strands from a file, checked as given, then resampled as the specification wants."""
    shape = read_centerline(path, spec.length_unit or "m")
    if len(shape.strands) != strands:
        other = {1: "tighten takes one", 2: "prison-escape takes two"}.get(len(shape.strands))
        advice = f"; {other}" if other else ""
        has = "1 strand" if len(shape.strands) == 1 else f"{len(shape.strands)} strands"
        raise TorsadeError(f"{path!r} has {has}, and {wanted}{advice or f'; give {strands}'}")
    check_count(sum(len(x) for x in shape.strands))
    for k, closed in enumerate(shape.closed):
        if closed:
            raise TorsadeError(f"strand {k} in {path!r} is closed and has no ends to pull; cut it open")
    if spec.smooth:
        return _smoothed(shape, spec.smooth, spec)
    check(shape, spec.h)
    if spec.node_spacing is None:
        return shape
    check_count(sum(length(x) for x in shape.strands) / spec.node_spacing)
    resampled = Centerline(tuple(resample(x, spacing=spec.node_spacing) for x in shape.strands))
    check(resampled, spec.h)
    return resampled


def _smoothed(shape: Centerline, scale: float, spec: Knotted) -> Centerline:
    """A measured shape without its noise, at the resolution of the run; never less smooth than asked for."""
    from torsade.knots.measured import clean

    smoother = clean(shape, scale, spec.node_spacing)
    if smoother.scale < scale:
        raise TorsadeError(
            f"smoothing over {1e3 * scale:.4g} mm may pull strands through each other; give smooth = "
            f'"{1e3 * smoother.scale:.4g} mm", which does not'
        )
    check(smoother, spec.h)
    return smoother


def check_count(nodes: float) -> None:
    """Refuse more nodes than a run can move."""
    if nodes > LARGEST_COUNT:
        raise TorsadeError(
            f"the fibers have {nodes:.0f} nodes, more than the {LARGEST_COUNT} that a run can move; give a "
            "larger spacing, or shorter fibers"
        )


def check_built(shape: Centerline, radius: float) -> Centerline:
    """A built-in knot, once it is certain that a fiber of this radius [m] can lie along it."""
    check_count(sum(len(x) for x in shape.strands))
    check(shape, radius)
    return shape


def check_frames(frames: int, nodes: int) -> None:
    """Refuse more frames than memory holds."""
    size = BYTES_PER_NODE * nodes
    if frames * size > LARGEST_RESULT:
        raise TorsadeError(
            f"{frames} frames of {nodes} nodes take {frames * size / 1e9:.1f} GB; give at most "
            f"{LARGEST_RESULT // size - 1} frames, or a larger spacing"
        )
