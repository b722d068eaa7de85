"""A drawing of a diagram by circle packing: round, and the same however crossings are numbered.

A closed piece of a diagram, or all that hangs on the circle of ends, is cut into triangles whose vertices are

- the crossings,
- two vertices on every edge, one for each of its ports,
- for every face a ring of vertices, one beside each vertex on its border, and one in its middle,
- for a tangle the ends, and two vertices on each arc of the circle between them.

Rings keep the triangulation simple where a face meets a crossing twice. What is outside has a ring only.
There is one packing of circles in the unit disc, up to its own motions, with a circle for every vertex,
circles of neighbours touching, and those of the boundary touching the unit circle (Koebe, Andreev, Thurston).
In the hyperbolic disc a circle of radius r sees the circles of radii a and b of a triangle under the angle

    tan²(alpha/2) = sinh a sinh b/(sinh r sinh(r + a + b)) = R(1 - A)(1 - B)/((1 - R)(1 - R A B)),    R =
    e^(-2r),

and angles around a vertex make a full turn. With u = log Y, Y = tanh(r/2), they are the gradient of a concave
function (Colin de Verdière 1991), of which Newton's method finds the top. Circles of the boundary have Y = 1.

Strands run through the points where circles touch. Within a circle they are chords, and circles do not
overlap: so chords cross at crossings only, and the drawing is the diagram.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.topology.diagram import Diagram

__all__ = ["Drawing", "Triangulation", "packed", "packing_centres", "packing_radii", "triangulated"]

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.intp]
ComplexArray = NDArray[np.complex128]

Vertex = tuple[str, int, int]

_NEWTON_STEPS = 100
_CENTRING_STEPS = 200


@dataclass(frozen=True)
class Triangulation:
    """Triangles of a disc.

    Attributes:
        number: of the vertices named ("crossing", c, 0), ("port", p, 0) and ("end", p, 0); there are others.
        triangles: three vertices each, counterclockwise, shape (n, 3).
        boundary: whether a vertex is on the boundary, shape (n_vertices,).
    """

    number: dict[Vertex, int]
    triangles: IndexArray
    boundary: NDArray[np.bool_]


@dataclass(frozen=True)
class Drawing:
    """One piece of a diagram drawn in the unit disc.

    Attributes:
        strands: numbers of its strands, in order.
        points: for each strand, where it runs; the first and the last point of an open one are on the unit
            circle. Complex numbers.
        heights: of those points: half the mean chord of a crossing above or below, or zero between crossings.
    """

    strands: tuple[int, ...]
    points: tuple[ComplexArray, ...]
    heights: tuple[FloatArray, ...]


def packed(diagram: Diagram, strands: Sequence[int]) -> Drawing:
    """Draw one piece of a diagram, all that its strands, given by number, are connected with.

    The drawing is centred: the conformal barycentre of its crossings is the centre of the disc.
    """
    darts = list(_darts(diagram, strands))
    if not darts:
        turn = np.exp(2j * np.pi * np.arange(12) / 12)
        return Drawing(tuple(strands), (0.5 * turn,), (np.zeros(12),))
    net = triangulated(diagram, darts)
    touch = _Touching(net, packing_radii(net))
    centre = touch.centred([net.number["crossing", p >> 2, 0] for p in darts if p >= 0])
    points = [np.array([centre(z) for z in _run(diagram, k, touch)]) for k in strands]
    heights = _heights(diagram, strands, points)
    return Drawing(tuple(strands), tuple(points), heights)


def _darts(diagram: Diagram, strands: Sequence[int]) -> Iterator[int]:
    """The darts of strands as one walks along them: an order that a mirror image has, too."""
    edges = diagram.edges
    for e, k in enumerate(diagram.edge_strand):
        if k in strands:
            yield from edges[e]


def triangulated(diagram: Diagram, darts: Sequence[int]) -> Triangulation:
    """The triangles of the faces beside darts, which are all those of a connected piece."""
    number: dict[Vertex, int] = {}
    triangles: list[tuple[int, int, int]] = []
    boundary: set[int] = set()

    def vertex(*name: str | int) -> int:
        return number.setdefault(name, len(number))  # type: ignore[arg-type]

    seen: set[int] = set()
    unbounded = _unbounded(diagram, darts)
    for dart in darts:
        f = diagram.face_at[dart]
        if f in seen:
            continue
        seen.add(f)
        corners = [vertex(*name) for name in _border(diagram, dart)]
        outside = f == unbounded
        ring = [vertex("ring", dart, i) for i in range(len(corners))]
        for i, j in zip(range(-1, len(corners) - 1), range(len(corners)), strict=True):
            triangles += [(corners[i], corners[j], ring[i]), (corners[j], ring[j], ring[i])]
            if not outside:
                triangles.append((ring[i], ring[j], vertex("face", dart, 0)))
        if outside:
            boundary.update(ring)
    boundary |= {k for name, k in number.items() if name[0] in ("end", "arc")}
    flags = np.zeros(len(number), dtype=bool)
    flags[sorted(boundary)] = True
    return Triangulation(number, np.array(triangles), flags)


def _unbounded(diagram: Diagram, darts: Sequence[int]) -> int:
    """The face outside of a closed piece: the one named, or the first of the longest; -1 for a tangle."""
    if min(darts) < 0:
        return -1
    named = [diagram.face_at[p] for p in diagram.outer if p in darts]
    faces = [diagram.face_at[p] for p in darts]
    return named[0] if named else max(faces, key=lambda f: len(diagram.faces[f]))


def _border(diagram: Diagram, dart: int) -> Iterator[Vertex]:
    """The vertices around the face on the left of a dart."""
    for p in diagram.cycle(dart, diagram.corner):
        q = diagram.mate[p]
        yield ("crossing", p >> 2, 0) if p >= 0 else ("end", p, 0)
        yield ("port", p, 0)
        yield ("port", q, 0)
        if q < 0:
            yield from (("end", q, 0), ("arc", q, 0), ("arc", q, 1))


def packing_radii(net: Triangulation) -> FloatArray:
    """Y = tanh(r/2) of every vertex of a packing in the hyperbolic disc; 1 on the boundary.

    Raises:
        TorsadeError: Newton's method does not converge.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    n = len(net.boundary)
    inner = np.flatnonzero(~net.boundary)
    place = np.full(n, -1)
    place[inner] = np.arange(len(inner))
    a, b, c = np.concatenate([np.roll(net.triangles, -k, axis=1) for k in range(3)]).T
    keep = ~net.boundary[a]
    a, b, c = a[keep], b[keep], c[keep]
    rows, columns = np.concatenate([a, a, a]), np.concatenate([a, b, c])
    free = ~net.boundary[columns]
    where = place[rows[free]], place[columns[free]]
    Y = np.where(net.boundary, 1.0, 0.25)
    for _ in range(_NEWTON_STEPS):
        alpha = _angle(Y[a], Y[b], Y[c])
        excess = np.bincount(a, alpha, n)[inner] - 2 * np.pi
        if np.abs(excess).max() < 1e-9:
            return Y
        with np.errstate(divide="ignore", invalid="ignore"):
            sinh, cosh = 2 * Y / (1 - Y * Y), (1 + Y * Y) / (1 - Y * Y)
            coth = 1 / np.tanh(2 * (np.arctanh(Y[a]) + np.arctanh(Y[b]) + np.arctanh(Y[c])))
            slopes = [-(cosh[a] + sinh[a] * coth), cosh[b] - sinh[b] * coth, cosh[c] - sinh[c] * coth]
            entries = np.concatenate([np.sin(alpha) / 2 * slope for slope in slopes])
        jacobian = coo_array((entries[free], where), shape=(len(inner), len(inner)))
        step = np.asarray(spsolve(jacobian.tocsc(), -excess))
        # A longer step could leave the region where the quadratic model holds.
        step *= min(1.0, 1.0 / np.abs(step).max())
        Y[inner] = np.minimum(Y[inner] * np.exp(step), 1 - 1e-12)
    raise TorsadeError("no drawing of the diagram was found; simplify it first")  # pragma: no cover


