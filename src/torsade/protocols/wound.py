"""A suture at work: what is recorded of it, and what is concluded."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from torsade.motion.moving import Outcome
from torsade.motion.wound import measure_skin
from torsade.protocols.pulled import frame_of_fibers

if TYPE_CHECKING:
    from torsade.arrays import Floats
    from torsade.assembly import Assembly, State
    from torsade.motion.overdamped import Motion
    from torsade.protocols.suture import Suture

__all__ = ["RECORDED", "SAMPLED", "Wound"]

SAMPLED = ("gap", "drawn", "z_a", "z_b")
RECORDED = (
    "skin_position", "gap", "drawn", "slip_speed", "energy_skin", "energy_springs", "spring_force",
    "skin_force", "skin_pressing", "skin_shearing", "skin_normal", "skin_around", "skin_along",
)  # fmt: skip

LAST = 0.75
"""Share of the pull from which the speed is taken at which the ends run out."""

DEPTH = 1e-3
"""How deep a fiber that is laid on skin lies in it, in diameters."""


class Wound:
    """What a suture does to the two sides of a wound.

    Parameters
    ----------
    spec : what to do
    fiber : the strand alone, without the skin
    motion : strand and skin, at t = 0
    """

    def __init__(self, spec: Suture, fiber: Assembly, motion: Motion) -> None:
        self.spec, self.fiber, self.motion = spec, fiber, motion
        self.n_nodes = len(fiber.node_length)
        self.load = motion.boundary.force
        self.pull = self.load[[0, self.n_nodes - 1]] / spec.force
        self.ends = motion.state.x[[0, self.n_nodes - 1]].copy()
        self.rest_z = motion.state.x[self.n_nodes :, 2].copy()

    def strand(self) -> State:
        """The present state of the fiber alone."""
        state, n = self.motion.state, self.n_nodes
        return state._replace(x=state.x[:n], v=state.v[:n])

    def sample(self) -> dict[str, float]:
        """Present gap, length drawn out and z-displacements [m]."""
        x = self.motion.state.x
        w = x[self.n_nodes :]
        ends = x[[0, self.n_nodes - 1]]
        z = w[:, 2] - self.rest_z
        return {
            "gap": float(np.linalg.norm(w[1, :2] - w[0, :2]) - 2 * self.spec.h_s),
            "drawn": float(np.sum((ends - self.ends) * self.pull)),
            "z_a": float(z[0]),
            "z_b": float(z[1]),
        }

    def frame(self) -> dict[str, float | Floats]:
        """Everything recorded at the present time."""
        motion = self.motion
        fiber = frame_of_fibers(motion, self.fiber, self.strand(), motion.measure(), self.spec.h)
        skin, sample = measure_skin(motion), self.sample()
        speed = motion.state.v[[0, self.n_nodes - 1]] * self.pull
        return fiber | {
            "skin_position": motion.state.x[self.n_nodes :],
            "gap": sample["gap"],
            "drawn": sample["drawn"],
            "slip_speed": 0.5 * float(np.sum(speed)),
            "energy_skin": skin.contact,
            "energy_springs": skin.stored,
            "spring_force": skin.spring,
            "skin_force": skin.total,
            "skin_pressing": skin.normal @ self.fiber.rest_length,
            "skin_shearing": np.hypot(skin.around, skin.along) @ self.fiber.rest_length,
            "skin_normal": skin.normal,
            "skin_around": skin.around,
            "skin_along": skin.along,
        }

    def begin(self, time: float) -> None:
        """Pull, or let go once the time to pull is over."""
        # A stop may lie the billionth part of a run before the time that it stands for.
        over = time * (1 + 1e-8) >= self.spec.duration
        self.motion.boundary = self.motion.boundary._replace(force=0.0 * self.load if over else self.load)

    def catch(self, until: float) -> Outcome | None:
        """Lay a fiber that is pulled away from the wound on the skin: until then nothing holds it."""
        x, edges = self.motion.state.x, self.fiber.edges
        middle = x[edges].mean(axis=1)
        reach = self.spec.h_s + self.spec.h * (1 - 2 * DEPTH)
        across = middle[:, None, 0] - x[None, self.n_nodes :, 0]
        deep = np.sqrt(np.maximum(reach**2 - across**2, 0.0))
        way = x[None, self.n_nodes :, 1] - deep - middle[:, None, 1]
        way = way[(np.abs(across) < reach) & (way >= 0)]
        if not way.size:
            return None
        x[: self.n_nodes, 1] += way.min()
        return Outcome.PAUSED

    def conclude(self, history: Mapping[str, Floats], loose_at: float | None) -> dict[str, Any]:
        """Largest displacements along z on the way, when the wound closed, and how fast the ends ran out."""
        spec = self.spec
        time, z = history["time"], np.stack([history["z_a"], history["z_b"]], axis=1)
        relative = np.abs(z[:, 0] - z[:, 1])
        numbers: dict[str, Any] = {
            "z_peak_m": {
                "a": float(z[np.argmax(np.abs(z[:, 0])), 0]),
                "b": float(z[np.argmax(np.abs(z[:, 1])), 1]),
                "relative": float(relative.max()),
            }
        }
        shut = np.flatnonzero(history["gap"] <= 0)
        if shut.size:
            numbers["closed_at_s"] = float(time[shut[0]])
        ends = np.minimum(float(time[-1]), spec.duration) * np.array([LAST, 1.0])
        first, last = np.interp(ends, time, history["drawn"])
        if ends[1] > ends[0]:
            speed = float(0.5 * (last - first) / (ends[1] - ends[0]))
            numbers["slip_speed_m_per_s"] = speed
            if speed > 0:
                unit = spec.force * 2 * spec.h / (spec.fiber_material.eta * spec.section.A)
                numbers["c_f"] = unit / speed
        return numbers
