"""Fibers at any moment of a result: stored frames, and straight lines between them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.errors import TorsadeError, counted
from torsade.fracture.criteria import matching_strength
from torsade.view.battery import battery_note, top_density

if TYPE_CHECKING:
    import xarray

__all__ = ["Break", "Moment", "Moments", "colours_of"]

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
    values : (n,) of each: log strain, stress over strength, or energy density over the largest shown
    """

    time: float
    strands: list[Floats]
    values: list[Floats]


class Break(NamedTuple):
    """When a rod broke [s], and how many edges from end 0; 0 of a battery, which is cut where it begins."""

    time: float
    node: int


class Moments:
    """The history of a result, from its first frame that is wanted to the last.

    Parameters
    ----------
    dataset : of a protocol that goes on in time, with `position (time, node, space)` [m]
    frames : first and last stored frame, counted from 0, from the last one if negative; without it all, or of
        a rod that breaks those from just before its first break on
    colour : what values are, one of `colours_of`; by default the first

    Attributes
    ----------
    times : of the frames that are wanted [s], shape (n_frames,)
    breaks : in the order in which they happened
    battery : whether this is a battery that discharges
    breaking : whether this is a rod that breaks
    flat : whether it is to be seen along z: a rod bent in its device, or a move, of crossings seen along z
    radius : of the fibers [m]

    Raises
    ------
    TorsadeError
        When the result has no frames in time, or not those asked for.
    """

    def __init__(
        self, dataset: xarray.Dataset, frames: tuple[int, int] | None = None, colour: str | None = None
    ) -> None:
        self._dataset = dataset
        self.battery = "charge_position" in dataset
        self.breaks = [Break(0.0, 0)] if self.battery else _breaks(dataset)
        self.breaking = "piece_start" in dataset
        self.flat = self.breaking or "crossings" in dataset
        time, first, last = _checked(dataset, frames)
        if frames is None and self.breaks:
            begin = self.breaks[0].time - BEFORE * (time[last] - self.breaks[0].time)
            first = min(max(int(np.searchsorted(time, begin)), 0), last - 1)
        self._first, self.times = first, time[first : last + 1]
        self.radius = float(dataset.attrs["radius"])
        known = colours_of(dataset)
        self._name = COLOURED[colour or known[0]] if known else None
        self._largest = _largest(dataset, self._name)
        self._early = _early(dataset) if self.battery else math.inf
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
        """Whether the rod is in pieces at the first frame that is wanted, or a battery is cut there."""
        if self.battery:
            return bool(self.times[0] == 0.0)
        return self.breaking and len(self._frame(0)[2]) > 2

    def share(self, time: float) -> float:
        """Where a time [s] is, from 0 at the first frame that is wanted to 1 at the last.

        Evenly; of a battery, which discharges ever more slowly, evenly in log(1 + t/τ), with τ a quarter of
        the time in which half its energy goes.
        """
        first, last, now = (self._run(t) for t in (self.times[0], self.times[-1], time))
        return (now - first) / (last - first)

    def when(self, share: float) -> float:
        """The time [s] of a share: `share` the other way round."""
        first, last = self._run(self.times[0]), self._run(self.times[-1])
        now = first + share * (last - first)
        return now if math.isinf(self._early) else self._early * math.expm1(now)

    def _run(self, time: float) -> float:
        return float(time) if math.isinf(self._early) else math.log1p(time / self._early)

    def note(self, time: float) -> str:
        """What there is to say of a time [s]: how many pieces; of a battery, which knot, and what is left."""
        if self.breaking:
            return counted(len(self.at(time).strands), "piece")
        return battery_note(self._dataset, time) if self.battery else ""

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
        """A rod or battery at the first frame that is wanted, as it was before it broke there."""
        x, values, start = self._frame(0)
        if self.battery:
            return self._split(float(self.times[0]), x, values, start)
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
        name = self._name
        start = np.unique(np.asarray(data["piece_start" if self.breaking else "node_start"], np.int64))
        x = np.asarray(data["position"], np.float64)[: start[-1]]
        values = np.zeros(len(x)) if name is None else np.asarray(data[name], np.float64)[: start[-1]]
        return x, values / self._largest, start


COLOURED = {"strain": "log_strain", "stress": "stress", "energy": "energy_density"}
"""What colours can say, and the variable that holds it."""


def colours_of(dataset: xarray.Dataset) -> tuple[str, ...]:
    """What colours can say of a result beside which strand is which, the usual first."""
    if "piece_start" in dataset:
        return ("stress",)
    wanted = ("energy", "strain") if "charge_position" in dataset else ("strain",)
    return tuple(colour for colour in wanted if COLOURED[colour] in dataset)


def _largest(dataset: xarray.Dataset, name: str | None) -> float:
    """What values are divided by."""
    if name == "stress":
        spec = json.loads(dataset.attrs["spec"])
        return float(matching_strength(spec["sigma_c"], spec["criterion"]))
    return top_density(dataset) if name == "energy_density" else 1.0


def _early(dataset: xarray.Dataset) -> float:
    """τ of `Moments.share` [s]; where half the energy never goes, a hundredth of all time."""
    half = (dataset.attrs.get("discharge_time_T0") or {}).get("50")
    if half is not None:
        return 0.25 * float(half) * float(dataset.attrs["T0_s"])
    return 0.01 * float(np.asarray(dataset["time"], np.float64)[-1])


def _checked(dataset: xarray.Dataset, frames: tuple[int, int] | None) -> tuple[Floats, int, int]:
    """Times of all frames [s], and the first and last one that are wanted."""
    what = dataset.attrs.get("protocol", "this result")
    needed = ("position", "piece_start") if "piece_start" in dataset else ("position", "node_start", "closed")
    missing = [name for name in needed if name not in dataset]
    if missing or "time" not in dataset["position"].dims or "radius" not in dataset.attrs:
        raise TorsadeError(
            f"{what} has no fibers that move in time, and a movie shows those; give a result of tighten, "
            "prison-escape, reidemeister, battery, snap-twist or snap-quench"
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
