"""A pulled bend in one frame: velocities, self-torque and writhe along its strands (thesis 4.4).

Strands are oriented towards their gripped ends.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from torsade import reptation
from torsade.arrays import Floats, Ints
from torsade.assembly import assemble
from torsade.results import Result
from torsade.rod.neighbours import neighbour_pairs
from torsade.topology.measures import writhe_density

__all__ = ["Coefficients", "Moment", "Pairs", "coefficients", "moment", "orientation", "torque_of"]


class Coefficients(NamedTuple):
    """What the torque is measured in: eta_f J [N m^2 s] and the radius h [m].

    Node-pair drag has no such viscosity: at contact, with R = 2h and edges of mean rest length l, it weighs
    as continuum drag of eta_f = eta 2h/l does.
    """

    eta_f_J: float
    h: float


class Pairs(NamedTuple):
    """Edges i < j (n,) in contact, counted through both strands.

    writhe (n,) is what they add to Wr_3, found from their midpoints; nearness (2h/R)²; shortening the product
    of their rest lengths, by which the law of drag weighs, over that of their present lengths.
    """

    i: Ints
    j: Ints
    writhe: Floats
    nearness: Floats
    shortening: Floats


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
    pairs : the edges in contact
    fit : the reptation fitted, None where the strands do not touch
    """

    strands: list[Floats]
    velocities: list[Floats]
    torque: list[Floats]
    writhe: list[Floats]
    touching: list[Floats]
    rest: list[Floats]
    pairs: Pairs
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
    def factors(self) -> tuple[float, float]:
        """By how much contacts nearer than 2h raise the torque, and rest lengths lower it, in the mean."""
        near = self.pairs.writhe * self.pairs.nearness
        both = near * self.pairs.shortening
        if not (self.pairs.writhe.sum() and near.sum()):
            return np.nan, np.nan
        return float(near.sum() / self.pairs.writhe.sum()), float(both.sum() / near.sum())

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
    rest = _oriented(_rest_lengths(result), signs)
    pairs = _pairs(strands, rest, torque, result)
    touching = np.split(_density(pairs, strands), edges)
    return Moment(strands, velocities, torque, writhe, touching, rest, pairs, fit)


def _oriented(strands: list[Floats], signs: list[int]) -> list[Floats]:
    return [x[::sign] for x, sign in zip(strands, signs, strict=True)]


def _rest_lengths(result: Result) -> list[Floats]:
    """Rest lengths of the edges of each strand [m]: those at the start."""
    data = result.dataset
    strands = np.split(data["position"].values[0].astype(float), data["node_start"].values[1:-1])
    return [np.linalg.norm(np.diff(x, axis=0), axis=1) for x in strands]


def _pairs(strands: list[Floats], rest: list[Floats], torque: list[Floats], result: Result) -> Pairs:
    """Edges in contact by the laws of the run, with a torque: midpoints nearer than 2h, none excluded."""
    meaning = json.loads(result.dataset.attrs["model"])
    h, laws = float(meaning["radius"]), meaning["laws"]
    fibers = assemble(strands, rest_lengths=rest)
    mid = np.concatenate([0.5 * (x[1:] + x[:-1]) for x in strands])
    exclusion = int(laws["exclusion_edges"]), float(laws["exclusion_radii"]) * h
    i, j = neighbour_pairs(fibers, mid, 2 * h, *exclusion).T
    loaded = np.concatenate(torque) != 0
    keep = loaded[i] & loaded[j]
    i, j = i[keep], j[keep]
    e = np.concatenate([np.diff(x, axis=0) for x in strands])
    r = mid[j] - mid[i]
    R = np.linalg.norm(r, axis=1)
    writhe = np.einsum("kc,kc->k", e[i], np.cross(r, e[j])) / R**3 / (2 * np.pi)
    shortening = np.concatenate(rest) / np.linalg.norm(e, axis=1)
    return Pairs(i, j, writhe, (2 * h / R) ** 2, shortening[i] * shortening[j])


def _density(pairs: Pairs, strands: list[Floats]) -> Floats:
    """Writhe density of what is in contact [1/m]; each of two edges has half of what they add."""
    length = np.concatenate([np.linalg.norm(np.diff(x, axis=0), axis=1) for x in strands])
    n = len(length)
    both = np.bincount(pairs.i, pairs.writhe, n) + np.bincount(pairs.j, pairs.writhe, n)
    return np.asarray(0.5 * both / length)


def torque_of(m: Moment, velocities: list[Floats], eta_f_J: float) -> float:
    """Total self-torque [N m] that other velocities of the nodes (n, 3) would give, by continuum drag.

    Of what the fit says a strand does, for instance, in place of what it does.
    """
    mid = np.concatenate([0.5 * (x[1:] + x[:-1]) for x in m.strands])
    u = np.concatenate([0.5 * (v[1:] + v[:-1]) for v in velocities])
    e = np.concatenate([np.diff(x, axis=0) for x in m.strands])
    t = e / np.linalg.norm(e, axis=1)[:, None]
    rest = np.concatenate(m.rest)
    i, j = m.pairs.i, m.pairs.j
    r = mid[j] - mid[i]
    turn = np.einsum("kc,kc->k", np.cross(r, u[j] - u[i]), t[i] + t[j])
    return float(eta_f_J * (rest[i] * rest[j] * turn / np.linalg.norm(r, axis=1) ** 5).sum())
