"""Conway notation out: twists are gathered into tangles until one is left, or a basic polyhedron."""

from __future__ import annotations

import re
from collections.abc import Iterator

from torsade.errors import TorsadeError
from torsade.topology.canonical import canonical_form
from torsade.topology.codes._algebra import (
    ONE,
    Rational,
    Tangle,
    added,
    closed_text,
    negated,
    numerator,
    rotated,
    text,
)
from torsade.topology.codes.braid import from_braid
from torsade.topology.codes.conway import POLYHEDRA, numbers_are_apart
from torsade.topology.diagram import Diagram
from torsade.topology.moves import slide_triangle, triangles
from torsade.topology.planar import PlanarMap

__all__ = ["to_conway"]

DRAWINGS = 100
"""How many drawings, slid over triangles, are tried on the polyhedra."""


def to_conway(diagram: Diagram) -> str:
    """Conway notation of a closed, connected, prime diagram; directions of strands are not kept.

    The code is of the knot or link, not of the drawing: crossings that cancel within a tangle are left out,
    and tangles are turned over. Simplify first for the shortest.

    >>> from torsade.topology.named import named_diagram
    >>> [to_conway(named_diagram(name)) for name in ("m5_2", "8_5", "8_17")]
    ['3 2', '3;3;2', '.2.2']

    Raises:
        TorsadeError: a tangle, split pieces, a connected sum, or a polyhedron that `from_conway` cannot read.
    """
    if diagram.ends or not diagram.is_connected:
        raise TorsadeError(
            f"{diagram!r} has ends or split pieces; Conway notation is written of one connected closed "
            "diagram: close or split it first"
        )
    if not diagram.n_crossings:
        return "1"
    found = {canonical_form(diagram)}
    for drawing in (queue := [diagram]):
        code = _code(drawing)
        if code:
            return code
        for dart in triangles(drawing) if len(found) < DRAWINGS else ():
            slid = slide_triangle(drawing, dart)
            if canonical_form(slid) not in found:
                found.add(canonical_form(slid))
                queue.append(slid)
    raise TorsadeError(
        f"{diagram!r} was not found to lie on a basic polyhedron whose vertices are numbered here; give a PD "
        "or DT code instead"
    )


def _code(diagram: Diagram) -> str | None:
    """The notation of a drawing, or of its mirror image with a minus before it; None if there is none."""
    graph = _Graph(diagram)
    while graph.gather():
        pass
    if graph.closed is None:
        direct = _polyhedral(graph)
        return direct or _polyhedral(graph, "-")
    knot = numerator(graph.closed)
    if knot is None:
        raise _not_prime()
    return _readable(closed_text(knot))


def _readable(code: str) -> str:
    """With a space between numbers, since numbers of two digits are only read where there is one."""
    if numbers_are_apart(code):
        return code
    return re.sub(r"(\d\d+)", r"\1 0 0", code, count=1)