def packing_centres(net: Triangulation) -> ComplexArray:
    """Centres of the circles of the packing as Euclid sees them; joined, they make the triangles.

    The circle through the ends of a diameter that points away from the middle of the disc; on the boundary,
    the one that touches the unit circle and a neighbour where the packing says.
    """
    touch = _Touching(net, packing_radii(net))
    z = np.zeros(len(net.boundary), dtype=complex)
    for v, c in touch.centre.items():
        out = c / abs(c) if c else 1.0
        z[v] = (_from(c, touch.Y[v] * out) + _from(c, -touch.Y[v] * out)) / 2
        for w in touch.direction[v]:
            if net.boundary[w]:
                far, near = touch.far_point(v, w), touch.point(v, w)
                size = abs(near - far) ** 2 / (2 * (1 - (near * far.conjugate()).real))
                z[w] = far * (1 - size)
    return z


def _angle(Y: FloatArray, A: FloatArray, B: FloatArray) -> FloatArray:
    """Angle at the circle of Y in a triangle with those of A and B; 1 - R = 4Y/(1 + Y)^2 loses no digits."""
    with np.errstate(divide="ignore"):
        S = np.arctanh(Y) + np.arctanh(A) + np.arctanh(B)
    tan_squared = (1 - Y) ** 2 / Y * A * B * 4 / ((1 + A) * (1 + B)) ** 2 / -np.expm1(-4 * S)
    return np.asarray(2 * np.arctan(np.sqrt(tan_squared)))


