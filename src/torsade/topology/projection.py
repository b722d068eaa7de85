"""From curves to diagrams: `project` looks at polylines along a direction and writes down what crosses.

Seen from the tip of the direction, so that the upper strand is the one nearer to the eye. Views in
which a node lies on an edge, edges overlap or three strands meet in a point tell nothing; another
direction is taken then, from a fixed list, and the result says so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsade.errors import TorsadeError
from torsade.topology._crossings import TOLERANCE, Degenerate, Polylines, View, cross_over, polylines
from torsade.topology._leads import lead_out
from torsade.topology.diagram import CIRCLE, Diagram

__all__ = ["Projection", "clearest", "project", "spiral"]

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]

_GOLDEN = math.pi * (3 - math.sqrt(5))
_TRIES = 200


@dataclass(frozen=True)
class Projection:
    """A diagram and where its crossings lie on the curves.

    Arrays have a row for each crossing of the diagram that the curves have, in its order, and a column
    for the upper and one for the lower strand.

    Attributes:
        diagram: strand k is polyline k, and runs as it does.
        direction: unit vector from the curves to the eye, shape (3,).
        refused: why other directions were not taken, in the order in which they were tried.
        strand: which polyline, shape (n, 2).
        edge: edge i runs from node i to the next, shape (n, 2).
        parameter: where on the edge, between 0 and 1, shape (n, 2).
        height: along the direction [m], shape (n, 2).
        n_led_out: crossings at the end of the diagram's list that the curves do not have: made by
            leading out ends that lie in the midst of the drawing.
    """

    diagram: Diagram
    direction: FloatArray
    refused: tuple[str, ...]
    strand: IndexArray
    edge: IndexArray
    parameter: FloatArray
    height: FloatArray
    n_led_out: int


def project(
    strands: Sequence[ArrayLike],
    closed: bool | Sequence[bool] = False,
    direction: ArrayLike | None = None,
) -> Projection:
    """The diagram of polylines seen along a direction.

    Ends of open strands are put on a circle around the drawing, in the order in which they lie on its
    outer face. What lies there in separate pieces follows in the order of the angles at which the first
    end of each piece is seen from the middle. An end in the midst of the drawing is led out above
    everything, over as few edges as possible. Of a closed curve that crosses nothing a circle is kept, not
    the way it runs.

    Args:
        strands: nodes [m] of each polyline, shapes (n, 3).
        closed: which of them are closed, all or one by one; the first node is not repeated.
        direction: towards the eye; along z if none is given. The nearest of a fixed sequence of
            directions is taken that shows every crossing clearly.

    Raises:
        TorsadeError: nodes that are not finite or of the wrong shape, too few of them, repeated nodes, or
            edges that meet in space.

    >>> import numpy as np
    >>> t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    >>> x = np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), np.sin(3 * t)], axis=1)
    >>> project([x], closed=True).diagram.signs
    (1, 1, 1)
    """
    lines = polylines(strands, closed)
    refused: list[str] = []
    for d in _directions(direction):
        try:
            view = cross_over(lines, np.stack([*across(d), d]))
        except Degenerate as reason:
            refused.append(str(reason))
            continue
        diagram, n_led_out = _drawn(lines, view)
        height = np.ldexp(view.height, lines.exponent)
        return Projection(
            diagram, d, tuple(refused), view.strand, view.edge, view.parameter, height, n_led_out
        )
    raise TorsadeError(
        f"{_TRIES} directions show no clear drawing, the last because {refused[-1]}; nodes may repeat or "
        f"edges lie on each other to within {TOLERANCE:g} of their length: move them apart"
    )


def clearest(
    strands: Sequence[ArrayLike], closed: bool | Sequence[bool] = False, directions: int = 200
) -> Projection:
    """The view with fewest crossings, among directions evenly spread over the sphere, z the first.

    Crossings made to lead out ends count too. Of several such views the first is taken.

    Args:
        strands, closed: as in `project`.
        directions: how many.
    """
    views = (project(strands, closed, d) for d in [np.array([0.0, 0.0, 1.0]), *spiral(directions)])
    return min(views, key=lambda seen: seen.diagram.n_crossings)


def spiral(n: int) -> FloatArray:
    """n unit vectors, shape (n, 3), evenly spread over the sphere on a spiral about z."""
    k = np.arange(n)
    z = 1 - (2 * k + 1) / n
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(k * _GOLDEN), r * np.sin(k * _GOLDEN), z], axis=1)


def _directions(direction: ArrayLike | None) -> Iterator[FloatArray]:
    """Unit vectors: the one asked for, and then others, each somewhat farther from it."""
    d = np.array([0.0, 0.0, 1.0]) if direction is None else np.asarray(direction, dtype=np.float64)
    size = np.linalg.norm(d) if d.shape == (3,) else 0.0
    if not 0 < size < math.inf:
        raise TorsadeError(f"the direction of view is {direction!r}; give three finite numbers, not all zero")
    d = d / size
    yield d
    u, v = across(d)
    for k in range(1, _TRIES):
        tilt, turn = 1e-3 * math.pi / 2 * 1000 ** (k / _TRIES), k * _GOLDEN
        yield math.cos(tilt) * d + math.sin(tilt) * (math.cos(turn) * u + math.sin(turn) * v)


def across(d: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit vectors u, v across d, such that u, v, d is right-handed; x and y where d is z."""
    axis = np.array([0.0, 1.0, 0.0]) if abs(d[1]) < 0.9 else np.array([0.0, 0.0, -1.0])
    u = np.cross(axis, d)
    u /= np.linalg.norm(u)
    return u, np.cross(d, u)


