"""Discharging a battery (thesis 5.4): a cut fiber unties and straightens, its energy lost to drag."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsade import observables
from torsade.arrays import Floats
from torsade.assembly import Assembly, State, opened, parted
from torsade.material import Material, Section
from torsade.motion import ends
from torsade.motion.moving import Guided, Outcome, check_saved
from torsade.motion.overdamped import Energies, Motion, Stepping
from torsade.rod.contact import Model
from torsade.topology.fewest import fewest_crossings
from torsade.topology.identify import name_open
from torsade.topology.measures import average_crossing_number, writhe
from torsade.topology.names import UNKNOT

__all__ = [
    "NAMES",
    "SAMPLED",
    "Discharge",
    "crossing_losses",
    "discharge_times",
    "hinge_at",
    "hinge_to_cut",
    "mean_on_the_way",
]

NAMES = (
    "time",
    "energy_stretch",
    "energy_bend",
    "energy_twist",
    "energy_contact",
    "dissipation",
    "total_twist",
    "writhe",
    "average_crossings",
    "fewest_crossings",
    "end_to_end",
    "h_kappa_max",
    "position",
    "log_strain",
    "energy_density",
)
"""Of what `Discharge.frame` gives."""

SAMPLED = ("energy", "dissipation", "fewest_crossings", "non_planarity", "torsion")
"""Of what `Discharge.sample` gives."""

EMPTY = 1e-3
"""A battery with this share of its energy left is empty."""

DIRECTIONS = 12
"""In which the ends are led away when the open strand is identified."""

HARDLY = 0.1
"""Motion of all nodes that leaves a knot its name, from where it was named on [radii]."""

DRAWN_IN = 1e-4
"""How far ends are drawn in where the shape of the strand is looked at, in edges."""

TIED = 1e-9
"""Stresses within this share of the largest are as large: of such hinges the first is cut."""


def hinge_to_cut(assembly: Assembly, state: State, material: Material, radius: float) -> int:
    """The hinge where the stress on the surface is largest, the first of several."""
    stress = observables.surface_stress(assembly, state, material, radius)
    return int(np.argmax(stress >= (1 - TIED) * stress.max()))


def hinge_at(assembly: Assembly, share: float) -> int:
    """The hinge of a closed fiber nearest to a share of its rest length, counted from the seam."""
    place = np.cumsum(assembly.rest_length) - assembly.rest_length
    apart = np.abs(place - share * assembly.fiber_length[0])
    return int(np.argmin(np.minimum(apart, assembly.fiber_length[0] - apart)))


class Discharge(Guided[Motion]):
    """A closed fiber cut at a hinge; drive it as any motion. It is over when the battery is empty.

    The ends lie face to face at first and are not in contact, as they were not before: parts of the fiber
    near each other along it are left out. Once they have come apart they may touch like all others.
    """

    def __init__(
        self,
        closed: Assembly,
        state: State,
        hinge: int,
        model: Model,
        material: Material,
        section: Section,
        how: Stepping,
    ) -> None:
        assembly, cut = opened(closed, state, hinge)
        self.motion = Motion(assembly, model, ends.free(assembly), cut, how)
        self.knots: list[tuple[float, str]] = []
        self._material, self._section = material, section
        self._first = self.motion.energies().total
        self._across = _pairs_across(assembly, model.exclusion_length)
        self._apart = False
        self._named = np.zeros_like(cut.x)

    def advance(self, until: float, max_steps: int = 2**62) -> Outcome:
        """Advance to the time until [s], in at most max_steps steps; OVER when the battery is empty.

        Raises
        ------
        TorsadeError
            When strands would pass through each other, or no step is short enough.
        """
        outcome = self.motion.advance(until, max_steps)
        if not self._apart and self._parted():
            self._part()
        return Outcome.OVER if self.energies().total < EMPTY * self._first else outcome

    def _parted(self) -> bool:
        """Whether no two parts near each other across the cut are in each other's place."""
        x = self.motion.state.x
        middle = 0.5 * (x[1:] + x[:-1])
        before, after = self._across
        gap = np.linalg.norm(middle[before] - middle[after], axis=1)
        return bool((gap >= 2 * self._section.h).all())

    def _part(self) -> None:
        self._apart = True
        self.motion.assembly = parted(self.motion.assembly)

    def energies(self) -> Energies:
        """Stored energies at the present state [J]."""
        return self.motion.energies()

    def frame(self) -> dict[str, float | Floats]:
        """Everything recorded at the present time, by `NAMES`; the knot is identified too."""
        motion, radius = self.motion, self._section.h
        assembly, state, energies = motion.assembly, motion.state, self.energies()
        x = _drawn_in(state.x)
        fewest = fewest_crossings(x, False)
        self.knots.append((motion.time, self._name(x, fewest)))
        return {
            "time": motion.time,
            "energy_stretch": energies.stretch,
            "energy_bend": energies.bend,
            "energy_twist": energies.twist,
            "energy_contact": energies.contact,
            "dissipation": motion.dissipation,
            "total_twist": float(observables.twist(assembly, state)[0]),
            "writhe": writhe(x, False),
            "average_crossings": average_crossing_number(x, False),
            "fewest_crossings": fewest,
            "end_to_end": float(np.linalg.norm(x[-1] - x[0])),
            "h_kappa_max": float(observables.h_kappa(assembly, state, radius).max()),
            "position": state.x,
            "log_strain": observables.log_strain(assembly, state, radius),
            "energy_density": observables.energy_density(assembly, state, self._material, self._section),
        }

    def _name(self, x: Floats, fewest: int) -> str:
        """Which knot the strand (n, 3) is; what has hardly moved since it was named is not named anew."""
        moved = np.linalg.norm(x - self._named, axis=1).max() if self.knots else np.inf
        if fewest and moved < HARDLY * self._section.h:
            return self.knots[-1][1]
        self._named = x
        return name_open(x, DIRECTIONS) if fewest else UNKNOT

    def sample(self) -> dict[str, float]:
        """The present values of `SAMPLED`."""
        x = self.motion.state.x
        return {
            "energy": self.energies().total,
            "dissipation": self.motion.dissipation,
            "fewest_crossings": fewest_crossings(_drawn_in(x), False),
            "non_planarity": observables.non_planarity(x),
            "torsion": observables.mean_torsion(x, self._section.h),
        }

    def warm_up(self) -> None:
        """Compile or load every kernel, and leave no trace."""
        self.motion.warm_up()

    def saved(self) -> dict[str, NDArray[Any]]:
        """Copies of the arrays that decide how the motion goes on, by name, and the knots so far."""
        knots = np.frombuffer(json.dumps(self.knots).encode(), dtype=np.uint8)
        return self.motion.saved() | self._own() | {"knots": knots}

    def _own(self) -> dict[str, NDArray[Any]]:
        return {"apart": np.array(self._apart), "named": self._named.copy()}

    def recover(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Go on from the arrays that `saved` gave.

        Raises
        ------
        ValueError
            When they are not of this fiber.
        """
        check_saved({name: saved[name] for name in self._own()}, self._own())
        self.motion.recover(saved)
        self.knots = [(float(t), str(name)) for t, name in json.loads(saved["knots"].tobytes())]
        self._named = np.array(saved["named"])
        if saved["apart"] and not self._apart:
            self._part()


def _drawn_in(x: Floats) -> Floats:
    """Nodes (n, 3) [m] with the ends drawn in a trifle: at the cut they are one point, and touch."""
    inner = x.copy()
    inner[0] += DRAWN_IN * (x[1] - x[0])
    inner[-1] += DRAWN_IN * (x[-2] - x[-1])
    return inner


def _pairs_across(assembly: Assembly, reach: float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of edges of an open fiber that lay nearer than reach [m] along it when it was closed."""
    s, length = assembly.edge_arclength, assembly.fiber_length[0]
    around = length - np.abs(s[:, None] - s[None])
    before, after = np.nonzero(np.triu(around < reach, 1))
    return before, after


def discharge_times(time: Floats, energy: Floats, shares: Sequence[float]) -> list[float | None]:
    """When the energy (n,) is down to shares of the first for good [s], between samples logarithmically.

    The final energy is that of a straight fiber, zero. None where it never is.
    """
    found: list[float | None] = []
    for share in shares:
        above = np.flatnonzero(energy > share * energy[0])
        k = int(above[-1]) + 1
        if k == len(energy):
            found.append(None)
            continue
        high, low = math.log(energy[k - 1]), math.log(max(energy[k], 1e-300))
        part = (high - math.log(share * energy[0])) / (high - low)
        found.append(float(time[k - 1] + part * (time[k] - time[k - 1])))
    return found


def crossing_losses(time: Floats, crossings: Floats) -> list[float]:
    """When each crossing is lost for good [s], the first one first.

    crossings (n,) are the fewest from any side. The time is that of the first sample after which there are
    never so many again; crossings that are still there at the end are left out.
    """
    most = int(crossings[0])
    since = [int(np.flatnonzero(crossings >= k)[-1]) + 1 for k in range(most, 0, -1)]
    return [float(time[i]) for i in since if i < len(time)]


def mean_on_the_way(energy: Floats, values: Floats, between: tuple[float, float]) -> float | None:
    """Mean of values (n,) over the logarithm of the energy (n,), from one share of its first to another.

    How long a shape stays does not count, but how much energy it gives off. None where the second share is
    not reached, or the energy passes both between two samples.
    """
    share = np.minimum.accumulate(energy) / energy[0]
    high, low = between
    on_the_way = np.flatnonzero((share <= high) & (share >= low))
    if share[-1] > low or len(on_the_way) < 2:
        return None
    fallen = -np.log(share[on_the_way])
    if fallen[-1] <= fallen[0]:
        return None
    return float(np.trapezoid(values[on_the_way], fallen) / (fallen[-1] - fallen[0]))