class _Touching:
    """Where the circles of a packing lie, and where neighbours touch. Points are complex, in the unit disc.

    Circles of the interior are laid out from the first on, each as seen from one that touches it.
    """

    def __init__(self, net: Triangulation, Y: FloatArray) -> None:
        self.net, self.Y = net, Y
        self._next: list[dict[int, int]] = [{} for _ in Y]
        for a, b, c in net.triangles.tolist():
            for i, j, k in ((a, b, c), (b, c, a), (c, a, b)):
                self._next[i][j] = k
        self.centre: dict[int, complex] = {}
        self.direction: dict[int, dict[int, float]] = {}
        first = int(np.flatnonzero(~net.boundary)[0])
        self.centre[first] = 0j
        self._look_around(first, next(iter(self._next[first])), 0.0)
        queue = [first]
        for v in queue:  # grows as it is read
            for w, angle in self.direction[v].items():
                if w not in self.centre and not net.boundary[w]:
                    # tanh of the sum of half radii
                    z = (Y[v] + Y[w]) / (1 + Y[v] * Y[w]) * cmath.exp(1j * angle)
                    self.centre[w] = _from(self.centre[v], z)
                    self._look_around(w, v, cmath.phase(_to(self.centre[w], self.centre[v])))
                    queue.append(w)

    def _look_around(self, v: int, first: int, angle: float) -> None:
        """The directions in which v sees its neighbours, the first under the angle given."""
        seen = {first: angle}
        w = first
        while (other := self._next[v].get(w, first)) != first:
            angle += float(_angle(*(self.Y[i] for i in (v, w, other))))
            seen[other] = angle
            w = other
        self.direction[v] = seen

    def point(self, v: int, w: int) -> complex:
        """Where the circles of two neighbours touch; v is not on the boundary."""
        return _from(self.centre[v], self.Y[v] * cmath.exp(1j * self.direction[v][w]))

    def far_point(self, v: int, w: int) -> complex:
        """Where the circle of w, a neighbour of v on the boundary, touches the unit circle."""
        return _from(self.centre[v], cmath.exp(1j * self.direction[v][w]))

    def centred(self, vertices: Sequence[int]) -> _Motion:
        """The motion of the disc that takes the barycentre of some circles to its centre."""
        where = np.array([self.centre[v] for v in vertices])
        motion = _Motion()
        for _ in range(_CENTRING_STEPS):
            m = complex(where.mean()) if len(where) else 0j
            if abs(m) < 1e-13:
                break
            where = (where - m) / (1 - m.conjugate() * where)
            motion = motion.then(m)
        return motion


@dataclass(frozen=True)
class _Motion:
    """z → (z - m)/(1 - m* z) for one m after the other."""

    steps: tuple[complex, ...] = ()

    def then(self, m: complex) -> _Motion:
        return _Motion((*self.steps, m))

    def __call__(self, z: complex) -> complex:
        for m in self.steps:
            z = _to(m, z)
        return z


def _to(m: complex, z: complex) -> complex:
    """The motion of the disc that takes m to the centre."""
    return (z - m) / (1 - m.conjugate() * z)


def _from(m: complex, z: complex) -> complex:
    """The motion of the disc that takes the centre to m."""
    return (z + m) / (1 + m.conjugate() * z)


def _run(diagram: Diagram, strand: int, touch: _Touching) -> Iterator[complex]:
    """The points along a strand: where each edge leaves a crossing, its middle, where it comes to one."""
    number = touch.net.number
    for e, k in enumerate(diagram.edge_strand):
        if k != strand:
            continue
        tail, head = diagram.edges[e]
        out, into = number["port", tail, 0], number["port", head, 0]
        if tail < 0:
            end = number["end", tail, 0]
            yield from (touch.far_point(out, end), touch.point(out, end))
        else:
            yield touch.point(out, number["crossing", tail >> 2, 0])
        yield touch.point(out, into)
        if head < 0:
            end = number["end", head, 0]
            yield from (touch.point(into, end), touch.far_point(into, end))
        else:
            yield touch.point(into, number["crossing", head >> 2, 0])


def _heights(
    diagram: Diagram, strands: Sequence[int], points: Sequence[ComplexArray]
) -> tuple[FloatArray, ...]:
    """Heights of the points of `_run`: the chords of a crossing lie half their mean length off the plane."""
    chord: dict[int, list[float]] = {}
    ports: list[list[int | None]] = []
    for k, z in zip(strands, points, strict=True):
        along: list[int | None] = []
        for e, owner in enumerate(diagram.edge_strand):
            if owner == k:
                tail, head = diagram.edges[e]
                along += [None, None, None] if tail < 0 else [tail, None]
                along += [None, None] if head < 0 else [head]
        ports.append(along)
        for i, p in enumerate(along):
            j = (i + 1) % len(along)
            if p is not None and along[j] == p ^ 2:
                chord.setdefault(p >> 2, []).append(abs(z[j] - z[i]))
    size = {c: sum(sorted(both)) / 4 for c, both in chord.items()}
    return tuple(
        np.array([0.0 if p is None else size[p >> 2] * (1.0 if p & 1 else -1.0) for p in along])
        for along in ports
    )
