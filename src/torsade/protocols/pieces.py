"""What is recorded of a rod in pieces: rows of nodes, one piece after the other, with room for all breaks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from torsade.arrays import Floats

if TYPE_CHECKING:
    from torsade.fracture.cascade import Cascade

__all__ = ["NAMES", "PieceFrames"]

NAMES = (
    "time",
    "end_distance",
    "kappa_max",
    "energy_kinetic",
    "energy_spin",
    "energy_bend",
    "energy_twist",
    "energy_released",
    "dissipation",
    "piece_start",
    "position",
    "curvature",
    "twist_density",
    "stress",
)
"""Of what `PieceFrames.frame` gives."""


class PieceFrames:
    """Frames of a cascade.

    A node that breaks becomes two, so there are as many rows for nodes as the most breaks can make, filled
    from the first on in the order along the rod; the others hold NaN. Piece p has the rows piece_start[p] to
    piece_start[p + 1] - 1; pieces that are not there are empty. Curvature, twist density and stress are those
    of the hinge at a node, 0 where there is none. Nodes beyond the ends that belong to grips, as many at
    either end as `grips`, are left out.
    """

    def __init__(self, cascade: Cascade, most_breaks: int, grips: int = 0) -> None:
        self._cascade = cascade
        self._grips = grips
        left = most_breaks - len(cascade.breaks)
        self._rows = len(cascade.motion.state.x) - 2 * grips + max(left, 0)
        self._pieces = max(most_breaks, len(cascade.breaks)) + 1

    @property
    def sizes(self) -> dict[str, int]:
        """Of the dimensions of what is recorded."""
        return {"node": self._rows, "piece_bound": self._pieces + 1}

    def frame(self) -> dict[str, float | Floats]:
        """Everything recorded at the present time, by `NAMES`."""
        cascade, motion = self._cascade, self._cascade.motion
        stress, kappa, twist_density = cascade.measure().copy(), cascade.kappa(), cascade.twist_density()
        energies = motion.energies()
        x = self._own(motion.state.x)
        start = np.full(self._pieces + 1, float(len(x)))
        bounds = motion.assembly.node_start
        start[: len(bounds)] = np.clip(bounds - self._grips, 0, len(x))
        return {
            "time": motion.time,
            "end_distance": float(np.linalg.norm(x[-1] - x[0])),
            "kappa_max": float(kappa.max()),
            "energy_kinetic": energies.kinetic,
            "energy_spin": energies.spin,
            "energy_bend": energies.bend,
            "energy_twist": energies.twist,
            "energy_released": cascade.released,
            "dissipation": motion.dissipation,
            "piece_start": start,
            "position": self._padded(x),
            "curvature": self._at_nodes(kappa),
            "twist_density": self._at_nodes(twist_density),
            "stress": self._at_nodes(stress),
        }

    def _at_nodes(self, values: Floats) -> Floats:
        motion = self._cascade.motion
        at = np.zeros(len(motion.state.x))
        at[motion.assembly.hinges[:, 2]] = values
        return self._padded(self._own(at))

    def _own(self, values: Floats) -> Floats:
        return values[self._grips : len(values) - self._grips]

    def _padded(self, values: Floats) -> Floats:
        rows = np.full((self._rows, *values.shape[1:]), np.nan)
        rows[: len(values)] = values
        return rows
