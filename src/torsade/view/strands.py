"""What there is to be drawn of a frame: fibers, or the pieces that they have broken into."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError
from torsade.view.colours import DISTINCT, STRAND_COLOURS, strain_colour, strand_colour
from torsade.view.tube import Mesh, tube

if TYPE_CHECKING:
    import xarray

__all__ = ["Strand", "frame_index", "strands_at", "tubes_at"]

Floats = NDArray[np.float64]


class Strand(NamedTuple):
    """A fiber, or a piece of one, at one frame.

    Attributes
    ----------
    x : (n, 3) node positions [m]
    closed : whether the last node is joined to the first
    rows : which nodes of the dataset these are
    """

    x: Floats
    closed: bool
    rows: slice

    def of(self, values: NDArray[np.generic]) -> Floats:
        """What values (n_nodes, ...) of a whole frame are at its nodes, shape (n, ...)."""
        return np.asarray(values[self.rows], dtype=np.float64)


def strands_at(dataset: xarray.Dataset, frame: int) -> list[Strand]:
    """Fibers in their order, or pieces from end 0 of a rod to end 1, at a recorded frame.

    Parameters
    ----------
    dataset : of a result: `position (time, node, space)` [m] and `node_start (fiber_bound)`, `closed
        (fiber)`, or of a rod that breaks `piece_start (time, piece_bound)`; nodes of no piece are left out
    frame : from 0, or from -1 backwards

    Raises
    ------
    TorsadeError
        When there is no such frame, or nothing in it to be drawn.
    """
    broken = "piece_start" in dataset
    wanted = ("position",) if broken else ("position", "node_start", "closed")
    missing = [name for name in wanted if name not in dataset]
    if missing:
        raise TorsadeError(
            f"this result has no shape to be drawn: it lacks {', '.join(missing)}; give one of a protocol "
            "that records positions"
        )
    frame = frame_index(frame, dataset.sizes["time"])
    position = np.asarray(dataset["position"].isel(time=frame), dtype=np.float64)
    if broken:
        bounds = np.unique(np.asarray(dataset["piece_start"].isel(time=frame)))
        closed = np.zeros(max(len(bounds) - 1, 0), dtype=bool)
    else:
        bounds, closed = np.asarray(dataset["node_start"]), np.asarray(dataset["closed"], dtype=bool)
    if not _fit(bounds, closed, position):
        raise TorsadeError(
            f"frame {frame} of this result cannot be drawn: its fibers are not rows of finite positions; "
            "give one written by a protocol"
        )
    rows = [slice(int(a), int(b)) for a, b in pairwise(bounds)]
    return [Strand(position[r], bool(c), r) for r, c in zip(rows, closed, strict=True)]


def tubes_at(dataset: xarray.Dataset, frame: int, sides: int = 24) -> list[tuple[Mesh, Floats]]:
    """Surface of every strand of a frame, and sRGB colours (n, 3) of its vertices.

    Colours are those of strain where `log_strain` is recorded; else every strand has its own.
    """
    strain = np.asarray(dataset["log_strain"].isel(time=frame)) if "log_strain" in dataset else None
    radius, many = (
        float(dataset.attrs["radius"]),
        DISTINCT if "piece_start" in dataset else len(STRAND_COLOURS),
    )
    found = []
    for k, strand in enumerate(strands_at(dataset, frame)):
        mesh = tube(strand.x, radius, strand.closed, sides=sides, rounding=0.3)
        if strain is None:
            rgb = np.tile(strand_colour(k % many), (len(mesh.vertices), 1))
        else:
            rgb = strain_colour(mesh.at_vertices(strand.of(strain)))
        found.append((mesh, rgb))
    return found


def frame_index(frame: int, frames: int) -> int:
    """A frame counted from 0, where it may be counted from the end.

    Raises
    ------
    TorsadeError
        When there is none of that number.
    """
    if not -frames <= frame < frames:
        raise TorsadeError(f"frame {frame} was asked for; the result has {frames}, numbered from 0.")
    return frame % frames


def _fit(bounds: NDArray[np.generic], closed: NDArray[np.bool_], position: Floats) -> bool:
    """Whether these bounds part positions (n, 3) into strands of two nodes or more."""
    if bounds.ndim != 1 or len(bounds) != len(closed) + 1 or len(bounds) < 2 or not np.isfinite(bounds).all():
        return False
    inside = bounds[0] == 0 and bounds[-1] <= len(position) and bool(np.all(np.diff(bounds) >= 2))
    return inside and bool(np.isfinite(position[: int(bounds[-1])]).all())
