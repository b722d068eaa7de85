"""Self-torque of a pulled bend beside the writhe of its centerline (thesis 4.4).

Strands are oriented towards their gripped ends. If a bend reptates, v = u t + V + Omega × x, two points in
contact differ in velocity by u (t' - t), and the torque density of the law of the run,
eta_f J ∫ (r × dv).t/R^5 ds', is that of the writhe, ∫ t.(r × t')/R^3 ds'/4 pi, but for 1/R^2 and for what is
not in contact. With R = 2h everywhere it would be

    torque = pi (u/h^2) eta_f J Wr_3.

`Balance` holds both sides, and what the approximations leave out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from torsade.arrays import Ints
from torsade.figures.moments import coefficients, moment
from torsade.observables import SETTLED
from torsade.results import Result
from torsade.topology import state

__all__ = ["UNTIL", "Balance", "balance", "diagram_writhe", "window"]

UNTIL = 0.6
"""End of the time [s] over which torques are averaged; it begins when a bend counts as tight, at 0.3 s."""

STEPS = 16
"""Frames looked at, at most, in a window."""


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
    twist : of both strands together at the end [rad]
    nearness, shortening : see `Moment.factors`
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
    twist: float
    nearness: float
    shortening: float
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


def window(result: Result, start: float = SETTLED, until: float = UNTIL) -> Ints:
    """Frames from start to until [s], or to slipping if that comes first; the frame after that at least."""
    time = result.dataset["time"].values
    end = until if result.slipped_at is None else min(until, result.slipped_at)
    frames = np.flatnonzero((time >= start * (1 - 1e-9)) & (time <= end * (1 + 1e-9)))
    if len(frames) == 0:
        frames = np.array([result.last_held])
    chosen = np.unique(np.linspace(0, len(frames) - 1, min(STEPS, len(frames))).astype(int))
    return np.asarray(frames[chosen])


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
        twist=float(data["twist"].values[last].sum()),
        nearness=float(np.mean([m.factors[0] for m in seen])),
        shortening=float(np.mean([m.factors[1] for m in seen])),
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
