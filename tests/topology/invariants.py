"""Brute-force invariants of knots for the tests: written for clarity, independent of the package's own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from torsade.topology import Diagram

Matrix = list[list[int]]


def rank_mod(matrix: Sequence[Sequence[int]], p: int) -> int:
    """Rank of an integer matrix modulo a prime."""
    rows = [[x % p for x in row] for row in matrix]
    rank = 0
    for column in range(len(rows[0]) if rows else 0):
        pivot = next((r for r in range(rank, len(rows)) if rows[r][column]), None)
        if pivot is None:
            continue
        rows[rank], rows[pivot] = rows[pivot], rows[rank]
        inverse = pow(rows[rank][column], -1, p)
        for r in range(rank + 1, len(rows)):
            factor = rows[r][column] * inverse
            rows[r] = [(x - factor * y) % p for x, y in zip(rows[r], rows[rank], strict=True)]
        rank += 1
    return rank


def colourings(diagram: Diagram, p: int) -> int:
    """Fox colourings modulo p, as the dimension of their space: arcs with 2 over = left + right at crossings.

    For a tangle the ends are free.
    """
    arc = list(range(len(diagram.edges)))
    for _, head in diagram.edges:  # an upper passage goes on in the same colour
        if head >= 0 and head & 1:
            old, new = arc[diagram.edge_at[head ^ 2]], arc[diagram.edge_at[head]]
            arc = [new if a == old else a for a in arc]
    names = {a: k for k, a in enumerate(sorted(set(arc)))}
    rows = []
    for c in range(diagram.n_crossings):
        row = [0] * len(names)
        for port, weight in ((0, 1), (2, 1), (1, -2)):
            row[names[arc[diagram.edge_at[4 * c + port]]]] += weight
        rows.append(row)
    return len(names) + diagram.circles - rank_mod(rows, p)


def goeritz(diagram: Diagram) -> tuple[Matrix, int]:
    """Goeritz matrix, without its first row, and Gordon and Litherland's correction of a connected diagram.

    Gordon, Litherland, On the signature of a link, Invent. Math. 47 (1978): the signature of the link is
    that of the matrix less the correction.
    """
    colour, todo = {0: 0}, [0]
    for f in todo:
        for p in diagram.faces[f]:
            g = diagram.face_at[diagram.mate[p]]
            if g not in colour:
                colour[g] = 1 - colour[f]
                todo.append(g)
    place = {f: k for k, f in enumerate(f for f in range(len(diagram.faces)) if not colour[f])}
    matrix = [[0] * len(place) for _ in place]
    correction = 0
    for c, sign in enumerate(diagram.signs):
        corners = [diagram.face_at[4 * c + i] for i in range(4)]
        i = colour[corners[0]]  # the corner after port i is white
        a, b, eta = place[corners[i]], place[corners[i + 2]], 1 - 2 * i
        if a != b:
            for row, column, x in ((a, a, eta), (b, b, eta), (a, b, -eta), (b, a, -eta)):
                matrix[row][column] += x
        between_entries = 3 if sign > 0 else 0
        if between_entries % 2 != i:
            correction += eta
    return [row[1:] for row in matrix[1:]], correction


def determinant(diagram: Diagram) -> int:
    """Determinant of a knot or link with a connected diagram, exactly (Bareiss)."""
    m = [row[:] for row in goeritz(diagram)[0]] if diagram.n_crossings else []
    previous = 1
    for k in range(len(m) - 1):
        if not m[k][k]:
            pivot = next((i for i in range(k + 1, len(m)) if m[i][k]), None)
            if pivot is None:
                return 0
            m[k], m[pivot] = m[pivot], [-x for x in m[k]]
        for i in range(k + 1, len(m)):
            for j in range(k + 1, len(m)):
                m[i][j] = (m[i][j] * m[k][k] - m[i][k] * m[k][j]) // previous
        previous = m[k][k]
    return abs(m[-1][-1]) if m else 1


def signature(diagram: Diagram) -> int:
    """Signature; -2 for the right-handed trefoil."""
    if not diagram.n_crossings:
        return 0
    matrix, correction = goeritz(diagram)
    values = np.linalg.eigvalsh(np.array(matrix, dtype=float)) if matrix else np.zeros(0)
    return int((values > 1e-9).sum() - (values < -1e-9).sum()) - correction
