"""How many pieces a rod breaks into, against its twist and the curvature at which it breaks (thesis Fig
3-4E).

Every point is a rod as strong as breaks there: bent at a total twist until its largest curvature is the limit
curvature, broken in the middle, its cascade followed. Rows of one twist are bent further from point to point,
so that a shape takes some milliseconds; a cascade of 50 edges takes about fifteen.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np

from torsade.arrays import Floats, Ints
from torsade.errors import TorsadeError
from torsade.fracture.cascade import Cascade, Fracture
from torsade.fracture.criteria import CriterionName, stress
from torsade.fracture.limit import rod_fiber
from torsade.fracture.rod import Rod
from torsade.fracture.theory.scales import bending_time
from torsade.material import Material, Section
from torsade.motion.equilibrium import Bent, bent_until
from torsade.motion.grips import gripped
from torsade.motion.inertial import Inertial

__all__ = ["NO_SHAPE", "Rods", "phase_diagram", "snapped"]

NO_SHAPE = 0
"""Pieces where a rod of that twist does not bend so far."""


@dataclass(frozen=True)
class Rods:
    """The rods of a diagram.

    Attributes
    ----------
    material, section : of all rods
    length, edges : [m], and how many edges they are made of
    min_fragment : lambda [m]
    criterion : which makes the strength of each rod
    frozen : whether pieces that no end holds stop
    followed : how long [s]; None for until the wave of the first break reaches the ends
    """

    material: Material
    section: Section
    length: float = 0.24
    edges: int = 50
    min_fragment: float = 0.03
    criterion: CriterionName = "effective"
    frozen: bool = False
    followed: float | None = None

    @property
    def duration(self) -> float:
        """How long pieces are followed [s]."""
        if self.followed is not None:
            return self.followed
        return bending_time(Rod.of(self.material, self.section.h, self.length), self.length / 2)


def snapped(rods: Rods, shape: Bent) -> Cascade:
    """The cascade of the rod that is just as strong as breaks at this shape, in the middle.

    Parameters
    ----------
    shape : an equilibrium in the twist device, of an even number of edges
    """
    material, section, twist = rods.material, rods.section, shape.total_twist
    density = twist / rods.length
    limit = float(stress(shape.kappa_max, density, material.E_b, material.mu, section.h, rods.criterion))
    assembly, state, boundary = gripped(shape.x, shape.grips, twist)
    motion = Inertial(assembly, material, section, boundary, state)
    strength = np.full(len(assembly.hinges), limit)
    fracture = Fracture(strength, rods.criterion, rods.min_fragment, rods.frozen)
    cascade = Cascade(motion, fracture, material, section)
    cascade.snap([rods.edges // 2])  # counted with the hinge of the grip
    cascade.advance(rods.duration)
    return cascade


def phase_diagram(
    rods: Rods, twists: Sequence[float] | Floats, curvatures: Sequence[float] | Floats, workers: int = 1
) -> Ints:
    """Number of pieces at every twist and limit curvature, shape (n_twists, n_curvatures).

    `NO_SHAPE` where no rod of that twist bends so far. The result does not depend on the number of workers.

    Parameters
    ----------
    twists, curvatures : total twists [rad], and limit curvatures in increasing order [1/m]
    workers : processes
    """
    if rods.edges % 2:
        raise TorsadeError(f"edges is {rods.edges}; give an even number, so that a node lies in the middle")
    limits = np.asarray(curvatures, dtype=np.float64)
    if len(limits) and not (limits[0] > 0 and (np.diff(limits) > 0).all()):
        raise TorsadeError("limit curvatures do not increase from above 0; give them in order")
    jobs = [(rods, float(twist), limits) for twist in twists]
    if min(workers, len(jobs)) <= 1:
        rows = [_row(*job) for job in jobs]
    else:
        # Fresh interpreters: forking one that has threads, as compiled kernels do, can hang.
        with ProcessPoolExecutor(min(workers, len(jobs)), multiprocessing.get_context("spawn")) as pool:
            rows = list(pool.map(_row, *zip(*jobs, strict=True)))
    return np.array(rows, dtype=np.int64).reshape(len(jobs), len(limits))


def _row(rods: Rods, twist: float, limits: Floats) -> list[int]:
    """Pieces at one twist [rad], bent from one limit curvature [1/m] to the next."""
    fiber = rod_fiber(rods.material, rods.section, rods.length, rods.edges)
    pieces = [NO_SHAPE] * len(limits)
    shape: Bent | None = None
    for k, kappa in enumerate(limits):
        try:
            shape = bent_until(fiber, float(kappa), twist, shape)
        except TorsadeError:
            break
        pieces[k] = len(snapped(rods, shape).lengths)
    return pieces
