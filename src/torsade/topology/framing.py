"""Twist and self-linking of a framed curve: unit directors on the edges of a polygon."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from torsade import curve
from torsade.arrays import Floats
from torsade.errors import TorsadeError
from torsade.topology.measures import writhe
from torsade.topology.polygons import polygon

__all__ = ["self_linking", "twist"]

UNIT = 1e-6
"""How far a director may be from unit length, and from a right angle with its edge."""


def twist(x: ArrayLike, directors: ArrayLike, closed: bool) -> float:
    """Total twist Tw of a framed curve [turns], positive when right-handed.

    Tw = sum of m/(2 pi) over the hinges. The twist m of a hinge, in (-pi, pi], is the angle about the
    second tangent from the director of the first edge, carried over by the smallest rotation that
    takes tangent to tangent, to that of the second edge (Bergou et al. 2008).

    Args:
        x: nodes, shape (n, 3).
        directors: unit vectors perpendicular to their edges, shape (n_edges, 3).
        closed: whether the last node joins the first.

    Raises:
        TorsadeError: directors of another shape, not of unit length or not perpendicular; a curve that
            folds straight back, or that `polygons` refuses.
    """
    x = polygon(x, closed)
    frames = curve.rotation_minimising_frames(x, closed)
    d = _checked_directors(directors, frames.t)
    angle = np.arctan2(np.einsum("ec,ec->e", d, frames.v), np.einsum("ec,ec->e", d, frames.u))
    # Once round, the frame arrives ahead of where it set out by the holonomy.
    around = [angle[0] - frames.holonomy] if closed else []
    m = np.diff(np.concatenate([angle, around]))
    m = np.pi - (np.pi - m) % (2 * np.pi)
    return float(m.sum() / (2 * np.pi))


def self_linking(x: ArrayLike, directors: ArrayLike, threads: int | None = None) -> float:
    """Linking number of a closed curve with itself pushed a little along its directors: Lk = Wr + Tw.

    A whole number up to round-off (Călugăreanu 1959, White 1969, Fuller 1971). Arguments and errors are
    those of `twist` and of `torsade.topology.measures.writhe`.
    """
    return writhe(polygon(x, True), True, threads) + twist(x, directors, True)


def _checked_directors(directors: ArrayLike, t: Floats) -> Floats:
    d = np.asarray(directors, dtype=np.float64)
    if d.shape != t.shape:
        raise TorsadeError(f"directors have shape {d.shape}; give one for each edge, shape {t.shape}")
    length, along = np.linalg.norm(d, axis=1), np.einsum("ec,ec->e", d, t)
    good = (np.abs(length - 1) <= UNIT) & (np.abs(along) <= UNIT)
    if not np.all(good):
        e = int(np.argmin(good))
        raise TorsadeError(
            f"the director of edge {e} has length {length[e]:.6g} and {along[e]:.2g} of it along the edge; "
            "give unit vectors perpendicular to their edges"
        )
    return d
