"""Where the crossings, edges and faces of a diagram lie on paper, all about equally large.

The circle packing of `torsade.knots.packing` draws a diagram correctly, but what lies deep inside is small.
Its triangles are therefore evened out: each is to be an equilateral one of unit side, and the sum over
triangles of

    |J|² + |J⁻¹|²,    J the map from the unit triangle,

the symmetric Dirichlet energy (Smith and Schaefer 2015), is brought to a minimum. It grows without bound when
a triangle is about to turn over, so the drawing stays that of the diagram.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from torsade.knots.packing import Triangulation, packing_centres, triangulated
from torsade.topology.diagram import Diagram

__all__ = ["Layout", "laid_out"]

Complexes = NDArray[np.complex128]
Floats = NDArray[np.float64]

_BETWEEN = 2.0  # free room between pieces of a diagram
_STEPS = 300
_ENOUGH = 1e-6  # of the energy: what a step must gain for another to be taken
_DOUBLED_AREA = float(np.sqrt(0.75))  # of the unit triangle, times two


@dataclass(frozen=True)
class Layout:
    """A diagram on paper; points are complex, one unit is about the side of a triangle.

    Attributes:
        crossings: where each lies, shape (n_crossings,).
        ports: a point on the edge of each port, the nearer of two, indexed like `Diagram.mate`: ends last.
        ends: where strands end, in the order of `Diagram.ends`.
        faces: the middle of each face; nan where a closed piece has its outside.
        circles: centres of circles of radius one that cross nothing.
    """

    crossings: Complexes
    ports: Complexes
    ends: Complexes
    faces: Complexes
    circles: Complexes


def laid_out(diagram: Diagram) -> Layout:
    """Lay a diagram out, its pieces side by side.

    A tangle is turned so that strands A and B end on the left and on the right: where they are pulled, if
    they run towards their pulled ends (`Diagram.pulled`). One open strand runs from left to right.
    """
    m, n = len(diagram.ends), diagram.n_crossings
    crossings, ports, ends = np.zeros(n, complex), np.zeros(m + 4 * n, complex), np.zeros(m, complex)
    faces = np.full(len(diagram.faces), np.nan + 0j)
    right = 0.0
    for k in range(len(diagram.pieces)):
        darts = [p for edge in diagram.edges for p in edge if diagram.piece_at[p] == k]
        net = triangulated(diagram, darts)
        z = _evened(net)
        z *= _turn(diagram, {name[1]: z[v] for name, v in net.number.items() if name[0] == "end"})
        z += right - z.real.min() - 0.5j * (z.imag.min() + z.imag.max())
        right = float(z.real.max()) + _BETWEEN
        for (kind, p, _), v in net.number.items():
            if kind == "crossing":
                crossings[p] = z[v]
            elif kind == "port":
                ports[p] = z[v]
            elif kind == "end":
                ends[p] = z[v]
            elif kind == "face":
                faces[diagram.face_at[p]] = z[v]
    circles = np.array([right + 1 + (2 + _BETWEEN) * k for k in range(diagram.circles)], dtype=complex)
    return Layout(crossings, ports, ends, faces, circles)


def _turn(diagram: Diagram, ends: dict[int, complex]) -> complex:
    """The rotation that brings a piece into position, given its ends by port."""
    tips = []
    for k in range(diagram.n_strands):
        if diagram.is_open(k) and diagram.starts[k] in ends:
            last = [
                head
                for (_, head), owner in zip(diagram.edges, diagram.edge_strand, strict=True)
                if owner == k
            ]
            tips.append((ends[diagram.starts[k]], ends[last[-1]]))
    if not tips:
        return 1.0
    across = tips[0][1] - tips[0][0] if len(tips) == 1 else tips[1][1] - tips[0][1]
    return complex(np.conj(across) / abs(across))


def _evened(net: Triangulation) -> Complexes:
    """Where the vertices of a triangulation lie when all triangles are about equally large.

    Descends along the gradient smoothed by the Laplacian of the triangles, in which small ones weigh much.
    """
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import splu

    z = packing_centres(net)
    n = len(z)
    pairs = net.triangles.T.ravel(), np.roll(net.triangles, -1, axis=1).T.ravel()
    z /= np.sqrt(np.median(_doubled_areas(z, net)) / _DOUBLED_AREA)
    energy, slope = _energy(z, net)
    for _ in range(_STEPS):
        weight = np.tile(1 + (_DOUBLED_AREA / _doubled_areas(z, net)) ** 2, 3)
        sides = coo_array((weight, pairs), shape=(n, n))
        sides = sides + sides.T
        stiff = diags_array(sides.sum(axis=1) * (1 + 1e-6)) - sides
        smooth = splu(stiff.tocsc().astype(complex)).solve(slope)
        gain, step = float((slope.conj() @ smooth).real), 1.0
        while True:
            tried = z - step * smooth
            new, new_slope = _energy(tried, net)
            if new <= energy - 1e-4 * step * gain or step < 1e-9:
                break
            step /= 2
        done = energy - new < _ENOUGH * energy
        z, energy, slope = tried, new, new_slope
        if done:
            break
    return z


def _doubled_areas(z: Complexes, net: Triangulation) -> Floats:
    a, b, c = z[net.triangles].T
    return np.asarray(((b - a).conj() * (c - a)).imag)


def _energy(z: Complexes, net: Triangulation) -> tuple[float, Complexes]:
    """Symmetric Dirichlet energy of triangles, and its gradient as a vector in the plane at each vertex.

    With p and q two sides of a triangle and D = Im(p* q) twice its area, det J = D/D_0 where D_0 = √3/2,
    |J|² = S = (4/3)(|p|² + |q|² - Re(p* q)), and |J⁻¹|² = S/det².
    """
    a, b, c = z[net.triangles].T
    p, q = b - a, c - a
    D = (p.conj() * q).imag
    if D.min() <= 0:
        return np.inf, np.zeros_like(z)
    S = (4 / 3) * (abs(p) ** 2 + abs(q) ** 2 - (p.conj() * q).real)
    back = (_DOUBLED_AREA / D) ** 2
    by_S, by_D = 1 + back, -2 * S * back / D
    in_p = by_S * (4 / 3) * (2 * p - q) - 1j * by_D * q
    in_q = by_S * (4 / 3) * (2 * q - p) + 1j * by_D * p
    slope = np.zeros_like(z)
    for k, by in enumerate((-in_p - in_q, in_p, in_q)):
        np.add.at(slope, net.triangles[:, k], by)
    return float((S * (1 + back)).sum()), slope
