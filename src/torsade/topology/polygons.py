"""Curves as they are given to a measure: checked, one or several, open or closed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from torsade.arrays import Floats
from torsade.errors import TorsadeError

Curves = ArrayLike | Sequence[ArrayLike]
"""Nodes of one curve, shape (n, 3), or a sequence of such, one for every curve."""


class Polygons(NamedTuple):
    """Checked polygonal curves, in a unit of length in which no coordinate is greater than one.

    What is measured here does not depend on the unit; far from one, squares of lengths are no numbers.

    Attributes:
        curves: nodes of each, shape (n, 3), in units of 2^exponent: no digit is changed.
        closed: which of them are closed.
        exponent: of the unit.
    """

    curves: tuple[Floats, ...]
    closed: tuple[bool, ...]
    exponent: int

    def corners(self, k: int) -> Floats:
        """Nodes of curve k along all its edges, shape (n_edges + 1, 3): a closed one comes back to node 0."""
        x = self.curves[k]
        return np.concatenate([x, x[:1]]) if self.closed[k] else x


def polygons(
    curves: Curves, closed: bool | Sequence[bool], what: str = "curve", shortest: float = 0.0
) -> Polygons:
    """Check curves; closed says of all of them, or of each, whether its last node joins its first.

    Args:
        curves: nodes of one or of several.
        closed: for all, or for each.
        what: what they are called in messages.
        shortest: an edge of at most this fraction of its curve's extent counts as none.

    Raises:
        TorsadeError: no curve, a wrong number of closed, nodes of another shape than (n, 3), fewer than 2
            nodes (3 when closed), a coordinate that is not finite, or an edge without length.
    """
    several: Any = [curves] if _is_one(curves, what) else curves
    given: list[ArrayLike] = list(several)
    flags = (closed,) * len(given) if isinstance(closed, bool | np.bool_) else tuple(closed)
    if len(flags) != len(given):
        raise TorsadeError(f"{len(given)} {what}s have {len(flags)} closed flags; give one, or one for each")
    checked = [
        _checked(x, 3 if c else 2, f"{what} {k}") for k, (x, c) in enumerate(zip(given, flags, strict=True))
    ]
    # A power of two changes no digit, and keeps powers of lengths within the range of numbers.
    exponent = max(int(np.frexp(np.abs(x).max())[1]) for x in checked)
    found = Polygons(tuple(np.ldexp(x, -exponent) for x in checked), tuple(map(bool, flags)), exponent)
    for k, x in enumerate(found.curves):
        short = (
            np.linalg.norm(np.diff(found.corners(k), axis=0), axis=1) <= shortest * np.ptp(x, axis=0).max()
        )
        if short.any():
            i = int(np.argmax(short))
            again = "" if i + 1 < len(x) else "; a closed curve joins its last node to the first by itself"
            raise TorsadeError(
                f"nodes {i} and {(i + 1) % len(x)} of {what} {k} are the same point; remove one{again}"
            )
    return found


def polygon(x: ArrayLike, closed: bool) -> Floats:
    """Check the nodes of one curve; shape (n, 3), in units of a power of two.

    Raises:
        TorsadeError: as `polygons` does.
    """
    return polygons([x], closed).curves[0]


def _is_one(curves: Curves, what: str) -> bool:
    """Whether these are the nodes of one curve."""
    if not isinstance(curves, Sequence | np.ndarray) or len(curves) == 0:
        raise TorsadeError(f"there is no {what}; give at least one, nodes of shape (n, 3)")
    node = curves[0]
    return all(np.isscalar(c) for c in node) if isinstance(node, Sequence) else np.ndim(node) == 1


def _checked(x: ArrayLike, least: int, name: str) -> Floats:
    try:
        nodes = np.array(x, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TorsadeError(f"{name} is not an array of numbers; give nodes of shape (n, 3)") from error
    if nodes.ndim != 2 or nodes.shape[1] != 3:
        raise TorsadeError(f"{name} has nodes of shape {nodes.shape}; give (n, 3)")
    if len(nodes) < least:
        raise TorsadeError(f"{name} has {len(nodes)} nodes; give at least {least}")
    finite = np.isfinite(nodes).all(axis=1)
    if not finite.all():
        i = int(np.argmin(finite))
        raise TorsadeError(f"node {i} of {name} is {nodes[i].tolist()}; give finite coordinates")
    return nodes


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
