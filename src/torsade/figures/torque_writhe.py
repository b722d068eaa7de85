"""Self-torque of a pulled bend beside the writhe of its centerline (thesis 4.4).

Strands are oriented towards their gripped ends. If a bend reptates, v = s t + V + Omega × x, two points in
contact differ in velocity by s (t' - t), and the torque density of the law of the run,
eta_f J ∫ (r × dv).t/R^5 ds', is that of the writhe, ∫ t.(r × t')/R^3 ds'/4 pi, but for 1/R^2 and for what is
not in contact. With R = 2h everywhere it would be

    torque = pi (s/h^2) eta_f J Wr_3.

`Balance` holds both sides, and what the approximations leave out.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from torsade import reptation
from torsade.arrays import Floats, Ints
from torsade.observables import SETTLED
from torsade.results import Result
from torsade.topology import state
from torsade.topology.measures import writhe_density

__all__ = ["UNTIL", "Balance", "Coefficients", "Moment", "balance", "coefficients", "moment", "window"]

UNTIL = 0.6
"""End of the time [s] over which torques are averaged; it begins when a bend counts as tight, at 0.3 s."""

STEPS = 16
"""Frames looked at, at most, in a window."""


class Coefficients(NamedTuple):
    """What the torque is measured in: eta_f J [N m^2 s] and the radius h [m].

    Node-pair drag has no such viscosity: at contact, with R = 2h and edges of mean rest length l, it weighs
    as continuum drag of eta_f = eta 2h/l does.
    """

    eta_f_J: float
    h: float


@dataclass(frozen=True)
class Moment:
    """A pulled bend in one frame, its strands oriented towards their gripped ends.

    Attributes
    ----------
    strands, velocities : (n, 3) of each strand [m], [m/s]; they run towards the gripped end
    torque : (n_edges,) self-torque density of each strand [N]
    writhe : (n_edges,) writhe density of each strand [1/m]: times present lengths it sums up to Wr_3
    touching : (n_edges,) the part of it that comes from what is in contact [1/m]
    rest : (n_edges,) rest lengths of each strand [m]
    fit : the reptation fitted, None where the strands do not touch
    """

    strands: list[Floats]
    velocities: list[Floats]
    torque: list[Floats]
    writhe: list[Floats]
    touching: list[Floats]
    rest: list[Floats]
    fit: reptation.Reptation | None

    @property
    def total_torque(self) -> float:
        """[N m]."""
        return float(sum(t @ l for t, l in zip(self.torque, self.rest, strict=True)))

    @property
    def total_writhe(self) -> float:
        """Wr_3 of both strands together."""
        return _along(self.strands, self.writhe)

    @property
    def touching_writhe(self) -> float:
        """The part of Wr_3 that comes from what is in contact."""
        return _along(self.strands, self.touching)

    @property
    def correlation(self) -> float:
        """Of the densities along the body of the knot, edges weighted by their lengths."""
        if self.fit is None:
            return np.nan
        pairs = []
        for torque, writhe, rest in zip(self.torque, self.writhe, self.rest, strict=True):
            found = np.flatnonzero(torque)
            body = slice(found[0], found[-1] + 1)
            pairs.append((torque[body], writhe[body], rest[body]))
        x, y, w = (np.concatenate(column) for column in zip(*pairs, strict=True))
        w = w / w.sum()
        x, y = x - w @ x, y - w @ y
        return float((w * x) @ y / np.sqrt((w * x) @ x * ((w * y) @ y)))


def _along(strands: list[Floats], density: list[Floats]) -> float:
    lengths = (np.linalg.norm(np.diff(x, axis=0), axis=1) for x in strands)
    return float(sum(d @ l for d, l in zip(density, lengths, strict=True)))


def coefficients(result: Result) -> Coefficients:
    """eta_f J and h of a run."""
    meaning = json.loads(result.dataset.attrs["model"])
    h, laws = float(meaning["radius"]), meaning["laws"]
    ratio = float(laws["eta_f_ratio"])
    if laws["drag"] == "node-pair":
        ratio *= 2 * h / float(np.mean(np.concatenate(_rest_lengths(result))))
    return Coefficients(ratio * float(meaning["material"]["eta"]) * 0.5 * np.pi * h**4, h)


def orientation(result: Result) -> list[int]:
    """For each strand +1 if its last node is gripped, -1 if its first node is."""
    pulled = result.dataset.attrs["pulled"]
    ends = {pulled[0]: pulled[1], pulled[2]: pulled[3]}
    return [1 if ends[letter] == "1" else -1 for letter in "AB"]


def window(result: Result, start: float = SETTLED, until: float = UNTIL) -> Ints:
    """Frames from start to until [s], or to slipping if that comes first; the frame after that at least."""
    time = result.dataset["time"].values
    end = until if result.slipped_at is None else min(until, result.slipped_at)
    frames = np.flatnonzero((time >= start * (1 - 1e-9)) & (time <= end * (1 + 1e-9)))
    if len(frames) == 0:
        frames = np.array([result.last_held])
    chosen = np.unique(np.linspace(0, len(frames) - 1, min(STEPS, len(frames))).astype(int))
    return np.asarray(frames[chosen])


def moment(result: Result, frame: int) -> Moment:
    """All of one frame."""
    data, signs = result.dataset, orientation(result)
    nodes = data["node_start"].values
    cut = nodes[1:-1]
    edges = cut - np.arange(1, len(cut) + 1)
    now = data.isel(time=frame)
    strands = _oriented(np.split(now["position"].values.astype(float), cut), signs)
    velocities = _oriented(np.split(now["velocity"].values.astype(float), cut), signs)
    # A torque about a tangent that is turned round changes its sign.
    parts = np.split(now["self_torque"].values.astype(float), edges)
    torque = [sign * part for part, sign in zip(_oriented(parts, signs), signs, strict=True)]
    body = reptation.body_nodes(np.concatenate(torque), nodes - np.arange(len(nodes)))
    fit = None if body is None else reptation.fit(strands, velocities, body, [1] * len(strands))
    lengths = [np.linalg.norm(np.diff(x, axis=0), axis=1) for x in strands]
    writhe = [
        part / l for part, l in zip(np.split(writhe_density(strands, False), edges), lengths, strict=True)
    ]
    touching = np.split(_touching_writhe(strands, torque, coefficients(result).h), edges)
    rest = _oriented(_rest_lengths(result), signs)
    return Moment(strands, velocities, torque, writhe, touching, rest, fit)


def _oriented(strands: list[Floats], signs: list[int]) -> list[Floats]:
    return [x[::sign] for x, sign in zip(strands, signs, strict=True)]


def _rest_lengths(result: Result) -> list[Floats]:
    """Rest lengths of the edges of each strand [m]: those at the start."""
    data = result.dataset
    strands = np.split(data["position"].values[0].astype(float), data["node_start"].values[1:-1])
    return [np.linalg.norm(np.diff(x, axis=0), axis=1) for x in strands]


def _touching_writhe(strands: list[Floats], torque: list[Floats], h: float) -> Floats:
    """Writhe density of what is in contact [1/m]: of edges with midpoints nearer than 2h and a torque.

    Edges of one strand nearer along it than pi h are no contact. Pairs count with their midpoints.
    """
    from scipy.spatial import cKDTree

    mid = np.concatenate([0.5 * (x[1:] + x[:-1]) for x in strands])
    e = np.concatenate([np.diff(x, axis=0) for x in strands])
    along = np.concatenate([np.cumsum(np.linalg.norm(np.diff(x, axis=0), axis=1)) for x in strands])
    owner = np.repeat(np.arange(len(strands)), [len(x) - 1 for x in strands])
    i, j = cKDTree(mid).query_pairs(2 * h, output_type="ndarray").T
    loaded = np.concatenate(torque) != 0
    keep = ((owner[i] != owner[j]) | (abs(along[i] - along[j]) > np.pi * h)) & loaded[i] & loaded[j]
    i, j = i[keep], j[keep]
    r = mid[j] - mid[i]
    pair = np.einsum("kc,kc->k", e[i], np.cross(r, e[j])) / np.linalg.norm(r, axis=1) ** 3 / (4 * np.pi)
    n = len(mid)
    return np.asarray((np.bincount(i, pair, n) + np.bincount(j, pair, n)) / np.linalg.norm(e, axis=1))


@dataclass(frozen=True)
class Balance:
    """Self-torque and writhe of a bend, means over a window.

    Attributes
    ----------
    writhe : Wr of the diagram: its crossings counted, right-handed ones as +1
    writhe_3 : of the centerline; touching_writhe : of what is in contact
    torque : total self-torque [N m], and its standard deviation over the window
    speed : half the parting speed [m/s]; strand_speed the mean of those fitted along the two strands
    explained, alignment : see `reptation.Reptation`
    correlation : of torque density and writhe density along the body
    turning : rate at which the knot turns about the pull [rad/s]; turned : by how much at the end [rad]
    scale : pi (speed/h^2) eta_f J [N m]: the torque for Wr_3 = 1 if all of the writhe were at R = 2h
    start, end : of the window [s]
    """

    writhe: int
    writhe_3: float
    touching_writhe: float
    torque: float
    torque_spread: float
    speed: float
    strand_speed: tuple[float, float]
    explained: float
    alignment: float
    correlation: float
    turning: float
    turned: float
    scale: float
    start: float
    end: float

    @property
    def reduced_torque(self) -> float:
        """Torque over `scale`: Wr_3 if the law held as it stands."""
        return self.torque / self.scale

    @property
    def constant(self) -> float:
        """Torque over `scale` and Wr_3: 1 if the law held as it stands; nan where Wr_3 is below 1/2."""
        return self.reduced_torque / self.writhe_3 if abs(self.writhe_3) >= 0.5 else np.nan


def balance(result: Result, start: float = SETTLED, until: float = UNTIL) -> Balance:
    """Averages over a window, which ends at slipping at the latest."""
    data = result.dataset
    frames = window(result, start, until)
    seen = [moment(result, int(k)) for k in frames]
    first, last = int(frames[0]), int(frames[-1])
    first = first if last > first else max(0, last - 1)
    time, apart = data["time"].values, data["separation"].values
    speed = 0.5 * float((apart[last] - apart[first]) / (time[last] - time[first]))
    fits = [m.fit for m in seen if m.fit is not None]
    speeds = np.mean([f.speed for f in fits], axis=0) if fits else np.full(2, np.nan)
    c = coefficients(result)
    torques = np.array([m.total_torque for m in seen])
    return Balance(
        writhe=diagram_writhe(result.spec),
        writhe_3=float(np.mean([m.total_writhe for m in seen])),
        touching_writhe=float(np.mean([m.touching_writhe for m in seen])),
        torque=float(torques.mean()),
        torque_spread=float(torques.std()),
        speed=speed,
        strand_speed=(float(speeds[0]), float(speeds[1])),
        explained=_mean([f.explained for f in fits]),
        alignment=_mean([f.alignment for f in fits]),
        correlation=float(np.mean([m.correlation for m in seen])),
        turning=float(data["rotation_rate"].values[frames].mean()),
        turned=float(data["rotation"].values[last]),
        scale=np.pi * speed / c.h**2 * c.eta_f_J,
        start=float(time[first]),
        end=float(time[last]),
    )


def _mean(values: list[float]) -> float:
    return float(np.mean(values)) if values else np.nan


def diagram_writhe(spec: Mapping[str, object]) -> int:
    """Wr of the drawing of a bend that was pulled, its strands running towards their gripped ends."""
    from torsade.knots.finding import known_bend

    entry = known_bend(str(spec["knot"]))
    return state(entry.diagram, str(spec.get("pulled") or entry.pulled)).writhe
