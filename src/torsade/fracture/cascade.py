"""The fracture cascade: a bent, twisted rod breaks, and its pieces break again in the waves of the release.

A hinge breaks in the step in which its stress comes to its strength: its node is split in two, each with its
half of the mass and the velocity of the whole. Every piece breaks at most once in a step, where stress over
strength is largest. Once the rod is broken, no break is nearer than the least fragment length lambda to an
end of its piece (thesis 3.3). Both sides of every break are followed; pieces that no end holds go on, or stop
(thesis Fig 3-1C).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from torsade.arrays import Floats
from torsade.assembly import Assembly
from torsade.fracture.breaking import BROKEN, Bearing, advance_unbroken, stress_of_state
from torsade.fracture.criteria import criterion
from torsade.material import Material, Section
from torsade.motion import verlet
from torsade.motion.inertial import Inertial
from torsade.motion.moving import Guided, Outcome
from torsade.rod.elasticity import hinge_curvature

NEVER = 2**62

__all__ = ["Break", "Cascade", "Fracture", "most_breaks", "strengths"]


class Break(NamedTuple):
    """One break.

    Attributes
    ----------
    time : [s]
    place : rest arclength from end 0 of the rod [m]
    ratio : stress over the strength there
    kappa, twist_density : there, just before [1/m, rad/m]
    """

    time: float
    place: float
    ratio: float
    kappa: float
    twist_density: float


class Fracture(NamedTuple):
    """How a rod breaks.

    Attributes
    ----------
    strength : (n_hinges,) stress at which each hinge breaks [Pa]; see `strengths`
    criterion : name of the stress criterion
    min_fragment : lambda, which every piece exceeds [m]
    frozen : whether pieces that no end holds stop, instead of going on
    """

    strength: Floats
    criterion: str = "effective"
    min_fragment: float = 0.03
    frozen: bool = False


def strengths(
    rest_length: Floats, sigma_c: float, disorder: float = 0.0, seed: int = 0, grain: float = 1e-3
) -> Floats:
    """Strength of every hinge of a rod [Pa], shape (n_hinges,), from its edge lengths (n_edges,) [m].

    The rod consists of grains of one length, each as strong as sigma_c (1 + disorder xi), xi normally
    distributed, at least a tenth of sigma_c; a hinge is as strong as the weakest grain within the halves of
    the two edges that it stands for. So the same seed is the same rod at every number of nodes.

    Parameters
    ----------
    sigma_c : [Pa]
    disorder : standard deviation of a grain's strength, in sigma_c; 0 for none
    grain : length of a grain [m], such as the diameter
    """
    if disorder == 0.0:
        return np.full(len(rest_length) - 1, float(sigma_c))
    ends = np.cumsum(rest_length)
    n = max(1, math.ceil(ends[-1] / grain - 1e-9))
    xi = np.random.Generator(np.random.Philox(seed)).standard_normal(n)
    bears = sigma_c * np.maximum(1 + disorder * xi, 0.1)
    middle = (ends - 0.5 * rest_length) / ends[-1] * n
    first, last = np.floor(middle[:-1] + 1e-9).astype(int), np.ceil(middle[1:] - 1e-9).astype(int)
    return np.array([bears[i : max(i + 1, j)].min() for i, j in zip(first, last, strict=True)])


def most_breaks(assembly: Assembly, min_fragment: float) -> int:
    """The largest number of breaks: the first anywhere, others leaving pieces longer than min_fragment [m].

    There are most where the first cuts off one edge at an end. Grips, edges without length, do not count.
    """
    l = assembly.rest_length
    l = l[l > 1e-9 * l.max()]
    return min(1 + max(_cuts(l[1:], min_fragment), _cuts(l[-2::-1], min_fragment)), len(l) - 1)


def _cuts(l: Floats, min_fragment: float) -> int:
    """How often edges of these lengths (n_edges,) [m] can be cut into pieces longer than min_fragment [m]."""
    count, since, longest = 0, 0.0, float(l.sum())
    for length in l[:-1]:
        since += length
        longest -= length
        if since > _above(min_fragment) and longest > _above(min_fragment):
            count, since = count + 1, 0.0
    return count


def _above(length: float) -> float:
    """What a length must exceed to count as longer than this one in spite of round-off."""
    return length * (1 + 1e-9)


class Cascade(Guided[Inertial]):
    """A rod in inertial motion that breaks; drive it as any motion.

    Parameters
    ----------
    motion : one open fiber, as it is at t = 0, with what holds it
    fracture : strengths, criterion and least length
    followed : how long after the first break the cascade is over [s]
    """

    def __init__(
        self,
        motion: Inertial,
        fracture: Fracture,
        material: Material,
        section: Section,
        followed: float = math.inf,
    ) -> None:
        self.motion = motion
        self.fracture = fracture
        self.breaks: list[Break] = []
        self.released = 0.0
        self.first_distance = math.nan
        self._followed = followed
        self._moduli = material.E_b * section.h, material.mu * section.h
        self._criterion = criterion(fracture.criterion)
        self._strength = fracture.strength.copy()
        self._bearing = self._bears()

    @property
    def lengths(self) -> Floats:
        """Lengths of the pieces from end 0 to end 1 of the rod [m], shape (n_breaks + 1,)."""
        return self.motion.assembly.fiber_length.copy()

    def advance(self, until: float, max_steps: int = 2**62) -> Outcome:
        """Advance to the first step at or after the time until [s], in at most max_steps; break on the way.

        Raises
        ------
        TorsadeError
            When edges cannot keep their lengths.
        """
        m, last = self.motion, self.motion.steps + max_steps
        while True:
            end = self._end()
            status = advance_unbroken(
                m.assembly, m.rod, m.inertia, m.boundary, self._bearing, m.state, m.clock,
                min(m.steps_until(until), end), last - m.steps, m.work,
            )  # fmt: skip
            if status != BROKEN:
                m.check(status)
                over = m.steps >= end and status == verlet.REACHED
                return Outcome.OVER if over else Outcome(status)
            self.snap([int(k) for k in self._bearing.worst if k >= 0])

    def _end(self) -> int:
        """The step after which the cascade is over."""
        return (
            self.motion.steps_until(self.breaks[0].time + self._followed)
            if self.breaks and self._followed < math.inf
            else NEVER
        )

    def snap(self, hinges: list[int]) -> None:
        """Break the rod at these hinges, at most one of each piece, whatever the stress there."""
        m = self.motion
        self.measure()
        stored = m.energies().total
        if not self.breaks:
            self.first_distance = float(np.linalg.norm(m.state.x[-1] - m.state.x[0]))
        stress, kappa, twist_density = self._bearing.stress, self.kappa(), self.twist_density()
        for k in hinges:
            place = float(m.assembly.rest_length[: m.assembly.hinges[k, 1]].sum())
            self.breaks.append(
                Break(m.time, place, *(float(a[k]) for a in (stress / self._strength, kappa, twist_density)))
            )
        for k in sorted(hinges, reverse=True):
            self._split(k)
        if self.fracture.frozen:
            self._freeze()
        self._bearing = self._bears()
        self.released += stored - m.energies().total

    def _split(self, hinge: int) -> None:
        self.motion.split(hinge)
        self._strength = np.delete(self._strength, hinge)

    def _freeze(self) -> None:
        """Hold every piece that no end holds."""
        m, held, turned = self.motion, self.motion.boundary.held.copy(), self.motion.boundary.turned.copy()
        for f in range(len(m.assembly.closed)):
            nodes = slice(m.assembly.node_start[f], m.assembly.node_start[f + 1])
            if not held[nodes].any():
                held[nodes] = True
                turned[m.assembly.edge_start[f] : m.assembly.edge_start[f + 1]] = True
                m.state.v[nodes] = 0.0
        m.boundary = m.boundary._replace(held=held, turned=turned)

    def _bears(self) -> Bearing:
        """What hinges bear: any stress where a break would make too short a piece, or in frozen pieces."""
        a, held = self.motion.assembly, self.motion.boundary.held
        along = a.edge_arclength[a.hinges[:, 0]] + 0.5 * a.rest_length[a.hinges[:, 0]]
        shorter = np.minimum(along, a.fiber_length[a.edge_fiber[a.hinges[:, 0]]] - along)
        may = ~held[a.hinges[:, 2]]
        if self.breaks:
            may &= shorter > _above(self.fracture.min_fragment)
        return Bearing(
            self._criterion,
            *self._moduli,
            strength=np.where(may, self._strength, np.inf),
            stress=np.zeros(len(a.hinges)),
            worst=np.full(len(a.closed), -1, np.int64),
        )

    def measure(self) -> Floats:
        """Stress at every hinge at the present state [Pa], shape (n_hinges,)."""
        m = self.motion
        stress_of_state(m.assembly, self._bearing, m.state, m.work)
        return self._bearing.stress

    def kappa(self) -> Floats:
        """Curvature at every hinge [1/m], shape (n_hinges,)."""
        kappa = np.empty(len(self.motion.assembly.hinges))
        hinge_curvature(self.motion.assembly, self.motion.work.new_tangent, kappa)
        return kappa

    def twist_density(self) -> Floats:
        """Twist density at every hinge [rad/m], shape (n_hinges,)."""
        return self.motion.work.m / self.motion.assembly.hinge_length

    def warm_up(self) -> None:
        """Compile or load every kernel, and leave no trace."""
        kept = self.saved()
        self.advance(self.time)
        self.measure()
        self.motion.energies()
        self.recover(kept)

    def saved(self) -> dict[str, NDArray[Any]]:
        """Copies of the arrays that decide how the cascade goes on, by name."""
        breaks = np.array(self.breaks, dtype=np.float64).reshape(-1, len(Break._fields))
        own = {"breaks": breaks, "ledger": np.array([self.released, self.first_distance])}
        return self.motion.saved() | own

    def recover(self, saved: Mapping[str, NDArray[Any]]) -> None:
        """Go on from the arrays that `saved` gave, of the same rod, before it broke or after."""
        for known in saved["breaks"][len(self.breaks) :]:
            a = self.motion.assembly
            places = np.cumsum(a.rest_length)[a.hinges[:, 0]]
            self._split(int(np.argmin(np.abs(places - known[1]))))
            if self.fracture.frozen:
                self._freeze()
        self.breaks = [Break(*(float(value) for value in row)) for row in saved["breaks"]]
        self.released, self.first_distance = (float(value) for value in saved["ledger"])
        self.motion.recover(saved)
        self._bearing = self._bears()
