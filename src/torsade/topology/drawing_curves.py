"""From braid words to curves in space: the closure of a braid as closed polylines.

Distances are in units of that between neighbouring strands. They run clockwise around the z axis, the strand
at place 1 outermost, as `from_braid` draws them. In a crossing the two strands turn about each other by half
a turn, so that they keep their distance; crossings that do not touch each other stand side by side.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from torsade.curve import length, resample
from torsade.topology.codes.braid import from_braid

__all__ = ["braid_curves"]

FloatArray = NDArray[np.float64]

_STEPS = 24  # nodes to a crossing before resampling
_ADVANCE = 1.5  # length of a crossing along the innermost strand


def braid_curves(word: Iterable[int], n_strands: int | None = None, nodes: int = 200) -> list[FloatArray]:
    """The closure of a braid as closed polylines, one for each component, shapes (n, 3).

    Args:
        word: nonzero integers, as for `from_braid`.
        n_strands: of the braid; by default as many as the word needs.
        nodes: of all components together, shared by their lengths.

    Raises:
        TorsadeError: a word that `from_braid` refuses, or too few nodes.

    >>> from torsade.topology.identify import identify_curves
    >>> print(identify_curves(braid_curves([1, 1, 1])))
    3_1
    """
    letters = list(word)
    from_braid(letters, n_strands)  # refuses what is no braid
    width = max((abs(i) + 1 for i in letters), default=1) if n_strands is None else n_strands
    layers = _layers(letters, width)
    inner = max(_ADVANCE * len(layers) / (2 * np.pi), 1.0)
    at = list(range(width))  # the strand at each place
    place = np.empty((len(layers) * _STEPS + 1, width))
    height = np.zeros_like(place)
    half_turn = np.pi * np.arange(_STEPS) / _STEPS
    for row, layer in enumerate(layers):
        steps = slice(row * _STEPS, (row + 1) * _STEPS)
        for k, strand in enumerate(at):
            place[steps, strand] = k
        for i in layer:
            k = abs(i) - 1
            right, left = at[k], at[k + 1]
            place[steps, right] = k + (1 - np.cos(half_turn)) / 2
            place[steps, left] = k + (1 + np.cos(half_turn)) / 2
            height[steps, right] = np.sign(i) * np.sin(half_turn) / 2
            height[steps, left] = -height[steps, right]
            at[k], at[k + 1] = left, right
    angle = -2 * np.pi * np.arange(len(layers) * _STEPS) / (len(layers) * _STEPS)
    radius = inner + width - 1 - place[:-1]
    strands = np.stack(
        [radius * np.cos(angle)[:, None], radius * np.sin(angle)[:, None], height[:-1]], axis=-1
    )
    curves = [np.concatenate([strands[:, k] for k in cycle]) for cycle in _cycles(at)]
    lengths = [length(x, True) for x in curves]
    shares = [round(nodes * l / sum(lengths)) for l in lengths]
    return [resample(x, n=n, closed=True) for x, n in zip(curves, shares, strict=True)]


def _layers(letters: list[int], width: int) -> list[list[int]]:
    """Letters in layers, each as early as the letters before it allow; an empty one if there are none."""
    free = [0] * (width + 1)  # of each place, the first layer that has not used it
    layers: list[list[int]] = []
    for i in letters:
        k = abs(i)
        layer = max(free[k - 1], free[k])
        if layer == len(layers):
            layers.append([])
        layers[layer].append(i)
        free[k - 1] = free[k] = layer + 1
    return layers or [[]]


def _cycles(at: list[int]) -> list[list[int]]:
    """Strands as they follow one another: the one that ends at place k goes on as strand k."""
    following = {strand: place for place, strand in enumerate(at)}
    cycles: list[list[int]] = []
    while following:
        k = min(following)
        cycle = []
        while k in following:
            cycle.append(k)
            k = following.pop(k)
        cycles.append(cycle)
    return cycles