class _Graph:
    """Tangles joined at their corners SW, SE, NE, NW, counted 0 to 3.

    Attributes:
        tangles: by number.
        far: the (tangle, corner) that each is joined to.
        closed: once one tangle is left, the tangle of which the whole is the numerator.
    """

    def __init__(self, diagram: Diagram) -> None:
        # Corner k of the tangle 1 is port k + 3 of a crossing, as in `integer`.
        self.tangles: dict[int, Tangle] = dict.fromkeys(range(diagram.n_crossings), ONE)
        self.far = {
            (p >> 2, p + 1 & 3): (diagram.mate[p] >> 2, diagram.mate[p] + 1 & 3) for p in diagram.ports
        }
        self.closed: Tangle | None = None

    def gather(self) -> bool:
        """Put two tangles together, or untwist one; whether there was something to do.

        Twists are gathered first: in another order a rational tangle would be found as a sum.
        """
        sums: list[tuple[int, int, int, int]] = []
        for (v, k), (w, j) in self.far.items():
            if v == w and j == k + 1 & 3:
                self._untwist(v, k)
                return True
            if v != w and self.far[v, k + 1 & 3] == (w, j - 1 & 3):
                if self._is_twist(v, 1 - k) or self._is_twist(w, -j):
                    self._add(v, k, w, j)
                    return True
                sums.append((v, k, w, j))
        if sums:
            self._add(*sums[0])
        return bool(sums)

    def _is_twist(self, v: int, quarters: int) -> bool:
        """Whether a tangle, turned so, is an integer, and what it is added to is rational."""
        t = rotated(self.tangles[v], quarters)
        return isinstance(t, Rational) and t.q == 1

    def _turn(self, v: int, corner: int, to: int) -> None:
        """Name the corners of a tangle anew, so that one is where another was."""
        quarters = to - corner & 3
        self.tangles[v] = rotated(self.tangles[v], quarters)
        old = {(v, i): (v, i + quarters & 3) for i in range(4)}
        self.far = {old.get(a, a): old.get(b, b) for a, b in self.far.items()}

    def _add(self, v: int, k: int, w: int, j: int) -> None:
        """Tangle w becomes part of v, to whose corners k and k + 1 its corners j and j - 1 are joined."""
        self._turn(v, k, 1)
        self._turn(w, j, 0)
        total = added(self.tangles[v], self.tangles.pop(w))
        if total is None:
            raise _not_prime()
        self.tangles[v] = total
        for i in (1, 2):
            del self.far[v, i]
        new = {(w, 1): (v, 1), (w, 2): (v, 2)}
        self.far = {new.get(a, a): new.get(b, b) for a, b in self.far.items() if a not in ((w, 0), (w, 3))}

    def _untwist(self, v: int, k: int) -> None:
        """A tangle with corners k and k + 1 joined is a strand, knotted or not; if not, take it away."""
        self._turn(v, k, 2)
        if self.far[v, 0] == (v, 1):
            self.closed, self.far = self.tangles[v], {}
            return
        one, other = self.far[v, 0], self.far[v, 1]
        # NE and NW are joined: the other two lead through without a knot where the tangle is 1/n.
        t = self.tangles.pop(v)
        if not isinstance(t, Rational) or abs(t.p) != 1:
            raise _not_prime()
        self.far = {a: b for a, b in self.far.items() if a[0] != v}
        self.far[one], self.far[other] = other, one


def _not_prime() -> TorsadeError:
    return TorsadeError(
        "the diagram shows a connected sum, or a part that is split; Conway notation is written of prime "
        "diagrams: take its summands"
    )


def _polyhedral(graph: _Graph, sign: str = "") -> str | None:
    """The code on a basic polyhedron, or with sign "-" on its mirror image: the shortest of all."""
    found: list[str] = []
    for name, polyhedron in POLYHEDRA.items():
        base = from_braid(polyhedron.word)
        if base.n_crossings != len(graph.tangles):
            continue
        for laid in _ways(graph, base):
            seen = map(negated, laid) if sign else laid
            tangles = [negated(rotated(t, -1)) if v in polyhedron.turned else t for v, t in enumerate(seen)]
            if all(t == ONE for v, t in enumerate(tangles) if v not in polyhedron.order):
                found.append(_written(name, sign, [tangles[v] for v in polyhedron.order]))
    return min(found, key=lambda code: (len(code), code.count("-"), code), default=None)


def _ways(graph: _Graph, base: PlanarMap) -> Iterator[list[Tangle]]:
    """The tangles at the vertices of the base, for each way to lay the graph on it."""
    root = next(iter(graph.far))
    for p in base.ports:
        laid = {root: p}
        todo = [root]
        while todo:
            v, k = todo.pop()
            near = {(v, k + 1 & 3): base.ccw(laid[v, k]), graph.far[v, k]: base.mate[laid[v, k]]}
            todo += [a for a in near if a not in laid]
            if any(laid.get(a, q) != q for a, q in near.items()):
                break
            laid |= near
        else:
            at = {q >> 2: (v, k, q) for (v, k), q in laid.items()}
            if len(at) == base.n_crossings and len(set(laid.values())) == len(laid):
                # Corner k of a tangle takes the place of port k + 3.
                turned = (at[c] for c in range(base.n_crossings))
                yield [rotated(graph.tangles[v], q + 1 - k) for v, k, q in turned]


def _written(name: str, sign: str, tangles: list[Tangle]) -> str:
    """A code such as 8*2:.20, the ones left out."""
    parts = ["" if t == ONE else _vertex_text(t) for t in tangles]
    while parts and not parts[-1]:
        parts.pop()
    code = ".".join(parts).replace("..", ":")
    implied = {"6*": bool(parts) and parts[0] != "" and len(parts) > 1, "6**": code.startswith((".", ":"))}
    return code if implied.get(name) and not sign else sign + name + code


def _vertex_text(t: Tangle) -> str:
    """A tangle at a vertex, where a minus before it changes all of it."""
    minus = isinstance(t, Rational) and t.p < 0
    return _readable("-" + text(negated(t)) if minus else text(t))
