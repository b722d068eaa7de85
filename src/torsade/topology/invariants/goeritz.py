"""Signature and determinant from a Goeritz matrix.

Colour the faces of a connected diagram like a checkerboard. The faces of one colour, the white ones, are
the vertices of a graph whose edges are the crossings; with weights eta = +1 or -1 and one vertex removed,
its Laplacian G is a matrix of the Gordon-Litherland form of the surface that the black faces make. Then

    determinant = |det G|,    signature = sign G - sum of eta over crossings of type II,

type II being where the two strands run along the black band in the same direction (C. McA. Gordon,
R. A. Litherland, On the signature of a link, Invent. Math. 47 (1978) 53).
"""

from __future__ import annotations

from collections.abc import Sequence

from torsade.topology.invariants.code import Code, oriented

__all__ = ["checkerboard", "determinant", "goeritz_matrix", "inertia", "signature"]


def signature(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> int:
    """The signature of the link: of V + V^T for a Seifert matrix V, with the sign below.

    The right-handed trefoil has signature -2: positive knots are negative. That is the convention of
    KnotInfo, of KnotTheory, and of the catalogue. Split pieces add; mirror images have opposite signs.
    """
    code = oriented(pd, circles)
    total = 0
    for piece in code.pieces:
        matrix, correction = goeritz_matrix(code, piece)
        total += inertia(matrix)[0] - correction
    return total


def determinant(pd: Sequence[Sequence[int]] | Code, circles: int = 0) -> int:
    """|Delta(-1)|, the determinant of the link: 1 for the unknot, 0 for every split diagram."""
    code = oriented(pd, circles)
    n_pieces = len(code.pieces) + code.circles
    if n_pieces != 1:
        return 0
    return inertia(goeritz_matrix(code, code.pieces[0])[0])[1] if code.pieces else 1


def goeritz_matrix(code: Code, piece: Sequence[int]) -> tuple[list[list[int]], int]:
    """The Goeritz matrix G of a connected piece, and the sum of eta over its crossings of type II.

    White is the colour with fewer faces. Turned counterclockwise, the over strand sweeps corners 1 and 3;
    eta is +1 where these are black, -1 where they are white.
    """
    dark = checkerboard(code, piece)
    n_dark = sum(dark.values())
    white = [face for face, is_dark in dark.items() if is_dark == (2 * n_dark < len(dark))]
    index = {face: k for k, face in enumerate(white)}
    full = [[0] * len(white) for _ in white]
    correction = 0
    for c in piece:
        corners = code.corners[c]
        swept = corners[1] in index
        eta = -1 if swept else 1
        i, k = (index[corners[s]] for s in ((1, 3) if swept else (0, 2)))
        if i != k:
            full[i][i] += eta
            full[k][k] += eta
            full[i][k] -= eta
            full[k][i] -= eta
        if (code.signs[c] > 0) != swept:
            correction += eta
    return [row[1:] for row in full[1:]], correction


def checkerboard(code: Code, piece: Sequence[int]) -> dict[int, bool]:
    """The faces of a connected piece: is each of the colour of the first one?"""
    around: dict[int, list[int]] = {}
    for c in piece:
        for slot in range(4):
            left, right = code.corners[c][slot], code.corners[c][slot - 1]
            around.setdefault(left, []).append(right)
            around.setdefault(right, []).append(left)
    first = code.corners[piece[0]][0]
    dark = {first: True}
    todo = [first]
    while todo:
        face = todo.pop()
        for neighbour in around[face]:
            if neighbour not in dark:
                dark[neighbour] = not dark[face]
                todo.append(neighbour)
    return dark


def inertia(matrix: Sequence[Sequence[int]]) -> tuple[int, int]:
    """Signature and |determinant| of a symmetric integer matrix, exactly.

    Elimination without fractions (E. H. Bareiss, Math. Comp. 22 (1968) 565): the k-th pivot is the k-th
    leading minor D_k, and the signature is the sum of sign(D_k D_(k-1)). Where the diagonal is zero, one
    row and column are added to another, which changes neither number.
    """
    rows = [list(row) for row in matrix]
    previous, total = 1, 0
    while rows:
        n = len(rows)
        k = next((k for k in range(n) if rows[k][k]), None)
        if k is None:
            pair = next(((i, j) for i in range(n) for j in range(i) if rows[i][j]), None)
            if pair is None:
                return total, 0
            k, j = pair
            rows[k] = [a + b for a, b in zip(rows[k], rows[j], strict=True)]
            for row in rows:
                row[k] += row[j]
        pivot_row = rows.pop(k)
        pivot = pivot_row.pop(k)
        column = [row.pop(k) for row in rows]
        rows = [
            [(pivot * a - left * up) // previous for a, up in zip(row, pivot_row, strict=True)]
            for row, left in zip(rows, column, strict=True)
        ]
        total += 1 if pivot * previous > 0 else -1
        previous = pivot
    return total, abs(previous)
