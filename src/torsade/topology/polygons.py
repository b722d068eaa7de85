"""Curves as they are given to a measure: checked, one or several, open or closed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsade import curve
from torsade.arrays import Floats
from torsade.errors import TorsadeError

Curves = ArrayLike | Sequence[ArrayLike]
"""Nodes of one curve, shape (n, 3), or a sequence of such, one for every curve."""


class Polygons(NamedTuple):
    """Checked polygonal curves: nodes of each, shape (n, 3), and which of them are closed."""

    curves: tuple[Floats, ...]
    closed: tuple[bool, ...]

    def corners(self, k: int) -> Floats:
        """Nodes of curve k along all its edges, shape (n_edges + 1, 3): a closed one comes back to node 0."""
        x = self.curves[k]
        return np.concatenate([x, x[:1]]) if self.closed[k] else x


def polygons(curves: Curves, closed: bool | Sequence[bool]) -> Polygons:
    """Check curves; closed says of all of them, or of each, whether its last node joins its first.

    Raises:
        TorsadeError: no curve, a wrong number of closed, nodes of another shape than (n, 3), fewer than 2
            nodes (3 when closed), a coordinate that is not finite, or an edge without length.
    """
    several: Any = [curves] if _is_one(curves) else curves
    given: list[ArrayLike] = list(several)
    flags = (closed,) * len(given) if isinstance(closed, bool | np.bool_) else tuple(closed)
    if len(flags) != len(given):
        raise TorsadeError(
            f"{len(flags)} values of closed are given for {len(given)} curves; give one, or one for each"
        )
    checked = tuple(_checked(x, bool(c), k) for k, (x, c) in enumerate(zip(given, flags, strict=True)))
    return Polygons(checked, tuple(bool(c) for c in flags))


def polygon(x: ArrayLike, closed: bool) -> Floats:
    """Check the nodes of one curve; shape (n, 3).

    Raises:
        TorsadeError: as `polygons` does.
    """
    return _checked(x, closed, 0)


def _is_one(curves: Curves) -> bool:
    """Whether these are the nodes of one curve."""
    if not isinstance(curves, Sequence | np.ndarray) or len(curves) == 0:
        raise TorsadeError("there is no curve to measure; give nodes of shape (n, 3) or a list of such")
    node = curves[0]
    return all(np.isscalar(c) for c in node) if isinstance(node, Sequence) else np.ndim(node) == 1


def _checked(x: ArrayLike, closed: bool, k: int) -> Floats:
    try:
        x = np.array(x, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TorsadeError(f"curve {k} is not an array of numbers; give nodes of shape (n, 3)") from error
    l = curve.edge_lengths(x, closed)
    if not np.all(np.isfinite(x)):
        node = int(np.argmin(np.isfinite(x).all(axis=1)))
        raise TorsadeError(f"node {node} of curve {k} is {x[node]}; give finite coordinates")
    if not np.all(l > 0):
        edge = int(np.argmin(l > 0))
        again = "; a closed curve joins its last node to the first by itself" if edge == len(l) - 1 else ""
        raise TorsadeError(
            f"edge {edge} of curve {k} has no length; remove the repeated node at its end{again}"
        )
    return np.asarray(x)


def unit_direction(direction: ArrayLike) -> Floats:
    """A direction, shape (3,), made of length one.

    Raises:
        TorsadeError: another shape, zero or not finite.
    """
    n = np.array(direction, dtype=np.float64)
    size = float(np.linalg.norm(n)) if n.shape == (3,) else 0.0
    if not 0 < size < np.inf:
        raise TorsadeError(f"{n} is no direction; give three finite numbers that are not all zero")
    return np.asarray(n / size)