def _drawn(lines: Polylines, view: View) -> tuple[Diagram, int]:
    """The diagram of a view, and how many crossings were made to lead out ends."""
    n, m = len(view.strand), 2 * lines.closed.count(False)
    # Row 4c + 3 or 4c + 1 enters above, 4c below; along each strand in the order in which they come.
    above = 4 * np.arange(n) + np.where(view.sign > 0, 3, 1)
    entry = np.stack([above, 4 * np.arange(n)], axis=1).ravel()
    along = (view.edge + view.parameter).ravel()
    strand = view.strand.ravel()
    order = np.lexsort((along, strand))
    at_strand = np.searchsorted(strand[order], np.arange(len(lines.closed) + 1)).tolist()
    entries: list[int] = entry[order].tolist()
    mate = [0] * (4 * n + m)
    starts, ends = [], -m
    for k, is_closed in enumerate(lines.closed):
        heads = entries[at_strand[k] : at_strand[k + 1]]
        tails = [q ^ 2 for q in heads]
        if is_closed:
            tails = tails[-1:] + tails[:-1]
        else:
            tails.insert(0, ends)
            heads.append(ends + 1)
            ends += 2
        for p, q in zip(tails, heads, strict=True):
            mate[p], mate[q] = q, p
        starts.append(tails[0] if tails else CIRCLE)
    outer = _outer_darts(lines, view, mate, starts, (order, entries, at_strand))
    if not m:
        return Diagram.assemble(mate, starts, outer=outer), 0
    tips = [view.nodes[k][i] for k, is_closed in enumerate(lines.closed) if not is_closed for i in (0, -1)]
    return lead_out(mate, starts, outer, tips)


def _outer_darts(
    lines: Polylines,
    view: View,
    mate: list[int],
    starts: list[int],
    passages: tuple[IndexArray, list[int], list[int]],
) -> list[int]:
    """For each strand that crosses something a dart that has on its left what lies left of its leftmost node.

    The strand that reaches farthest left in its piece comes first, and it is the one that counts.
    """
    order, entries, at_strand = passages
    along = (view.edge + view.parameter).ravel()[order]
    found: list[tuple[float, int]] = []
    for k, x in enumerate(view.nodes):
        low, high = at_strand[k], at_strand[k + 1]
        if low == high:
            continue
        i = int(np.lexsort((x[:, 1], x[:, 0]))[0])
        before = low + int(np.searchsorted(along[low:high], i))  # passages before the leftmost node
        if before > low:
            tail = entries[before - 1] ^ 2
        else:
            tail = entries[high - 1] ^ 2 if lines.closed[k] else starts[k]
        turn = 1.0  # at an end either side will do: a face goes around it
        if lines.closed[k] or 0 < i < len(x) - 1:
            (ax, ay), (bx, by) = x[i] - x[i - 1], x[(i + 1) % len(x)] - x[i]
            turn = ax * by - ay * bx
        found.append((float(x[i, 0]), mate[tail] if turn > 0 else tail))
    return [dart for _, dart in sorted(found)]
