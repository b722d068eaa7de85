"""Charging a battery (thesis 5.3): a closed, twisted fiber comes to rest, its link conserved.

Frames are recorded on an axis of their own, in units of T_0 from `FIRST` on, each later by the same factor.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade import observables
from torsade.arrays import Floats
from torsade.material import Material, Section
from torsade.motion.overdamped import Motion
from torsade.stopping import STOPPING, Patience
from torsade.topology.identify import identify_curves
from torsade.topology.isotopy import thinned
from torsade.topology.measures import writhe

__all__ = ["Charge", "charge", "trembled"]

FIRST = 1e-2
"""Time of the first frame after the one at the start [T_0]."""

FACTOR = 1.4
"""Of the times of successive frames."""

AT_REST = 1e-9
"""Share of the energy that a fiber at rest loses in T_0, at most."""

EARLIEST = 0.5
"""Rest is not looked for before this share of the longest time: a twisted knot may stay near a shape that is
not stable for 30 T_0, losing next to nothing."""

WAVES = 8
"""Waves around the fiber that the tremor of the starting shape is made of."""


class Charge(NamedTuple):
    """How a battery was charged.

    Attributes
    ----------
    history : recorded arrays by name, `charge_` before it left out, each with a row for every frame:
        `time` [s], energies by kind [J], `twist`, `writhe` and `link` [turns], shapes (n_frames,);
        `position` [m], shape (n_frames, n_nodes, 3); `energy_density` [J/m], shape (n_frames, n_nodes)
    knots : the knot identified in every frame
    loss : share of the energy lost in T_0, between the last two frames
    """

    history: dict[str, NDArray[np.floating]]
    knots: tuple[str, ...]
    loss: float


def trembled(x: Floats, size: float, seed: int) -> Floats:
    """Closed nodes (n, 3) [m] displaced smoothly at random, by size [m] as root mean square.

    Sums of waves with normally distributed coefficients, the same curve at every number of nodes.
    """
    a, b = np.random.default_rng(seed).standard_normal((2, WAVES, 3))
    phase = 2 * math.pi * np.outer(np.arange(len(x)) / len(x), np.arange(1, WAVES + 1))
    waves = np.cos(phase) @ a + np.sin(phase) @ b
    return np.asarray(x + size * waves / np.sqrt(0.5 * (a**2 + b**2).sum()))


def charge(
    motion: Motion,
    material: Material,
    section: Section,
    unit: float,
    longest: float,
    tell: Callable[[float, str], None],
) -> Charge:
    """Let a closed fiber relax until it is at rest, or for the longest time [s].

    Parameters
    ----------
    motion : a single closed fiber, which is moved
    material, section : of the fiber, for its energy density
    unit : T_0 [s]
    longest : to wait for rest [s]; rest is not looked for before `EARLIEST` of it
    tell : called with the share done, on the logarithm of time, and what is going on

    Raises
    ------
    TorsadeError
        When strands would pass through each other, or no step is short enough.
    KeyboardInterrupt
        On Ctrl-C or SIGTERM.
    """
    frames = [_frame(motion, material, section)]
    names = [_knot(motion.state.x)]
    until, loss = FIRST * unit, math.inf

    def say(note: str) -> None:
        tell(math.log1p(motion.time / (FIRST * unit)) / math.log1p(longest / (FIRST * unit)), note)

    with Patience(lambda: say(STOPPING)) as patience:
        while not (motion.time >= EARLIEST * longest and loss < AT_REST) and motion.time < longest:
            until = min(until, longest)
            while motion.time < until:
                motion.advance(until, motion.at_once)
                say(f"charging, t = {motion.time / unit:.3g} T_0")
                patience.end()
            frames.append(_frame(motion, material, section))
            names.append(_knot(motion.state.x))
            loss = _loss(*frames[-2:]) * unit
            until *= FACTOR
    history = {name: np.array([frame[name] for frame in frames]) for name in frames[0]}
    for name in ("position", "energy_density"):
        history[name] = history[name].astype(np.float32)
    return Charge(history, tuple(names), loss)


def _loss(before: dict[str, Floats | float], after: dict[str, Floats | float]) -> float:
    """Share of the energy that is lost in a second."""
    first, last = (
        sum(float(frame[f"energy_{kind}"]) for kind in ("stretch", "bend", "twist", "contact"))
        for frame in (before, after)
    )
    return (first - last) / (float(after["time"]) - float(before["time"])) / max(last, 1e-300)


def _frame(motion: Motion, material: Material, section: Section) -> dict[str, Floats | float]:
    assembly, state, energies = motion.assembly, motion.state, motion.energies()
    Tw, Wr = _turns(motion), writhe(state.x, True)
    return {
        "time": motion.time,
        "energy_stretch": energies.stretch,
        "energy_bend": energies.bend,
        "energy_twist": energies.twist,
        "energy_contact": energies.contact,
        "twist": Tw,
        "writhe": Wr,
        "link": Tw + Wr,
        "position": state.x.copy(),
        "energy_density": observables.energy_density(assembly, state, material, section),
    }


def _turns(motion: Motion) -> float:
    """Twist of a single fiber in turns."""
    return float(observables.twist(motion.assembly, motion.state)[0]) / (2 * math.pi)


def _knot(x: Floats) -> str:
    return str(identify_curves([thinned(x)]))
