"""Gauss codes of centerlines, by a projection of their own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def crossings(strands: tuple[NDArray[np.float64], ...]) -> list[tuple[float, float, int]]:
    """Crossings of the projection along z: (place on the upper strand, place on the lower one, sign).

    A place counts edges, and fractions of one, along strand A and then on along strand B. Solves every
    pair of edges for its intersection in the plane; no search, no tolerance.
    """
    start = np.concatenate([s[:-1] for s in strands])
    edge = np.concatenate([np.diff(s, axis=0) for s in strands])
    i, j = np.triu_indices(len(start), k=1)
    d = start[j] - start[i]
    det = edge[i, 0] * edge[j, 1] - edge[i, 1] * edge[j, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (d[:, 0] * edge[j, 1] - d[:, 1] * edge[j, 0]) / det
        w = (d[:, 0] * edge[i, 1] - d[:, 1] * edge[i, 0]) / det
    # Half-open, so that a crossing at a node counts once; edges that share a node do not cross.
    hit = (u >= 0) & (u < 1) & (w >= 0) & (w < 1) & ((j - i > 1) | (i == len(strands[0]) - 2))
    found = []
    for a, b, s, t in zip(i[hit], j[hit], u[hit], w[hit], strict=True):
        above = start[a, 2] + s * edge[a, 2] > start[b, 2] + t * edge[b, 2]
        (o, p), (l, q) = ((a, s), (b, t)) if above else ((b, t), (a, s))
        # Right-handed: the lower strand passes from right to left under the upper one.
        sign = int(np.sign(edge[o, 0] * edge[l, 1] - edge[o, 1] * edge[l, 0]))
        found.append((float(o + p), float(l + q), sign))
    return found


def gauss_code(strands: tuple[NDArray[np.float64], ...]) -> str:
    """The oriented Gauss code of the projection along z, crossings numbered as first met along A."""
    visits = []
    for k, (over, under, sign) in enumerate(crossings(strands)):
        visits += [(over, "O", k, sign), (under, "U", k, sign)]
    visits.sort()
    number: dict[int, int] = {}
    words: tuple[list[str], list[str]] = ([], [])
    for place, level, k, sign in visits:
        word = f"{level}{number.setdefault(k, len(number) + 1)}{'+' if sign > 0 else '-'}"
        words[place >= len(strands[0]) - 1].append(word)
    return f"{' '.join(words[0])} | {' '.join(words[1])}"
