"""Fibers at any moment of a result: stored frames, and straight lines between them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, counted
from torsade.fracture.criteria import matching_strength

if TYPE_CHECKING:
    import xarray

__all__ = ["Break", "Moment", "Moments"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BEFORE = 0.15
"""How long before the first break a history of breaking begins, as a share of the time after it."""

MOST_READ = 200
"""Frames that are looked at for the extent of a motion."""


class Moment(NamedTuple):
    """Strands, or pieces of a rod from end 0 to end 1, at a time.

    Attributes
    ----------
    time : [s]
    strands : node positions (n, 3) [m] of each
    values : (n,) of each: log strain, or stress over strength
    """

    time: float
    strands: list[Floats]
    values: list[Floats]


class Break(NamedTuple):
    """When a rod broke [s], and how many edges from end 0."""

    time: float
    node: int


class Moments:
    """The history of a result, from its first frame that is wanted to the last.

    Parameters
    ----------
    dataset : of a protocol that goes on in time, with `position (time, node, space)` [m]
    frames : first and last stored frame, counted from 0, from the last one if negative; without it all, or of
        a rod that breaks those from just before its first break on

    Attributes
    ----------
    times : of the frames that are wanted [s], shape (n_frames,)
    breaks : in the order in which they happened
    breaking : whether this is a rod that breaks
    flat : whether it is to be seen along z: a rod bent in its device, or a move, of crossings seen along z
    radius : of the fibers [m]

    Raises
    ------
    TorsadeError
        When the result has no frames in time, or not those asked for.
    """

    def __init__(self, dataset: xarray.Dataset, frames: tuple[int, int] | None = None) -> None:
        self._dataset = dataset
        self.breaks = _breaks(dataset)
        self.breaking = "piece_start" in dataset
        self.flat = self.breaking or "crossings" in dataset
        time, first, last = _checked(dataset, frames)
        if frames is None and self.breaks:
            begin = self.breaks[0].time - BEFORE * (time[last] - self.breaks[0].time)
            first = min(max(int(np.searchsorted(time, begin)), 0), last - 1)
        self._first, self.times = first, time[first : last + 1]
        self.radius = float(dataset.attrs["radius"])
        self._strength = 1.0
        if self.breaking:
            spec = json.loads(dataset.attrs["spec"])
            self._strength = float(matching_strength(spec["sigma_c"], spec["criterion"]))
        self._frame = lru_cache(maxsize=2)(self._read)

    @property
    def closed(self) -> list[bool]:
        """Whether strands are closed; of pieces, none is."""
        return [] if self.breaking else [bool(c) for c in np.asarray(self._dataset["closed"])]

    @property
    def origin(self) -> float:
        """When the time that is shown begins [s]: at the first break of a rod, at 0 of anything else."""
        return self.breaks[0].time if self.breaks else 0.0

    @property
    def broken_at_first(self) -> bool:
        """Whether the rod is in pieces at the first frame that is wanted."""
        return self.breaking and len(self._frame(0)[2]) > 2

    def spread(self) -> Iterator[Moment]:
        """Stored frames, all of them or `MOST_READ` evenly among them."""
        n = len(self.times)
        for k in np.unique(np.linspace(0, n - 1, min(n, MOST_READ)).astype(int)):
            yield self.at(self.times[k])

    def at(self, time: float) -> Moment:
        """The strands at a time [s], straight between stored frames.

        A break within the interval of two frames opens from the first of them on.
        """
        k = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.times) - 2))
        s = float(np.clip((time - self.times[k]) / (self.times[k + 1] - self.times[k]), 0.0, 1.0))
        if s == 0.0:
            return self._split(time, *self._frame(k))
        (x, values, start), (y, after, bounds) = self._frame(k), self._frame(k + 1)
        rows = _same_rows(start, bounds)
        return self._split(time, (1.0 - s) * x[rows] + s * y, (1.0 - s) * values[rows] + s * after, bounds)

    def before_the_break(self) -> Moment:
        """A rod at the first frame that is wanted, as it was before it broke there."""
        x, values, start = self._frame(0)
        values = values.copy()
        cuts = start[1:-1]
        values[cuts - 1] = 0.5 * (values[cuts - 2] + values[cuts + 1])
        kept = np.delete(np.arange(len(x)), cuts)
        return self._split(float(self.times[0]), x[kept], values[kept], np.array([0, len(kept)]))

    def _split(self, time: float, x: Floats, values: Floats, start: Ints) -> Moment:
        bounds = list(pairwise(start))
        return Moment(time, [x[a:b] for a, b in bounds], [values[a:b] for a, b in bounds])

    def _read(self, k: int) -> tuple[Floats, Floats, Ints]:
        """Nodes (n, 3) [m], values (n,), and the bounds of strands or pieces, of a frame that is wanted."""
        data = self._dataset.isel(time=self._first + k)
        name = "stress" if self.breaking else "log_strain"
        start = np.unique(np.asarray(data["piece_start" if self.breaking else "node_start"], np.int64))
        x = np.asarray(data["position"], np.float64)[: start[-1]]
        values = np.zeros(len(x)) if name not in data else np.asarray(data[name], np.float64)[: start[-1]]
        return x, values / self._strength, start


def _checked(dataset: xarray.Dataset, frames: tuple[int, int] | None) -> tuple[Floats, int, int]:
    """Times of all frames [s], and the first and last one that are wanted."""
    what = dataset.attrs.get("protocol", "this result")
    needed = ("position", "piece_start") if "piece_start" in dataset else ("position", "node_start", "closed")
    missing = [name for name in needed if name not in dataset]
    if missing or "time" not in dataset["position"].dims or "radius" not in dataset.attrs:
        raise TorsadeError(
            f"{what} has no fibers that move in time, and a movie shows those; give a result of tighten, "
            "prison-escape, reidemeister, snap-twist or snap-quench"
        )
    time = np.asarray(dataset["time"], np.float64)
    n = len(time)
    if n < 2:
        raise TorsadeError(
            f"{what} has {counted(n, 'frame')}, and a movie needs 2; run it with more --frames"
        )
    first, last = (f + n if f < 0 else f for f in frames or (0, n - 1))
    if not 0 <= first < last < n:
        asked = "{}:{}".format(*frames or (0, n - 1))
        raise TorsadeError(
            f"the frames asked for are {asked}; give a first and a later last one from 0 to {n - 1}, such as "
            f"0:{n - 1}"
        )
    return time, first, last


def _breaks(dataset: xarray.Dataset) -> list[Break]:
    if not dataset.attrs.get("break_times_s"):
        return []
    spec = json.loads(dataset.attrs["spec"])
    times, places = (np.atleast_1d(dataset.attrs[f"break_{what}"]) for what in ("times_s", "places_m"))
    edge = float(spec["length"]) / int(spec["edges"])
    return [Break(float(t), round(float(x) / edge)) for t, x in zip(times, places, strict=True)]


def _same_rows(start: Ints, bounds: Ints) -> Ints:
    """For every row of nodes in later pieces, with bounds (p + 1,), that of the same node in earlier ones.

    Every break made one node two: the last of a piece, and the first of the next.
    """
    if len(start) == len(bounds):
        return np.arange(bounds[-1])
    piece = np.repeat(np.arange(len(bounds) - 1), np.diff(bounds))
    node = np.arange(bounds[-1]) - piece
    seams = start[1:-1] - np.arange(1, len(start) - 1)  # nodes of which there are two already
    ends = np.isin(np.arange(bounds[-1]), bounds[1:-1] - 1)
    before = np.searchsorted(seams, node, side="left")
    through = np.searchsorted(seams, node, side="right")
    return np.asarray(node + np.where(ends, before, through))
