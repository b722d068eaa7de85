"""Strands gathered from a file, node by node, and what makes them a centerline."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from torsade.centerline import Centerline
from torsade.errors import TorsadeError, named
from torsade.files.regular import finite_number

__all__ = ["MOST_NODES", "MOST_STRANDS", "Gathered", "made", "rows"]

FloatArray = NDArray[np.float64]

MOST_NODES = 1_000_000
"""Most nodes of a file: ten times what a run can use."""

MOST_STRANDS = 10_000
"""Most strands of a file."""


class Gathered:
    """Strands while they are read: 24 bytes a node, and no more nodes than are bearable.

    Attributes:
        numbers: coordinates x, y, z, x, y, z ... of each strand.
    """

    def __init__(self, path: Path) -> None:
        self.name = named(path)
        self.numbers: list[array[float]] = []
        self._nodes = 0

    def begin(self) -> None:
        """The next node begins a strand."""
        if len(self.numbers) == MOST_STRANDS:
            raise TorsadeError(f"{self.name} has more than {MOST_STRANDS} strands; give fewer")
        self.numbers.append(array("d"))

    def add(self, cells: Sequence[str], where: str) -> None:
        """A node of the last strand, from the text of x, y and z."""
        if self._nodes == MOST_NODES:
            raise TorsadeError(f"{self.name} has more than {MOST_NODES} nodes; resample it to fewer")
        self._nodes += 1
        self.numbers[-1].extend(
            [finite_number(cell, axis, where) for axis, cell in zip("xyz", cells, strict=True)]
        )

    def centerline(self, closed: Sequence[bool] | None = None) -> Centerline:
        """All strands, in the unit of the file; as `made`."""
        return made(self.name, [np.array(x).reshape(-1, 3) for x in self.numbers], closed)


def made(
    name: str, strands: Iterable[FloatArray], closed: Sequence[bool] | None = None, told: bool = False
) -> Centerline:
    """A centerline of strands read from a file; one that ends with its first node is closed.

    Args:
        name: of the file, quoted, for messages.
        strands: nodes of each, shapes (n, 3).
        closed: which are closed whether or not they end with their first node.
        told: whether `closed` is all there is to say.

    Raises:
        TorsadeError: no strand, or one of too few nodes.
    """
    nodes, flags = [], []
    for k, x in enumerate(strands):
        if len(x) < 2:
            has = "only one node" if len(x) == 1 else "no node"
            raise TorsadeError(f"strand {k} in {name} has {has}; give at least 2")
        # Three distinct nodes make a loop; fewer that return are an error left to `check`.
        returns = len(x) > 3 and bool((x[0] == x[-1]).all())
        shut = (returns and not told) or (closed is not None and closed[k])
        if shut and len(x) < 3:
            raise TorsadeError(f"strand {k} in {name} is closed and has 2 nodes; give at least 3")
        nodes.append(x[:-1] if returns and shut else x)
        flags.append(shut)
    if not nodes:
        raise TorsadeError(f"{name} has no nodes; give at least one strand of 2 nodes")
    return Centerline(tuple(nodes), tuple(flags))


def rows(x: FloatArray, closed: bool = False) -> list[list[float]]:
    """Nodes as lists of floats, the first one repeated at the end of a closed strand."""
    again = x[:1].tolist() if closed else []
    return [*x.tolist(), *again]
